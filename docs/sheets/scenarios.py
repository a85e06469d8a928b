"""The scenarios and situations that are built in."""

from __future__ import annotations

from importlib import resources

from railgate.unit.scenario_file import builtin, builtins
from sheets.markdown import code, table

__all__ = ["scenarios"]


def scenarios(name: str) -> str:
    """A table of all, or of the one of that name its file."""
    if name:
        builtin(name)  # raises ValueError where there is none
        file = resources.files("railgate.unit").joinpath("scenarios", f"{name}.toml")
        return code(file.read_text("utf-8").strip(), "toml")
    rows = []
    for each in builtins():
        scenario = builtin(each)
        faults = ", ".join(f"{f.part}: {f.kind}" for f in scenario.faults) or "–"
        rows.append(
            (f"`{each}`", scenario.name, f"{float(scenario.seconds):.0f} s", scenario.unit, faults)
        )
    return table(("name", "what happens", "lasts", "unit", "faults"), rows)
