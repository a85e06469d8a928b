"""What is claimed of gateware, how it is shown, and the broken gateware that must not pass."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from railgate.waves import Trace

if TYPE_CHECKING:
    from railgate.proving.monitor import Monitor

__all__ = ["TICK", "Bounded", "Claim", "Induction", "Mutant", "Run", "Search"]

TICK = Fraction(1, 1_000_000)
"""Seconds a tick of every monitor's stimulus lasts; claims count in ticks alone."""

NAME = re.compile(r"[a-z0-9_]+\.[a-z0-9-]+")
REQUIREMENT = re.compile(r"[A-Z]+-\d+")
GATEWARE = re.compile(r"railgate\.(\w+\.gateware|primitives)(\.|$)")
"""The modules that a mutant may patch: those whose changed text the monitors then import."""


def _at_least(name: str, least: int, value: int) -> None:
    if value < least:
        raise ValueError(f"{name} must be at least {least}, not {value}")


@dataclass(frozen=True)
class Induction:
    """For all time: from reset for k ticks, and from any k ticks in which the claim and all its
    lemmas hold, they hold in the next one."""

    k: int = 1

    def __post_init__(self) -> None:
        _at_least("k", 1, self.k)

    @property
    def depth(self) -> int:
        """How many ticks from reset are checked."""
        return self.k

    def __str__(self) -> str:
        return f"induction, k = {self.k}"


@dataclass(frozen=True)
class Bounded:
    """For the first `depth` ticks after reset only. because: why not for all time."""

    depth: int
    because: str

    def __post_init__(self) -> None:
        _at_least("depth", 1, self.depth)

    def __str__(self) -> str:
        return f"the first {self.depth} ticks"


@dataclass(frozen=True)
class Search:
    """Find a tick from reset with a solver, among the first `depth` ticks, over all stimuli."""

    depth: int = 20

    def __post_init__(self) -> None:
        _at_least("depth", 1, self.depth)


@dataclass(frozen=True)
class Run:
    """Find a tick from reset by running the compiled monitor, where it is too late for a Search.

    stimulus: makes a trace of the monitor's inputs over ticks 0 … ticks - 1 with period TICK;
    inputs left out are 0. None: every input takes random values for random lengths of time, the
    same in every run, `rst` staying 0.
    """

    ticks: int
    stimulus: Callable[[], Trace] | None = None

    def __post_init__(self) -> None:
        _at_least("ticks", 1, self.ticks)


@dataclass(frozen=True)
class Mutant:
    """Gateware broken on purpose: `old`, which is in the source of `module` just once, is `new`.

    module: one of railgate.<function>.gateware or railgate.primitives. rejected: how a tick is
    found in which the claim does not hold.
    """

    name: str
    module: str
    old: str
    new: str
    rejected: Search | Run = Search()

    def __post_init__(self) -> None:
        if not GATEWARE.match(self.module):
            raise ValueError(
                "a mutant's module must be railgate.primitives or railgate.<function>.gateware or "
                f"inside them, not {self.module}"
            )


@dataclass(frozen=True, kw_only=True)
class Claim:
    """One thing that is proven of gateware.

    name: `<function>.<what>`, as `odometer.inputs-reject`. claim: one sentence that also tells
    scaled constants and bounds. requirements: IDs. monitor: makes the Monitor; it imports the
    gateware only when it is called (or elaborated), so that it gets a mutant's. method: how it is
    proven. cover: how a tick is found in which `reached` is 1. mutants: at least two, each to be
    rejected. fast: proof, cover and mutants take less than 20 s and are a part of `make test`.
    Raises ValueError.
    """

    name: str
    claim: str
    requirements: tuple[str, ...]
    monitor: Callable[[], Monitor]
    method: Induction | Bounded
    mutants: tuple[Mutant, ...]
    cover: Search | Run = Search()
    fast: bool = True

    def __post_init__(self) -> None:
        if not NAME.fullmatch(self.name):
            raise ValueError(f'a claim\'s name must be as "odometer.sums", not "{self.name}"')
        for requirement in self.requirements:
            if not REQUIREMENT.fullmatch(requirement):
                raise ValueError(f'a requirement must be as "ODO-1", not "{requirement}"')
        names = [mutant.name for mutant in self.mutants]
        if len(set(names)) < max(2, len(names)):
            raise ValueError(f"{self.name} must have at least two mutants by name, not {names}")
