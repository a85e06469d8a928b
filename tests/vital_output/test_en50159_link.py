"""EN 50159's threats to what the FPGAs tell one another while they drive: a forwarded frame, and
the messages themselves (DRV-6).

A message that tells of a frame for the first time is falsified on the line, its own CRC corrected
where it is the frame that is to be found out.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache

import numpy as np
import pytest

from railgate.vital_output.plant.cpu import Cpus, Frame
from railgate.vital_output.plant.edges import FEMTOSECOND
from railgate.vital_output.simulate import Run
from railgate.waves import Waveform
from vital_output.messages import Line, altered
from vital_output.pair import driving, frames_of, inputs, run, wrong
from vital_output.small import SMALL

pytestmark = pytest.mark.shows("DRV-6", kind="sweep")

LATE = Cpus(phase_s=Fraction(5, 1000))
"""In a cycle's middle, so that no other index is acceptable."""

PAIR = driving(SMALL, 9, ppm_1=-100, ppm_2=100, cpus=LATE)
CYCLE = 11
LAYOUT = SMALL.layout
ALL = (1 << LAYOUT.message_bits) - 1


@cache
def clean() -> Run:
    found = run(PAIR, SMALL)
    assert wrong(found) == ({}, {})
    return found


def frames(fpga: int) -> tuple[Frame, Frame, Frame]:
    """What the CPU sends in CYCLE and in the two cycles before, the last one first."""
    found = frames_of(PAIR, SMALL)[fpga - 1]
    at = next(i for i, frame in enumerate(found) if frame.cycle == CYCLE)
    return found[at], found[at - 1], found[at - 2]


def crc(frame: Frame, board: int, time: int) -> int:
    fields = {name: getattr(frame, name) for name in ("sequence", "image", "acknowledge")}
    return LAYOUT.crc(SMALL.boards[board], time, fields)


def right(frame: Frame) -> int:
    return crc(frame, frame.board, frame.time)


def for_another(fpga: int, other: bool, later: int) -> dict[str, int]:
    frame = frames(fpga)[0]
    board = 1 - frame.board if other else frame.board
    return {"frame_crc": right(frame) ^ crc(frame, board, frame.time + later)}


def old(fpga: int, cycles: int) -> dict[str, int]:
    """The frame of so many cycles before, in the place of the one that came."""
    now, then = frames(fpga)[0], frames(fpga)[cycles]
    return {"sequence": now.sequence ^ then.sequence, "frame_crc": right(now) ^ right(then)}


FORWARD, SKEW = {"forward": 1}, {"skew": 1}
FORWARDED = {
    "repetition": (lambda fpga: old(fpga, 1), {}),
    "re-sequence": (lambda fpga: old(fpga, 2), FORWARD),
    "insertion": (lambda _: {"sequence": 0b1000}, FORWARD),
    "corruption, sequence": (lambda _: {"sequence": 1 << 31}, FORWARD),
    "corruption, image": (lambda _: {"image": 0b10}, FORWARD | SKEW),
    "corruption, acknowledge": (lambda _: {"acknowledge": 0b01}, FORWARD | SKEW),
    "corruption, crc": (lambda _: {"frame_crc": 0xFFFF_FFFF}, FORWARD | SKEW),
    "delay": (lambda fpga: for_another(fpga, False, -1), FORWARD | SKEW),
    "delay, long": (lambda fpga: for_another(fpga, False, -5), FORWARD | SKEW),
    "delay, to come": (lambda fpga: for_another(fpga, False, 1), FORWARD | SKEW),
    "masquerade": (lambda fpga: for_another(fpga, True, 0), FORWARD | SKEW),
    "masquerade, time": (lambda fpga: for_another(fpga, True, -1), FORWARD | SKEW),
}
"""What is inverted in the message, and what the FPGA that takes it tells. A frame with the number
of the one before is taken for that; with another number it is checked, and the right one after it
too."""

MESSAGES = {
    "repetition": (lambda number: {"number": number ^ number - 1}, "link_sequence"),
    "re-sequence": (lambda number: {"number": number ^ number - 2}, "link_sequence"),
    "insertion": (lambda number: {"number": number ^ number + 3}, "link_sequence"),
    "corruption, boot": (lambda _: {"boot": 0b11, "crc": 0}, "link_check"),
    "corruption, test": (lambda _: {"test": 0b11, "crc": 0}, "link_check"),
    "corruption, codes": (lambda _: {"codes": 0b11, "crc": 0}, "link_check"),
    "corruption, carries": (lambda _: {"carries": 1, "crc": 0}, "link_check"),
    "corruption, passed": (lambda _: {"passed": 1, "crc": 0}, "link_check"),
    "corruption, image": (lambda _: {"image": 0b11, "crc": 0}, "link_check"),
    "corruption, crc": (lambda _: {"crc": 0x8000_0001}, "link_check"),
    "another configuration": (lambda _: {"digest": 1}, "link_digest"),
}
"""What is inverted in the message, and its cause."""


