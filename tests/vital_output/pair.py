"""Runs of the pair with frames, updates of time and wires of a test's own."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from fractions import Fraction
from math import ceil
from typing import Any

import numpy as np

from railgate.engines import Engine, open_engine
from railgate.engines.signals import parts
from railgate.vital_output.loop import loop
from railgate.vital_output.plant.cpu import Command, Frame, stream
from railgate.vital_output.plant.edges import Edges
from railgate.vital_output.plant.relay import RelayTimes
from railgate.vital_output.plant.scenario import Scenario
from railgate.vital_output.plant.time import Update, port
from railgate.vital_output.simulate import COUNTS, Run
from railgate.vital_output.situations import ready_s
from railgate.vital_output.spec import Config, State
from railgate.waves import Trace, Waveform

__all__ = [
    "COMMON",
    "ENGINE",
    "RELAY",
    "busy",
    "driving",
    "entries",
    "frames_of",
    "inputs",
    "opened",
    "run",
    "totals",
    "wrong",
]

ENGINE = "leap"
"""What all of these runs are made with; that it is the gateware's twin is tested elsewhere."""

RELAY = RelayTimes(clock_hz=100_000, pick_up_s=Fraction(8, 10_000), release_s=Fraction(8, 1000))
"""Almost as slow as the scaled configuration lets it be."""

COMMON = ("accepted", "start", "passed", "stored")
"""What is counted where nothing is wrong."""


def driving(config: Config, cycles: int, **settings: Any) -> Scenario:
    """Output 0 is commanded on from the end of the start-up on, for so many cycles."""
    on = ready_s(config) + config.cycle_s
    scenario = {"commands": (Command(start_s=on, image=1),), "relay": RELAY}
    return Scenario(**{**scenario, **settings}, seconds=on + cycles * config.cycle_s)


def frames_of(scenario: Scenario, config: Config) -> tuple[list[Frame], list[Frame]]:
    """What CPU 1 and CPU 2 send without faults."""
    cycles = ceil(scenario.seconds / config.cycle_s)
    random = np.random.default_rng([scenario.seed, 0])
    return scenario.cpus.frames(config, scenario.commands, scenario.first_index, cycles, random)


def inputs(
    scenario: Scenario,
    config: Config,
    frames: Sequence[Sequence[Frame]] | None = None,
    updates: Sequence[Sequence[Update]] | None = None,
    wires: Mapping[str, Waveform] | None = None,
) -> Trace:
    """Those of the scenario, but for these frames and updates of FPGA 1 and 2, and these wires."""
    given = scenario.controls(config)
    signals = {**given.signals, **(wires or {})}
    for c, clock in enumerate(scenario.clocks(config)[:2]):
        edges, own = Edges(clock), {}
        if frames:
            own |= stream(config, edges, frames[c], given.end)
        if updates:
            own |= port(config, edges, updates[c], scenario.first_index, given.end)
        signals |= {f"fpga_{c + 1}.{name}": wave for name, wave in own.items()}
    return Trace(signals, given.period, 0, given.end)


def opened(scenario: Scenario, config: Config, delay_ticks: int = 0) -> Engine:
    """The closed loop at its start."""
    return open_engine(loop(config, scenario.relay, scenario.clocks(config), delay_ticks), ENGINE)


def run(
    scenario: Scenario,
    config: Config,
    given: Trace | None = None,
    delay_ticks: int = 0,
    also: Collection[str] = (),
) -> Run:
    """With all inputs, fields and the contact, and these outputs too."""
    given = scenario.controls(config) if given is None else given
    fields = [name for field in config.fields for name, *_ in parts(field.name, field.width)]
    told = [f"fpga_{fpga}.{name}" for fpga in (1, 2) for name in ("command.ready", *fields)]
    found = opened(scenario, config, delay_ticks).advance(
        given.end, given, ["contact", *told, *also]
    )
    trace = given.merge(found)
    return Run(engine=ENGINE, config=config, scenario=scenario, trace=trace, waves=trace)


def totals(of: Run) -> tuple[dict[str, int], dict[str, int]]:
    """All that FPGA 1 and FPGA 2 have counted."""
    first, second = (
        {name: channel.total(name) for name in COUNTS if channel.total(name)}
        for channel in of.channels
    )
    return first, second


def wrong(of: Run) -> tuple[dict[str, int], dict[str, int]]:
    """All that they have counted but what is counted where nothing is wrong."""
    first, second = (
        {name: count for name, count in each.items() if name not in COMMON} for each in totals(of)
    )
    return first, second


def entries(of: Run, fpga: int, output: int, state: State) -> list[int]:
    """The femtoseconds in which an output enters a state."""
    transitions = of.channels[fpga - 1].transitions(output)
    return [at for at, _, new in transitions if new == state]


def busy(
    scenario: Scenario, config: Config, fpga: int, spans: Sequence[tuple[int, int]]
) -> Waveform:
    """For `relay.stuck_…` of the FPGA: feedback of pulses that keeps output 0 from IDLE during
    these femtoseconds, by rises that are neither 0 Hz nor the right frequency."""
    edges, ticks = Edges(scenario.clocks(config)[fpga - 1]), []
    zero, apart = config.zero_ticks, config.zero_ticks * 3 // 4
    for begin, end in spans:
        first, last = edges.during([begin, end]).tolist()
        rises = np.arange(last - zero, first, -apart)[::-1]
        ticks += np.stack([rises, rises + apart // 2], axis=1).ravel().tolist()
    times = edges.begin(ticks)
    return Waveform.of(np.append(0, times), np.arange(times.size + 1) % 2, config.outputs)
