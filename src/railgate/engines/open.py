"""An engine by its name."""

from __future__ import annotations

from railgate.engines.design import Design, Engine

__all__ = ["ENGINES", "open_engine"]

ENGINES = ("leap", "cxxrtl", "pysim")
"""From the fastest to the reference."""


def open_engine(design: Design, kind: str) -> Engine:
    """Open a design at tick 0, all as after reset, in an engine of one of ENGINES.

    Only what that engine needs is imported. Raises ValueError for another kind, for leap where the
    design has no model, and where the engine cannot run the design.
    """
    if kind == "cxxrtl":
        from railgate.engines.cxxrtl import Cxxrtl

        return Cxxrtl(design)
    if kind == "pysim":
        from railgate.engines.pysim import PySim

        return PySim(design)
    if kind != "leap":
        raise ValueError(f'an engine must be one of {", ".join(ENGINES)}, not "{kind}"')
    if design.model is None:
        raise ValueError(f"{design.name} has no model to leap with; run it with cxxrtl or pysim")
    return design.model()
