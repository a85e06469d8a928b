"""A whole run of what is outside the two FPGAs."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from itertools import pairwise
from math import ceil, floor

import numpy as np

from railgate.bounds import require
from railgate.engines import Clock
from railgate.vital_output.plant.cpu import Command, Cpus, stream
from railgate.vital_output.plant.draft import Draft, Hit
from railgate.vital_output.plant.edges import FEMTOSECOND, Edges, femtoseconds
from railgate.vital_output.plant.faults import FAULTS, Fault
from railgate.vital_output.plant.relay import RelayTimes
from railgate.vital_output.plant.time import port, updates
from railgate.vital_output.spec import Config
from railgate.waves import Trace, Waveform

__all__ = ["Scenario"]

BOOT_BITS = 16
MOST_PPM = 100_000


@dataclass(frozen=True, kw_only=True)
class Scenario:
    """A CPU pair, a network's time, two clocks and relays, and what goes wrong with them.

    commands: in order of time; all outputs are 0 before the first. seconds: of the run. ppm_1,
    ppm_2, phase_1, phase_2: of the clocks of FPGA 1 and 2, see railgate.engines.Clock. relay: the
    relays' times. cpus: the CPUs' schedule. first_index: of the system cycle that begins with the
    run. update_cycles: from update to update of time. tests_s: when a test of the shut-off paths is
    demanded of both FPGAs. faults: count in their order. seed: of all that is random. Raises
    ValueError.
    """

    commands: tuple[Command, ...] = ()
    seconds: Fraction = Fraction(1)
    ppm_1: Fraction = Fraction(0)
    ppm_2: Fraction = Fraction(0)
    phase_1: Fraction = Fraction(0)
    phase_2: Fraction = Fraction(1, 2)
    relay: RelayTimes = field(default_factory=RelayTimes)
    cpus: Cpus = field(default_factory=Cpus)
    first_index: int = 0
    update_cycles: int = 1
    tests_s: tuple[Fraction, ...] = ()
    faults: tuple[Fault, ...] = ()
    seed: int = 0

    def __post_init__(self) -> None:
        require(
            self,
            ("seconds", FEMTOSECOND, 8_000),
            ("ppm_1", -MOST_PPM, MOST_PPM),
            ("ppm_2", -MOST_PPM, MOST_PPM),
            ("first_index", 0, (1 << 32) - 1),
            ("update_cycles", 1, 1_000_000),
            ("seed", 0, (1 << 63) - 1),
        )
        for before, after in pairwise(self.commands):
            if not before.start_s < after.start_s:
                raise ValueError(
                    f"commands must be in order of time, not {float(after.start_s):g} s after "
                    f"{float(before.start_s):g} s"
                )

    def clocks(self, config: Config) -> tuple[Clock, Clock, Clock]:
        """Those of fpga_1, fpga_2 and relay. Raises ValueError."""
        fpga = Fraction(config.clock_hz)
        return (
            Clock(frequency_hz=fpga, domain="fpga_1", ppm=self.ppm_1, phase=self.phase_1),
            Clock(frequency_hz=fpga, domain="fpga_2", ppm=self.ppm_2, phase=self.phase_2),
            Clock(frequency_hz=Fraction(self.relay.clock_hz), domain="relay"),
        )

    def controls(self, config: Config) -> Trace:
        """The inputs of a Loop that make it so, in femtoseconds. Raises ValueError."""
        draft = self._draft(config)
        for time in self.tests_s:
            for fpga in (1, 2):
                draft.hold_ticks(fpga, ".test", femtoseconds(time), femtoseconds(time))
        for index, fault in enumerate(self.faults):
            random = np.random.default_rng([self.seed, 1 + index])
            FAULTS[fault.kind].effect(draft, self._hit(fault, config, random))
        signals = draft.wires()
        for c, edges in enumerate(draft.edges):
            told = stream(config, edges, draft.frames[c], draft.end)
            told |= port(config, edges, draft.updates[c], self.first_index, draft.end)
            told["boot"] = _boots(edges, draft.starts[c], draft.end)
            signals |= {f"fpga_{c + 1}.{name}": wave for name, wave in told.items()}
        return Trace(signals, FEMTOSECOND, 0, draft.end)

    def _draft(self, config: Config) -> Draft:
        """The run without faults."""
        cycles = ceil(self.seconds / config.cycle_s)
        random = np.random.default_rng([self.seed, 0])
        clock_1, clock_2, _ = self.clocks(config)
        return Draft(
            config=config,
            edges=(Edges(clock_1), Edges(clock_2)),
            end=femtoseconds(self.seconds),
            frames=list(self.cpus.frames(config, self.commands, self.first_index, cycles, random)),
            updates=[updates(config, cycles, self.update_cycles) for _ in range(2)],
        )

    def _hit(self, fault: Fault, config: Config, random: np.random.Generator) -> Hit:
        """Where the fault hits. Raises ValueError where it is after the run."""
        if fault.start_s >= self.seconds:
            raise ValueError(
                f"{fault.kind} must begin before the run's end at {float(self.seconds):g} s, "
                f"not at {float(fault.start_s):g} s"
            )
        start = floor(fault.start_s / config.cycle_s)
        end = fault.end_s
        if end is None and FAULTS[fault.kind].lasting:
            end = self.seconds
        return Hit(
            kind=fault.kind,
            value=fault.value,
            cycles=range(start, start + 1 if end is None else ceil(end / config.cycle_s)),
            start=femtoseconds(fault.start_s),
            stop=femtoseconds(fault.start_s if end is None else min(end, self.seconds)),
            random=random,
        )


def _boots(edges: Edges, starts: list[int], end: int) -> Waveform:
    """The boot number, one more from each reset on."""
    ticks = np.append(0, sorted(starts))
    return edges.wave(ticks, 1 + np.arange(ticks.size), BOOT_BITS, end)
