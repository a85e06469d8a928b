"""The reference engine: Amaranth's own simulator, no compiler needed."""

from __future__ import annotations

import heapq
import math
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from functools import partial
from itertools import groupby
from operator import itemgetter
from typing import TYPE_CHECKING, Any

from amaranth.hdl import ClockDomain, Fragment, Value
from amaranth.sim import Simulator

from railgate.engines.design import Clock, Design
from railgate.engines.ports import ports, registers
from railgate.engines.signals import Port, check, chosen, poked
from railgate.waves import Trace, Waveform

if TYPE_CHECKING:
    from amaranth.lib import wiring

__all__ = ["PySim"]


@dataclass(frozen=True)
class Part:
    """The bits of a signal's slot that a port stands for: those of `mask`, from bit `offset`.

    The mask of a signed port has no end, as the numbers in its slot have none.
    """

    slot: Any
    offset: int = 0
    mask: int = -1

    @property
    def value(self) -> int:
        """What these bits hold, settled."""
        return int(self.slot.curr & self.mask) >> self.offset

    def update(self, value: int) -> None:
        """Drive these bits only."""
        self.slot.update(value << self.offset, self.mask)


Event = tuple[int, Part, int | None]
"""A tick, the part of a signal, and the value it takes; None: a clock's active edge."""


@dataclass(frozen=True)
class Checkpoint:
    """Every signal and memory of a design, in order of creation, as in tick `now`.

    design: its name, clocks, and the shapes of these signals and memories.
    """

    design: tuple[Any, ...]
    now: int
    signals: tuple[int, ...]
    memories: tuple[tuple[int, ...], ...]


