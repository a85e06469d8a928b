"""Situations worth seeing, each a scenario of its own."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from math import ceil

from railgate.vital_output.plant.cpu import Command
from railgate.vital_output.plant.faults import Fault
from railgate.vital_output.plant.scenario import Scenario
from railgate.vital_output.spec import Config

__all__ = ["SITUATIONS", "Situation", "on_and_off", "ready_s"]

Maker = Callable[[Config], Scenario]


@dataclass(frozen=True)
class Situation:
    """does: what happens, in one sentence. make: the scenario for a configuration."""

    does: str
    make: Maker


def ready_s(config: Config) -> Fraction:
    """When the start-up test is over and a first 0 is stored, a whole number of cycles.

    Each FPGA pulses alone once; around that, states take some messages to be told, and the pulses
    their time to vanish.
    """
    messages = 16 * config.link_period_ticks
    test = 2 * (config.test_ticks + config.zero_ticks + config.contact_filter_ticks) + messages
    return max(5, 1 + ceil(Fraction(test, config.cycle_ticks))) * config.cycle_s


def on_and_off(config: Config, seconds: Fraction) -> tuple[Command, ...]:
    """Output 0 on after a third of what a run has left after the start-up test, off after two."""
    start = ready_s(config)
    third = (seconds - start) / 3
    if third <= 0:
        return ()
    return (
        Command(start_s=start + third, image=1),
        Command(start_s=start + 2 * third, image=0),
    )


@dataclass(frozen=True)
class _Times:
    """Of a situation with something wrong: output 0 is commanded on, its contact has long closed
    when it goes wrong, and the run ends when even the last that follows is over."""

    config: Config

    @property
    def on(self) -> Fraction:
        return ready_s(self.config) + 2 * self.config.cycle_s

    @property
    def wrong(self) -> Fraction:
        """With a cycle's beginning, between two frames."""
        config = self.config
        closed = ceil(Fraction(config.pick_up_ticks, config.cycle_ticks)) * config.cycle_s
        return self.on + closed + 2 * config.cycle_s

    @property
    def over(self) -> Fraction:
        """The reaction is over, and what can come again has come."""
        return self.wrong + self.reaction

    @property
    def reaction(self) -> Fraction:
        """Room for a reaction to be seen."""
        return (ceil(self.config.reaction_s / self.config.cycle_s) + 4) * self.config.cycle_s

    def scenario(self, *faults: Fault, seconds: Fraction | None = None) -> Scenario:
        return Scenario(
            commands=(Command(start_s=self.on, image=1),),
            seconds=self.over if seconds is None else seconds,
            faults=faults,
        )


def _good(config: Config) -> Scenario:
    seconds = ready_s(config) + 15 * config.cycle_s
    return Scenario(commands=on_and_off(config, seconds), seconds=seconds)


def _wrong(kind: str) -> Maker:
    """This kind of fault, from when the contact has closed until the end."""

    def make(config: Config) -> Scenario:
        times = _Times(config)
        return times.scenario(Fault(kind, times.wrong))

    return make


def _restart(config: Config) -> Scenario:
    times, cycle = _Times(config), config.cycle_s
    begun = times.scenario(Fault("restart-1", times.wrong))
    off, again = times.over, times.over + 4 * cycle
    more = (Command(start_s=off, image=0), Command(start_s=again, image=1))
    return replace(begun, commands=(*begun.commands, *more), seconds=again + 6 * cycle)


def _clock_off(config: Config) -> Scenario:
    times = _Times(config)
    return replace(times.scenario(), ppm_1=Fraction(2 * config.drift_limit_ppm))


def _welded(config: Config) -> Scenario:
    times = _Times(config)
    begun = times.scenario(Fault("welded", times.wrong))
    off = Command(start_s=times.wrong + 2 * config.cycle_s, image=0)
    return replace(begun, commands=(*begun.commands, off), seconds=off.start_s + times.reaction)


def _time_lost(config: Config) -> Scenario:
    times = _Times(config)
    held = config.holdover_cycles * config.cycle_s
    return times.scenario(Fault("time-lost-1", times.wrong), seconds=times.over + held)


def _test_fails(config: Config) -> Scenario:
    times = _Times(config)
    test = Fraction(config.test_ticks, config.clock_hz)
    seconds = times.on + 2 * test + 4 * config.cycle_s
    begun = times.scenario(Fault("test-fails", times.on), seconds=seconds)
    return replace(begun, commands=())


SITUATIONS: dict[str, Situation] = {
    "good": Situation("Nothing is wrong: output 0 is commanded on, and off again.", _good),
    "cpu-dead": Situation("CPU 1 falls silent while output 0 is on.", _wrong("cpu-1-dead")),
    "cpus-disagree": Situation(
        "CPU 2 commands output 0 off while CPU 1 commands it on.", _wrong("disagree")
    ),
    "skew": Situation("CPU 2's frames begin to come later than τ0 allows.", _wrong("skew")),
    "link-cut-1": Situation("The line from FPGA 1 to FPGA 2 is cut.", _wrong("link-cut-1")),
    "link-cut-2": Situation("The line from FPGA 2 to FPGA 1 is cut.", _wrong("link-cut-2")),
    "channel-restart": Situation(
        "FPGA 1 starts anew while output 0 is on, which drives again only after a 0.", _restart
    ),
    "cpu-switch-over": Situation(
        "Both CPUs pause, then go on with other sequence numbers.", _wrong("switch-over")
    ),
    "clock-stopped": Situation("FPGA 1's clock stops, its pulses with it.", _wrong("stopped-1")),
    "clock-off": Situation(
        "FPGA 1's clock is off its tolerance from the start: nothing ever drives.", _clock_off
    ),
    "welded-contact": Situation(
        "The contact of output 0 welds, and does not open when commanded off.", _welded
    ),
    "broken-coil": Situation("The relay's coil breaks while on.", _wrong("broken-coil")),
    "feedback-open": Situation(
        "FPGA 1 no longer sees the pulses that it makes.", _wrong("pulse-open-1")
    ),
    "feedback-stuck": Situation(
        "FPGA 1 sees its pulses as a constant level.", _wrong("pulse-stuck-1")
    ),
    "time-lost": Situation(
        "No more time comes to FPGA 1, which trusts its own for a while.", _time_lost
    ),
    "test-fails": Situation(
        "A test of the shut-off paths meets a pulse train that nothing can stop.", _test_fails
    ),
}
"""By name. Each lasts as long as it takes."""
