"""Engines that run a design: pysim, cxxrtl, and the models themselves (leap)."""

from railgate.engines.design import Clock, Design, Engine, Model

__all__ = ["Clock", "Design", "Engine", "Model"]