def told(fpga: int) -> int:
    """The message of FPGA `fpga` that tells first of its frame of CYCLE."""
    channel, sequence = clean().channels[fpga - 1], frames(fpga)[0].sequence
    changed = channel.wave("sequence")
    return Line(PAIR, SMALL, fpga).first_after(int(changed.ticks[changed.values == sequence][0]))


def disturbed(fpga: int, pattern: int, kind: str = "flip") -> Run:
    """The run with this message falsified."""
    wave = Line(PAIR, SMALL, fpga).disturbed({told(fpga): pattern})
    return run(PAIR, SMALL, inputs(PAIR, SMALL, wires={f"line_{fpga}.{kind}": wave}))


def assert_unmoved(found: Run) -> None:
    """What is commanded and driven is as if nothing had been."""
    for name in (
        "contact",
        *(f"fpga_{c}.{n}" for c in (1, 2) for n in ("image", "states", "life")),
    ):
        assert clean().trace[name].first_difference(found.trace[name]) is None
    for before, after in zip(clean().channels, found.channels, strict=True):
        assert before.total("accepted") == after.total("accepted")
        assert before.total("stored") - after.total("stored") <= 1


@pytest.mark.parametrize("fpga", [1, 2])
@pytest.mark.parametrize("threat", FORWARDED)
def test_a_forwarded_frame_that_is_false_is_rejected_and_not_voted(threat: str, fpga: int) -> None:
    changes, causes = FORWARDED[threat]
    found = disturbed(fpga, altered(SMALL, changes(fpga)))
    assert wrong(found)[2 - fpga] == causes
    assert wrong(found)[fpga - 1] == {}
    assert_unmoved(found)


@pytest.mark.parametrize("fpga", [1, 2])
@pytest.mark.parametrize("threat", MESSAGES)
def test_a_false_message_is_not_taken_and_the_next_one_is(threat: str, fpga: int) -> None:
    changes, cause = MESSAGES[threat]
    found = disturbed(fpga, altered(SMALL, changes(told(fpga) % 256)))
    assert wrong(found)[2 - fpga] == {cause: 1}
    assert wrong(found)[fpga - 1] == {}
    assert_unmoved(found)


@pytest.mark.parametrize("fpga", [1, 2])
def test_a_message_that_does_not_come_has_no_effect(fpga: int) -> None:
    found = disturbed(fpga, ALL, "high")
    assert wrong(found) == ({}, {})
    assert_unmoved(found)


@pytest.mark.parametrize("fpga", [1, 2])
def test_what_an_fpga_sends_itself_it_never_takes(fpga: int) -> None:
    """From CYCLE on its line comes back to it instead of the peer's."""
    own, line = f"fpga_{fpga}.link_tx", f"line_{3 - fpga}"
    begin, end = int(CYCLE * SMALL.cycle_s / FEMTOSECOND), clean().trace.end
    cut = {f"{line}.low": Waveform.of([0, begin], [0, 1])}
    sent = run(PAIR, SMALL, inputs(PAIR, SMALL, wires=cut), also=[own]).trace[own]
    back = sent.slice(begin, end)
    back = Waveform.of(np.append(0, back.ticks), np.append(0, back.values))
    reflected = cut | {f"{line}.high": back}
    found = run(PAIR, SMALL, inputs(PAIR, SMALL, wires=reflected), also=[own])
    assert found.trace[own].first_difference(sent) is None
    causes = wrong(found)[fpga - 1]
    assert causes["link_check"] >= (end - begin) // int(SMALL.cycle_s / FEMTOSECOND) * 8
    assert causes["link_lost"] == 1
    assert found.channels[fpga - 1].wave("linked").values.tolist() == [0, 1, 0]
    assert found.trace["contact"].values.tolist() == [0, 1, 0]


@pytest.mark.shows("DRV-17")
@pytest.mark.parametrize("fpga", [1, 2])
@pytest.mark.parametrize("ahead", [1, 2])
def test_a_message_numbered_ahead_is_a_clock_off_its_tolerance_and_ends_the_drive(
    ahead: int, fpga: int
) -> None:
    number = told(fpga) % 256
    found = disturbed(fpga, altered(SMALL, {"number": number ^ number + ahead}))
    assert wrong(found)[2 - fpga]["oscillator"] > 0
    assert found.trace["contact"].values.tolist() == [0, 1, 0]


def test_every_bit_of_a_message_is_needed() -> None:
    """Each inverted alone, in every other message of both lines."""
    bits = LAYOUT.message_bits
    pair = driving(SMALL, CYCLE + 2 * bits * SMALL.link_period_ticks // SMALL.cycle_ticks)
    first = told(1)
    wires = {
        f"line_{fpga}.flip": Line(pair, SMALL, fpga).disturbed(
            {first + 2 * bit: 1 << bit for bit in range(bits)}
        )
        for fpga in (1, 2)
    }
    found = run(pair, SMALL, inputs(pair, SMALL, wires=wires))
    assert wrong(found) == ({"link_check": bits}, {"link_check": bits})
    assert found.trace["contact"].values.tolist() == [0, 1]
