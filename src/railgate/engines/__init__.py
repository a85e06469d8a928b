"""Engines that run a design: pysim, cxxrtl, and the models themselves (leap)."""

from railgate.engines.design import Clock, Design, Engine, Model
from railgate.engines.open import ENGINES, open_engine

__all__ = ["ENGINES", "Clock", "Design", "Engine", "Model", "open_engine"]
