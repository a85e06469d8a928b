"""Random scenarios of the pair: clocks, CPUs, commands, and what goes wrong."""

from __future__ import annotations

from collections.abc import Collection
from fractions import Fraction

from hypothesis import strategies as st

from railgate.vital_output.plant.cpu import Command, Cpus
from railgate.vital_output.plant.faults import FAULTS, Fault
from railgate.vital_output.plant.relay import RelayTimes
from railgate.vital_output.plant.scenario import Scenario
from railgate.vital_output.situations import ready_s
from railgate.vital_output.spec import Config
from vital_output.runs import RELAY

__all__ = ["clocks", "odd_clocks", "scenarios"]

PPM = st.one_of(st.sampled_from((-100, 0, 100)), st.integers(-100, 100)).map(Fraction)
PHASES = st.one_of(st.just(Fraction(0)), st.integers(0, 999).map(lambda n: Fraction(n, 1000)))
FIRST = st.one_of(st.sampled_from((0, 2**31 - 4, 2**32 - 6)), st.integers(0, (1 << 32) - 1))
"""Of what counts modulo 2³²."""


@st.composite
def clocks(draw: st.DrawFn) -> dict[str, Fraction]:
    """Two good ones, of any phase."""
    ppm = {f"ppm_{fpga}": draw(PPM) for fpga in (1, 2)}
    return ppm | {f"phase_{fpga}": draw(PHASES) for fpga in (1, 2)}


@st.composite
def odd_clocks(draw: st.DrawFn) -> dict[str, Fraction]:
    """One of them is off its tolerance, by little or by much."""
    off = draw(st.integers(7, 16).flatmap(lambda power: st.integers(101, 1 << power)))
    fpga, sign = draw(st.sampled_from((1, 2))), draw(st.sampled_from((1, -1)))
    return draw(clocks()) | {f"ppm_{fpga}": Fraction(sign * off)}


@st.composite
def cpus(draw: st.DrawFn, config: Config) -> Cpus:
    """As near to a cycle's boundaries and as far apart as they may be."""
    jitter = draw(st.sampled_from((0, 0, 100)))
    most = config.tau0_ticks - config.latency_ticks - config.drift_in(config.tau0_ticks) - jitter
    skew = draw(st.integers(-most, most))
    room = config.margin_ticks - 2 * config.slew_ticks - config.layout.frame_bytes
    first = max(0, -skew - room)
    last = config.cycle_ticks + room - max(skew, 0) - jitter
    phase = draw(st.one_of(st.integers(first, last), st.sampled_from((first, last))))
    tick = Fraction(1, config.clock_hz)
    times = {"phase_s": phase * tick, "skew_s": skew * tick, "jitter_s": jitter * tick}
    return Cpus(**times, first_sequence=draw(FIRST))


@st.composite
def commands(draw: st.DrawFn, config: Config, start: int, end: int) -> tuple[Command, ...]:
    """Between these ticks, mostly a whole number of cycles one after the other."""
    found, at = [], start + draw(st.integers(0, config.cycle_ticks))
    every = st.integers(0, (1 << config.outputs) - 1)
    while at < end:
        time = Fraction(at, config.clock_hz)
        found.append(Command(start_s=time, image=draw(every), acknowledge=draw(every)))
        at += draw(st.integers(1, 5)) * config.cycle_ticks
        at += draw(st.one_of(st.just(0), st.integers(0, config.cycle_ticks)))
    return tuple(found)


def values(config: Config, kind: str) -> st.SearchStrategy[int | None]:
    """What a kind of fault may be given."""
    if not FAULTS[kind].value:
        return st.none()
    cycle_us = int(config.cycle_s * 10**6)
    low, high = {
        "skew": (0, cycle_us),
        "switch-over": (0, 8),
        "insertion": (1, 20),
        "corruption": (1, 8 * config.layout.frame_bytes),
        "delay": (1, config.delay_cycles + 2),
        "link-noise": (2, 8 * config.message_ticks),
        "link-cut": (0, 1),
        "time-step": (-3 * cycle_us, 3 * cycle_us),
        "time-drift": (-30_000, 30_000),
    }.get(kind.removesuffix("-1").removesuffix("-2"), (0, config.outputs - 1))
    return st.none() | st.integers(low, high)


@st.composite
def faults(draw: st.DrawFn, config: Config, kinds: Collection[str], end: int) -> Fault:
    """One of these kinds that begins before the tick `end`, from a moment to many cycles long."""
    kind = draw(st.sampled_from(sorted(kinds)))
    start = Fraction(draw(st.integers(0, end - 1)), config.clock_hz)
    ticks = draw(st.integers(0, 17).flatmap(lambda power: st.integers(1, 1 << power)))
    stop = draw(st.sampled_from((None, start + Fraction(ticks, config.clock_hz))))
    return Fault(kind, start, stop, draw(values(config, kind)))


@st.composite
def scenarios(
    draw: st.DrawFn,
    config: Config,
    cycles: int,
    timing: st.SearchStrategy[dict[str, Fraction]] | None = None,
    kinds: Collection[str] = (),
    most: int = 0,
    relay: RelayTimes = RELAY,
) -> Scenario:
    """Commands for so many cycles after the start-up, and at most so many faults at any time.

    timing: of the clocks; good ones without it.
    """
    start = int(ready_s(config) * config.clock_hz)
    end = start + cycles * config.cycle_ticks
    found = [draw(faults(config, kinds, end)) for _ in range(draw(st.integers(0, most)))]
    return Scenario(
        **draw(clocks() if timing is None else timing),
        commands=draw(commands(config, start, end)),
        seconds=Fraction(end, config.clock_hz),
        relay=relay,
        cpus=draw(cpus(config)),
        first_index=draw(FIRST),
        faults=tuple(found),
        seed=draw(st.integers(0, 9)),
    )
