"""Monitors as they run: what a stimulus from reset makes them tell."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from amaranth.hdl import Value
from amaranth.sim import Simulator

from railgate.engines import Clock, Design, open_engine
from railgate.engines.ports import ports
from railgate.engines.signals import Port
from railgate.proving.claim import TICK, Claim, Mutant, Run
from railgate.proving.monitor import LEMMA, Monitor
from railgate.proving.mutation import elaborated
from railgate.waves import Trace, Waveform

__all__ = ["Fall", "fall", "inputs", "reached", "stimulus", "told"]

CLOCK = Clock(frequency_hz=1 / TICK)
SEED = 1
SHORT_BITS = 8
"""Random values are held for less than 2^SHORT_BITS ticks, short times as often as long ones."""


@dataclass(frozen=True)
class Fall:
    """The first tick in which an output of a monitor is 0 while all was as assumed."""

    tick: int
    output: str

    def __str__(self) -> str:
        return f"{self.output} is 0 in tick {self.tick}"


def inputs(monitor: Monitor) -> tuple[Port, ...]:
    """What drives it, `rst` at the end."""
    return tuple(port for port in ports(monitor, (CLOCK,)) if not port.output)


def told(claim: Claim, mutant: Mutant | None, given: Trace, engine: str) -> Trace:
    """All outputs of the claim's monitor, in which a mutant may be, over a stimulus from reset."""
    monitor = elaborated(claim, mutant)
    if monitor.domains:
        return _simulated(monitor, given)
    design = Design(name=claim.name, component=lambda: monitor, clocks=(CLOCK,))
    return open_engine(design, engine).advance(given.end, given)


def _simulated(monitor: Monitor, given: Trace) -> Trace:
    """The same of a monitor with domains of its own, which engines do not have, without resets."""
    values = {".".join(map(str, path)): v for path, _, v in monitor.signature.flatten(monitor)}
    driven = {name: given[name] for name in values if name in given.signals}
    read = {name: Value.cast(value) for name, value in values.items() if name not in driven}
    rows: list[list[int]] = []

    async def bench(context: Any) -> None:
        for tick in range(given.end):
            for name, wave in driven.items():
                context.set(values[name], int(wave.at(tick)))
            rows.append([context.get(value) for value in read.values()])
            await context.tick()

    simulator = Simulator(monitor)
    simulator.add_clock(float(TICK))
    simulator.add_testbench(bench)
    simulator.run()
    told = zip(read.items(), zip(*rows, strict=True), strict=True)
    waves = {n: Waveform.of(range(given.end), column, len(v)) for (n, v), column in told}
    return Trace(waves, TICK, 0, given.end)


def fall(outputs: Trace, *, helped: bool = True) -> Fall | None:
    """The first fall of `holds` or, where `helped`, of a lemma, if there is one."""
    until = _first(outputs["assumed"], 0, outputs.end)
    names = [name for name in outputs.signals if helped and name.startswith(f"{LEMMA}.")]
    falls = [Fall(_first(outputs[name], 0, until), name) for name in ("holds", *names)]
    first = min(falls, key=lambda each: each.tick)
    return first if first.tick < until else None


def reached(outputs: Trace) -> bool:
    """Whether the cover is reached while all is as assumed."""
    until = _first(outputs["assumed"], 0, outputs.end)
    return _first(outputs["reached"], 1, until) < until


def _first(wave: Waveform, value: int, end: int) -> int:
    """The first tick with this value, or `end`."""
    ticks = wave.ticks[wave.values == value]
    return min(int(ticks[0]), end) if ticks.size else end


def stimulus(run: Run, monitor: Monitor) -> Trace:
    """What a Run drives the monitor with. Raises ValueError where it is too short."""
    if run.stimulus is None:
        random = np.random.default_rng(SEED)
        waves = {p.name: _random(random, p, run.ticks) for p in inputs(monitor) if p.name != "rst"}
        return Trace(waves, TICK, 0, run.ticks)
    return run.stimulus().slice(0, run.ticks)


def _random(random: np.random.Generator, port: Port, ticks: int) -> Waveform:
    lengths = (2 ** random.uniform(0, SHORT_BITS, ticks)).astype(np.int64)
    at = np.concatenate(([0], np.cumsum(lengths)))
    at = at[at < ticks]
    low = -(1 << port.width - 1) if port.signed else 0
    high = low + (1 << port.width) - 1
    values = random.integers(low, high, at.size, np.int64 if port.signed else np.uint64, True)
    return Waveform.of(at, values, port.width, port.signed)
