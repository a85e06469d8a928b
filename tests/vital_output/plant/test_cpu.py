"""The CPU pair's frames: what they say, and at which edges their bytes are."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from railgate.vital_output.host import encode
from railgate.vital_output.plant.cpu import Command, Cpus
from vital_output.plant.received import CYCLES, PHASE, edges, frames, sampled, scenario
from vital_output.small import SMALL

CYCLE = SMALL.cycle_ticks
MILLI = Fraction(1, 1000)


@pytest.mark.shows("DRV-1")
def test_each_cycle_has_a_frame_of_each_cpu_for_its_fpga_and_time() -> None:
    for fpga in (1, 2):
        found = frames(scenario(), fpga)
        assert [frame.sequence for frame in found] == list(range(CYCLES - 2))
        assert [frame.made_for for frame in found] == [(fpga - 1, c) for c in range(2, CYCLES)]
        assert {(frame.image, frame.acknowledge) for frame in found} == {(1, 0)}


def test_its_bytes_are_one_in_each_tick_and_change_with_the_edges() -> None:
    told = scenario(ppm_1=Fraction(80), phase_1=Fraction(1, 3))
    inputs = told.controls(SMALL)
    payload, valid = sampled(told, inputs, 1, "command.payload", "command.valid")
    first = valid.index(1)
    data = encode(SMALL, 0, 2, 0, 1)
    expected = [*data]
    expected[0] |= 0x100
    expected[-1] |= 0x200
    assert payload[first : first + len(data) + 1] == [*expected, 0]
    assert valid[first : first + len(data) + 1] == [1] * len(data) + [0]
    # The first tick that begins not before the frame is sent.
    clock = edges(told, 1)
    due = (2 * CYCLE + PHASE) * 10**9
    assert clock.begin(first) >= due > clock.begin(first - 1)
    for name in ("command.payload", "command.valid"):
        ticks = inputs[f"fpga_1.{name}"].ticks
        assert (clock.begin(clock.during(ticks)) == ticks).all()


def test_without_phase_and_ppm_the_first_byte_is_in_the_very_tick() -> None:
    size = SMALL.layout.frame_bytes
    ticks = [frame.tick - size + 1 for frame in frames(scenario(), 1)]
    assert ticks == [c * CYCLE + PHASE for c in range(2, CYCLES)]


def test_a_frame_has_the_command_that_holds_when_its_cycle_begins() -> None:
    commands = (
        Command(start_s=4 * SMALL.cycle_s, image=2),
        Command(start_s=5 * SMALL.cycle_s + Fraction(1, 10**6), image=3, acknowledge=1),
        Command(start_s=8 * SMALL.cycle_s, image=0, acknowledge=2),
    )
    for fpga in (1, 2):
        found = frames(scenario(commands=commands), fpga)
        assert [frame.image for frame in found] == [0, 0, 2, 2, 3, 3, 0, 0, 0, 0]
        assert [frame.acknowledge for frame in found] == [0, 0, 0, 0, 1, 1, 2, 2, 2, 2]


def test_numbers_and_index_begin_where_they_are_told_and_wrap() -> None:
    cpus = Cpus(first_cycle=0, first_sequence=(1 << 32) - 2)
    told = scenario(cpus=cpus, first_index=(1 << 32) - 3)
    inputs = told.controls(SMALL)
    payload, valid = sampled(told, inputs, 1, "command.payload", "command.valid")
    data = bytes(byte & 0xFF for byte, there in zip(payload, valid, strict=True) if there)
    size = SMALL.layout.frame_bytes
    for c in range(CYCLES):
        index, number = (first + c & 0xFFFF_FFFF for first in ((1 << 32) - 3, (1 << 32) - 2))
        assert data[c * size : (c + 1) * size] == encode(SMALL, 0, index, number, 1)


@pytest.mark.parametrize("skew", [-500, 0, 2000])
def test_cpu_2_is_later_by_the_skew(skew: int) -> None:
    told = scenario(cpus=Cpus(skew_s=Fraction(skew, 10**6), phase_s=3 * MILLI))
    one, two = ([frame.tick for frame in frames(told, fpga)] for fpga in (1, 2))
    # Frames are sent in whole µs; FPGA 2's ticks begin half a tick later.
    assert (np.subtract(two, one) == skew).all()


def test_jitter_makes_each_frame_later_at_random_by_the_seed() -> None:
    def late(fpga: int, seed: int) -> list[int]:
        told = scenario(cpus=Cpus(jitter_s=Fraction(1, 1000)), seed=seed)
        clean = [frame.tick for frame in frames(scenario(), fpga)]
        return np.subtract([frame.tick for frame in frames(told, fpga)], clean).tolist()

    one = late(1, 0)
    assert all(0 <= ticks <= 1000 for ticks in one)
    assert len(set(one)) > 5
    assert one == late(1, 0)
    assert one != late(1, 1)
    assert one != late(2, 0)


@pytest.mark.parametrize("extra", [1, 2, 3])
def test_a_frame_waits_until_the_one_before_is_checked(extra: int) -> None:
    faults = ["repetition-1@40ms", "insertion-1@40ms", "delay-1@30ms"][:extra]
    found = frames(scenario(*faults), 1)
    assert len(found) == CYCLES - 2 + (0, 1, 3, 3)[extra]
    ticks = [frame.tick for frame in found if 3 * CYCLE < frame.tick < 4 * CYCLE]
    first = 3 * CYCLE + PHASE + SMALL.layout.frame_bytes - 1
    apart = SMALL.check_ticks + SMALL.layout.frame_bytes - 1
    assert ticks == [first + i * apart for i in range((0, 2, 4, 5)[extra])]


@pytest.mark.parametrize(
    ("settings", "error"),
    [
        ({"skew_s": 11}, "skew_s must be between -10 and 10, not 11"),
        ({"jitter_s": -1}, "jitter_s must be between 0 and 10, not -1"),
        ({"phase_s": -1}, "phase_s must be between 0 and 10, not -1"),
        ({"first_cycle": -1}, "first_cycle must be between 0 and 4294967296, not -1"),
        ({"first_sequence": -1}, "first_sequence must be between 0 and 4294967295, not -1"),
    ],
)
def test_what_is_no_schedule_is_refused(settings: dict[str, int], error: str) -> None:
    with pytest.raises(ValueError, match=error):
        Cpus(**settings)


def test_commands_beyond_the_outputs_are_refused() -> None:
    told = scenario(commands=(Command(start_s=Fraction(0), image=4),))
    with pytest.raises(ValueError, match="image must be between 0 and 0x3, not 0x4"):
        told.controls(SMALL)
