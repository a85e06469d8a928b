"""No error of a hardened register is left open: each counts, and each stops pulses at once."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from importlib import import_module

import pytest
from amaranth.hdl import Fragment, Signal, Value
from amaranth.hdl._ast import Switch

from railgate.proving.claim import Mutant
from railgate.proving.mutation import mutated
from vital_output.small import SMALL

pytestmark = pytest.mark.shows("DRV-16")

FOLDER = "railgate.vital_output.gateware"
CONFIG = replace(SMALL, error_interval_s=3 * SMALL.cycle_s)
HARDENED = {
    "vote.held_remaining",
    "storage.held_life",
    "storage.held_image",
    "storage.errors.held_remaining",
    "shutoff.held_phase",
    *(f"output_{output}.held_{name}" for output in range(2) for name in ("state", "elapsed")),
}


def parts(fragment: Fragment, path: tuple[str, ...] = ()) -> Iterator[tuple[str, Fragment]]:
    yield ".".join(path), fragment
    for part, name, _ in fragment.subfragments:
        yield from parts(part, (*path, str(name)))


def drives(statements, conditions=()) -> Iterator[tuple[Signal, Signal]]:
    """Each signal that is driven, with each that its value depends on."""
    for statement in statements:
        if isinstance(statement, Switch):
            tested = (*conditions, *statement.test._rhs_signals())
            for _, body, _ in statement.cases:
                yield from drives(body, tested)
        else:
            for driven in statement._lhs_signals():
                for read in (*conditions, *statement.rhs._rhs_signals()):
                    yield driven, read


def reached(start: set[int], edges: dict[int, set[int]]) -> set[int]:
    """All that depends on these signals by way of the edges."""
    found, new = set(start), set(start)
    while new:
        new = {driven for read in new for driven in edges.get(read, ())} - found
        found |= new
    return found


def hardened(board: int = 0) -> dict[str, set[str]]:
    """Each hardened register of a channel, with those of `pulses` and `upset_count` that its error
    changes in the next tick."""
    channel = import_module(FOLDER).Channel(CONFIG, board)
    primitives = import_module("railgate.primitives")
    found = list(parts(Fragment.get(channel, None)))
    edges: dict[bool, dict[int, set[int]]] = {True: {}, False: {}}
    for _, fragment in found:
        for domain, statements in fragment.statements.items():
            for driven, read in drives(statements):
                edges[domain == "comb"].setdefault(id(read), set()).add(id(driven))
    told = {}
    for path, fragment in found:
        for origin in fragment.origins or ():
            if isinstance(origin, (primitives.Twin, primitives.SparseState)):
                now = reached({id(origin.error)}, edges[True])
                clocked = {driven for read in now for driven in edges[False].get(read, ())}
                then = reached(clocked, edges[True])
                ports = {name: id(Value.cast(getattr(channel, name))) for name in PORTS}
                told[path] = {name for name, port in ports.items() if port in then}
    return told


PORTS = ("pulses", "upset_count")


@pytest.mark.parametrize("board", [0, 1])
def test_every_error_counts_and_stops_pulses(board):
    assert hardened(board) == {path: set(PORTS) for path in HARDENED}


LEFT_OPEN = [
    ("vote", "self.error.eq(remaining.error)", "self.error.eq(0)", {"vote.held_remaining"}),
    ("storage", "eq(life.error | ", "eq(", {"storage.held_life"}),
    ("storage", "life.error | image.error |", "life.error |", {"storage.held_image"}),
    ("storage", "image.error | error)", "image.error)", {"storage.errors.held_remaining"}),
    ("shutoff", "self.error.eq(held.error)", "self.error.eq(0)", {"shutoff.held_phase"}),
    (
        "output",
        "self.error.eq(state.error | elapsed.error)",
        "self.error.eq(state.error)",
        {f"output_{output}.held_elapsed" for output in range(2)},
    ),
    (
        "channel",
        "upset=upset | upsets.any()",
        "upset=upset",
        {name for name in HARDENED if name.startswith("output")},
    ),
    (
        "channel",
        "upset=upset | upsets.any()",
        "upset=upsets.any()",
        {name for name in HARDENED if not name.startswith("output")},
    ),
]


@pytest.mark.parametrize(("module", "old", "new", "expected"), LEFT_OPEN)
def test_one_that_is_left_open_is_found(module, old, new, expected):
    mutant = Mutant(name="left open", module=f"{FOLDER}.{module}", old=old, new=new)
    with mutated(mutant):
        found = hardened()
    assert {path for path, heard in found.items() if heard != set(PORTS)} == expected
