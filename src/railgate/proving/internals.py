"""The signals inside a component, by path, for invariants over what no port shows."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterator
from typing import Any

from amaranth.hdl import Elaboratable, Fragment, Signal, Value
from amaranth.lib import wiring

__all__ = ["Internals"]

NEAREST = 5


class Internals(Elaboratable):
    """A component, elaborated once, that lends out its inner signals; add it as the submodule.

        m.submodules.dut = inner = Internals(dut := FilteredInput(4))
        m.d.comb += self.lemma.counts.eq(inner["held"] <= 4)

    A path is the names of the submodules down to the signal, and the signal's own name, joined by
    dots: `sensor_0.since_rise.ticks`; of an interface's member the names from the port down:
    `sensor_0.stamps.valid`. A submodule without a name is `U$<index>`. Where one level has several
    signals of a name, the second is `<path>$2`. Contents of memories are not signals.
    The signals are to be read, not driven.
    """

    def __init__(self, component: Elaboratable) -> None:
        self._fragment = Fragment.get(component, None)
        self._signals: dict[str, Value] = {}
        levels = list(_levels(self._fragment, ()))
        seen: set[int] = set()
        # A signal belongs where it is a port, else where it is driven, else where it is read.
        for found in (_ports, _driven, _read):
            for path, fragment in levels:
                self._add(path, found(fragment), seen)

    def _add(
        self, path: tuple[str, ...], found: Iterator[tuple[str, Value]], seen: set[int]
    ) -> None:
        for name, value in found:
            signal = Value.cast(value)
            if name and id(signal) not in seen:
                seen.add(id(signal))
                full = unique = ".".join((*path, name))
                times = 1
                while unique in self._signals:
                    times += 1
                    unique = f"{full}${times}"
                self._signals[unique] = value

    @property
    def names(self) -> tuple[str, ...]:
        """All paths."""
        return tuple(self._signals)

    def __getitem__(self, path: str) -> Any:
        """The signal of that path; of a port in its own shape. Raises ValueError."""
        if path in self._signals:
            return self._signals[path]
        near = difflib.get_close_matches(path, self._signals, NEAREST, 0)
        raise ValueError(f'no signal "{path}"; the nearest are: {", ".join(near) or "none"}')

    def elaborate(self, _platform: object) -> Fragment:
        return self._fragment


Level = tuple[tuple[str, ...], Fragment]


def _levels(fragment: Fragment, path: tuple[str, ...]) -> Iterator[Level]:
    yield path, fragment
    for index, (part, name, _) in enumerate(fragment.subfragments):
        yield from _levels(part, (*path, name or f"U${index}"))


def _ports(fragment: Fragment) -> Iterator[tuple[str, Value]]:
    for origin in fragment.origins or ():
        if isinstance(origin, wiring.Component):
            for path, _, value in origin.signature.flatten(origin):
                yield ".".join(map(str, path)), value


def _driven(fragment: Fragment) -> Iterator[tuple[str, Value]]:
    return _named(fragment, lambda statements: statements._lhs_signals())


def _read(fragment: Fragment) -> Iterator[tuple[str, Value]]:
    return _named(fragment, lambda statements: statements._rhs_signals())


def _named(fragment: Fragment, of: Callable[[Any], Any]) -> Iterator[tuple[str, Value]]:
    for statements in fragment.statements.values():
        signals = (signal for signal in of(statements) if isinstance(signal, Signal))
        for signal in sorted(signals, key=lambda signal: signal.duid):
            yield signal.name, signal
