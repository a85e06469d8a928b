"""What can be wrong outside the two FPGAs, and with their clocks, by name and time."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from railgate.timed_fault import TimedFault, parsed
from railgate.vital_output.plant import effects
from railgate.vital_output.plant.draft import Effect

__all__ = ["FAULTS", "Fault", "Kind", "fault"]

OUTPUT = ("the output", "0")


@dataclass(frozen=True)
class Kind:
    """does: what the fault does. value: what its number means, empty where it takes none. default:
    the number that it has by itself. lasting: without an end it lasts until the run's."""

    does: str
    effect: Effect
    value: str = ""
    default: str = ""
    lasting: bool = False


def _of_cpu(cpu: int) -> Iterator[tuple[str, Kind]]:
    """What happens to the frames of one CPU, after EN 50159."""
    does, of = f"a frame of CPU {cpu}", effects.of_cpu
    yield (
        f"cpu-{cpu}-dead",
        Kind(f"CPU {cpu} sends nothing", of(cpu, effects.deletion), lasting=True),
    )
    yield f"repetition-{cpu}", Kind(f"{does} comes twice", of(cpu, effects.repetition))
    yield f"deletion-{cpu}", Kind(f"{does} does not come", of(cpu, effects.deletion))
    yield (
        f"insertion-{cpu}",
        Kind(
            f"{does} is followed by one with all outputs 1, of right CRC and time",
            of(cpu, effects.insertion),
            "how far its sequence number is ahead",
            "life_cycles + 1",
        ),
    )
    yield (
        f"resequence-{cpu}",
        Kind(
            f"{does} and the next one come in each other's place, both with right CRC and time",
            effects.resequence(cpu),
        ),
    )
    yield (
        f"corruption-{cpu}",
        Kind(
            f"one bit of {does} is inverted",
            of(cpu, effects.corruption),
            "which one, the first sent is 1",
            "1",
        ),
    )
    yield (
        f"delay-{cpu}",
        Kind(f"{does} comes late", of(cpu, effects.delay), "cycles that it comes later", "1"),
    )
    yield (
        f"masquerade-{cpu}",
        Kind(f"{does} is made for the other FPGA", of(cpu, effects.masquerade)),
    )


def _of_fpga(fpga: int) -> Iterator[tuple[str, Kind]]:
    """What happens to one FPGA, its clock, time and line, and its way to the relay."""
    yield (
        f"link-cut-{fpga}",
        Kind(
            f"the line from FPGA {fpga} to {3 - fpga} holds one level",
            effects.link_cut(fpga),
            "the level",
            "1",
            lasting=True,
        ),
    )
    yield (
        f"restart-{fpga}",
        Kind(f"FPGA {fpga} is reset, for one tick or for the span", effects.restart(fpga)),
    )
    yield (
        f"stopped-{fpga}",
        Kind(f"the clock of FPGA {fpga} stops", effects.stopped(fpga), lasting=True),
    )
    yield (
        f"time-lost-{fpga}",
        Kind(f"no time comes to FPGA {fpga}", effects.time_lost(fpga), lasting=True),
    )
    yield (
        f"time-step-{fpga}",
        Kind(
            f"the time that comes to FPGA {fpga} is ahead",
            effects.time_step(fpga),
            "by how many µs, negative where it is behind",
            "one cycle",
            lasting=True,
        ),
    )
    yield (
        f"time-drift-{fpga}",
        Kind(
            f"the time that comes to FPGA {fpga} runs fast",
            effects.time_drift(fpga),
            "by how many ppm, negative where it runs slow",
            "1000",
            lasting=True,
        ),
    )
    for name, wire, does in (
        ("pulse-open", "open", f"FPGA {fpga} sees its pulses as 0"),
        ("pulse-stuck", "stuck", f"FPGA {fpga} sees its pulses as 1"),
        ("rogue", "rogue", f"a train as of FPGA {fpga} is at the relay, whatever it does"),
    ):
        effect = effects.output_held(f"{wire}_{fpga}")
        yield f"{name}-{fpga}", Kind(does, effect, *OUTPUT, lasting=True)


def _of_relay() -> Iterator[tuple[str, Kind]]:
    for name, wire, does in (
        ("welded", "welded", "the relay's closed contact does not open"),
        ("broken-coil", "broken", "the relay's coil has no current"),
        ("contact-open", "contact_open", "both FPGAs see the contact as open"),
        ("contact-stuck", "contact_stuck", "both FPGAs see the contact as closed"),
    ):
        yield name, Kind(does, effects.output_held(wire), *OUTPUT, lasting=True)


FAULTS: dict[str, Kind] = {
    "disagree": Kind(
        "CPU 2 commands the opposite of CPU 1",
        effects.of_cpu(2, effects.disagree),
        *OUTPUT,
        lasting=True,
    ),
    "skew": Kind(
        "CPU 2's frames come late",
        effects.of_cpu(2, effects.skew),
        "µs that they come later",
        "tau0 and twice the link's latency",
        lasting=True,
    ),
    "switch-over": Kind(
        "both CPUs pause for the cycles hit, then go on with sequence numbers 2³¹ further",
        effects.switch_over,
        "cycles of the pause at least",
        "life_cycles + 2",
    ),
    **{name: kind for cpu in (1, 2) for name, kind in _of_cpu(cpu)},
    "link-noise": Kind(
        "both lines are inverted and back at random",
        effects.link_noise,
        "mean ticks from change to change",
        "as long as a message",
        lasting=True,
    ),
    **{name: kind for fpga in (1, 2) for name, kind in _of_fpga(fpga)},
    **dict(_of_relay()),
    "test-fails": Kind(
        "a test of the shut-off paths is demanded with a train as of FPGA 2 at the relay",
        effects.test_fails,
        *OUTPUT,
        lasting=True,
    ),
}
"""The kinds of fault by name. KIND@TIME lasts from TIME on, of a kind that does not last it hits
the cycle in which TIME falls; KIND@T0..T1 hits the span. Frames and updates of time are hit by
cycles, all those that the span touches."""


@dataclass(frozen=True)
class Fault(TimedFault):
    """One kind of FAULTS from a time on until another; None: see FAULTS. Raises ValueError."""

    def __post_init__(self) -> None:
        self.require(FAULTS)


def fault(text: str) -> Fault:
    """`welded@0.1s`, `stopped-1@60ms..140ms`, `rogue-2:3@20ms` -> the fault. Raises ValueError."""
    return Fault(*parsed(text, FAULTS))