class PySim:
    """Runs a design in Amaranth's simulator, by the protocol of railgate.engines.Engine.

    Raises ValueError where the design has a domain without a clock, or makes one itself.

    The simulator's public interface can neither force a register nor save its state, so its slots
    are used directly: one per signal with `curr` and `next`, one per memory with `data`. The clock
    edges of one tick are updated together and settled once, so that they sample the same values.
    """

    def __init__(self, design: Design) -> None:
        self._design = design
        self._now = 0
        component = design.component()
        simulator, domains = _simulator(design, component)
        self._ports = ports(component, design.clocks)
        self._inputs = [port for port in self._ports if not port.output]
        self._outputs = [port for port in self._ports if port.output]

        self._engine = simulator._engine
        self._clocks = [Part(self._slot(domain.clk)) for domain in domains]
        members = [_member(component, port) for port in self._ports[: -len(domains)]]
        signals = (*members, *(domain.rst for domain in domains))
        self._parts = {
            port.name: _part(port, self._slot(signal))
            for port, signal in zip(self._ports, signals, strict=True)
        }
        self._changed: list[Port] = []
        for port in self._outputs:
            part = self._parts[port.name]
            part.slot.wakers.append(partial(self._note, port, part.mask))
        found = list(registers(simulator._design, 2))
        self._registers = {each.register.name: each.register for each in found}
        self._forced = {each.register.name: self._slot(each.signal) for each in found}
        self._engine.step_design()

        state = self._engine.state
        self._signals = [self._slot(s) for s in sorted(state.signals, key=lambda s: s.duid)]
        self._memories = [state.slots[index] for index in state.memories.values()]
        self._shapes = (
            design.name,
            design.clocks,
            tuple((slot.signal.name, slot.signal.shape()) for slot in self._signals),
            tuple((len(slot.data), slot.memory.shape) for slot in self._memories),
        )

    def _slot(self, signal: Value) -> Any:
        state = self._engine.state
        return state.slots[state.get_signal(signal)]

    def _note(self, port: Port, mask: int, current: int, following: int) -> bool:
        if (current ^ following) & mask:
            self._changed.append(port)
        return True

    @property
    def now(self) -> int:
        """The tick up to which it has run."""
        return self._now

    @property
    def registers(self) -> tuple[str, ...]:
        """The names that `poke` takes."""
        return tuple(self._registers)

    def advance(self, until: int, stimulus: Trace, outputs: Collection[str] | None = None) -> Trace:
        """Run the ticks now ≤ k < until; see Engine.advance."""
        design = self._design
        check(stimulus, design.name, design.period, self._now, until, self._inputs)
        told = set(chosen(outputs, [port.name for port in self._outputs], design.name))
        kept = [port for port in self._outputs if port.name in told]
        start = self._now
        if until > start:
            for name, wave in stimulus.signals.items():
                self._parts[name].update(int(wave.at(start)))
        self._engine.step_design()
        record = {p.name: ([start], [self._parts[p.name].value]) for p in kept}
        self._changed.clear()
        for tick, events in groupby(self._events(until, stimulus), key=itemgetter(0)):
            self._step(events)
            if tick < until:
                for port in self._changed:
                    if port.name not in told:
                        continue
                    ticks, values = record[port.name]
                    ticks.append(tick)
                    values.append(self._parts[port.name].value)
            self._changed.clear()
        self._now = until
        waves = {p.name: Waveform.of(*record[p.name], p.width, p.signed) for p in kept}
        return Trace(waves, self._design.period, start, until)

    def _events(self, until: int, stimulus: Trace) -> Iterator[Event]:
        """What happens after `now`, by tick: edges up to and with `until`, inputs before it."""
        sources = [
            self._edges(clock, part, until)
            for clock, part in zip(self._design.clocks, self._clocks, strict=True)
        ]
        sources += [
            self._changes(self._parts[name], wave, until) for name, wave in stimulus.signals.items()
        ]
        return heapq.merge(*sources, key=itemgetter(0))

    def _edges(self, clock: Clock, part: Part, until: int) -> Iterator[Event]:
        period = clock.period / self._design.period
        first = max(0, math.floor(self._now / period - clock.phase))
        at = (first + 1 + clock.phase) * period
        unit = math.lcm(at.denominator, period.denominator)
        time, step = int(at * unit), int(period * unit)
        while (tick := -(-time // unit)) <= until:
            yield tick, part, None
            time += step

    def _changes(self, part: Part, wave: Waveform, until: int) -> Iterator[Event]:
        low, high = wave.ticks.searchsorted((self._now + 1, until))
        for at in range(low, high):
            yield int(wave.ticks[at]), part, int(wave.values[at])

    def _step(self, events: Iterator[Event]) -> None:
        """The events of one tick: its clock edges, which sample the inputs before, then inputs."""
        clocks, inputs = [], []
        for _, part, value in events:
            if value is None:
                part.update(1)
                clocks.append(part)
            else:
                inputs.append((part, value))
        if clocks:
            self._engine.step_design()
        for part in clocks:
            part.update(0)
        for part, value in inputs:
            part.update(value)
        self._engine.step_design()

    def poke(self, name: str, value: int) -> None:
        """Force a register to hold `value` in tick `now`; see Engine.poke."""
        poked(self._registers, self._design.name, name, value)
        self._forced[name].update(value)
        self._engine.step_design()

    def checkpoint(self) -> Checkpoint:
        """All of the state; any PySim of the same design can go on from it."""
        signals = tuple(slot.curr for slot in self._signals)
        memories = tuple(tuple(slot.data) for slot in self._memories)
        return Checkpoint(self._shapes, self._now, signals, memories)

    def restore(self, checkpoint: Checkpoint) -> None:
        """Go back (or forth) to the state and tick of a checkpoint.

        Raises ValueError where it is one of another design, or of other clocks.
        """
        if checkpoint.design != self._shapes:
            raise ValueError(
                f"a checkpoint must be of {self._design.name} as it is built and clocked here, "
                "not of another design"
            )
        for slot, value in zip(self._signals, checkpoint.signals, strict=True):
            slot.curr = slot.next = value
        for slot, data in zip(self._memories, checkpoint.memories, strict=True):
            slot.data[:] = data
        self._now = checkpoint.now


def _simulator(design: Design, component: wiring.Component) -> tuple[Simulator, list[ClockDomain]]:
    """The simulator of `component` one level below its top, and the domains of the clocks."""
    fragment = Fragment.get(component, None)
    if own := set(_own_domains(fragment)):
        raise ValueError(
            f"{design.name} must have no domains but those of its clocks, with rising edges, "
            f"not its own {', '.join(sorted(own))}"
        )
    domains = [ClockDomain(clock.domain) for clock in design.clocks]
    top = Fragment()
    top.add_domains(*domains)
    top.add_subfragment(fragment, "design")
    simulator = Simulator(top)
    if unclocked := set(simulator._design.fragment.domains) - {domain.name for domain in domains}:
        raise ValueError(
            f"{design.name} needs a clock for each domain, "
            f"not none for {', '.join(sorted(unclocked))}"
        )
    return simulator, domains


def _own_domains(fragment: Fragment) -> Iterator[str]:
    """The names of the domains that a design makes, on any level."""
    yield from fragment.domains
    for part, *_ in fragment.subfragments:
        yield from _own_domains(part)


def _part(port: Port, slot: Any) -> Part:
    bits = -1 if port.signed else (1 << port.width) - 1
    return Part(slot, port.offset, bits << port.offset)


def _member(component: wiring.Component, port: Port) -> Value:
    member = component
    for part in port.path:
        member = member[part] if isinstance(part, int) else getattr(member, part)
    return Value.cast(member)
