"""Command frames in the model's channel keep the contract (DRV-1, DRV-2, DRV-5).

A frame has 10 bytes, its verdict comes 134 ticks after the last and shows one later. Time is such
that phase[k] = k + 990 in cycle 5 and that cycle 6 begins in tick 11010.
"""

from dataclasses import replace

import pytest

from railgate.vital_output.spec import Cause
from vital_output.model.bench import Bench, changes, framed
from vital_output.small import SMALL

VERDICT = 134


def bench(board: int = 0) -> Bench:
    made = Bench(board=board)
    made.trust(5, 1_000)
    return made


def test_ready_is_low_from_the_last_byte_to_the_verdict() -> None:
    made = bench()
    last = made.frame(1_000, 5)
    assert last == 1_009
    run = made.run(2_000)
    assert changes(run, "command.ready") == [(1_010, 0), (1_143, 1)]
    assert changes(run, "start_count") == [(1_144, 1)]


def test_bytes_wait_until_ready() -> None:
    made = bench()
    made.frame(1_000, 5, sequence=1)
    made.data(1_143, framed(SMALL, 0, 5, sequence=2))
    made.set("command.payload", 1_010, made.drawn["command.payload"][1_143])
    made.set("command.valid", 1_010, 1)  # the first byte is there from here on
    run = made.run(3_000)
    assert changes(run, "command.ready") == [(1_010, 0), (1_143, 1), (1_153, 0), (1_286, 1)]
    assert changes(run, "accepted_count") == [(1_287, 1)]
    assert changes(run, "sequence") == [(1_287, 2)]


@pytest.mark.parametrize(
    "data",
    [
        pytest.param(framed(SMALL, 0, 5)[:4] + framed(SMALL, 0, 5)[5:], id="short"),
        pytest.param(framed(SMALL, 0, 5)[:5] + framed(SMALL, 0, 5)[4:], id="long"),
        pytest.param([framed(SMALL, 0, 5)[0] & 255, *framed(SMALL, 0, 5)[1:]], id="headless"),
        pytest.param(framed(SMALL, 0, 5)[:3] + framed(SMALL, 0, 5), id="begun anew"),
        pytest.param(framed(SMALL, 0, 5, image=4), id="image beyond"),
        pytest.param(framed(SMALL, 0, 5, acknowledge=128), id="acknowledge beyond"),
    ],
)
def test_what_is_no_frame_is_format(data: list[int]) -> None:
    made = bench()
    last = made.data(1_000, data)
    run = made.run(2_000)
    assert changes(run, "format_count") == [(last + VERDICT + 1, 1)]
    assert changes(run, "first_cause") == [(last + VERDICT + 1, Cause.FORMAT)]
    assert changes(run, "start_count") == []


def test_bytes_before_the_first_are_of_no_frame() -> None:
    made = bench()
    last = made.data(1_000, [1, 2, 3, *framed(SMALL, 0, 5)])
    assert changes(made.run(2_000), "start_count") == [(last + VERDICT + 1, 1)]


def test_without_trusted_time_a_frame_is_format_or_time() -> None:
    made = Bench()
    made.frame(1_000, 0)
    made.data(2_000, [1, 512])
    run = made.run(3_000)
    assert changes(run, "time_count") == [(1_144, 1)]
    assert changes(run, "format_count") == [(2_001 + VERDICT + 1, 1)]


@pytest.mark.parametrize("board", [0, 1])
@pytest.mark.parametrize(
    ("last", "index", "other", "counter"),
    [
        (5_000, 5, False, "start"),
        (5_000, 4, False, "delay"),
        (5_000, 3, False, "delay"),
        (5_000, 2, False, "corruption"),
        (5_000, 6, False, "delay"),
        (5_000, 7, False, "corruption"),
        (10_709, 6, False, "delay"),
        (10_710, 6, False, "start"),  # phase 11700, the margin before the end
        (11_309, 5, False, "start"),  # phase 299, the margin's last
        (11_310, 5, False, "delay"),
        (5_000, 5, True, "masquerade"),
        (5_000, 3, True, "masquerade"),
        (5_000, 6, True, "masquerade"),
        (5_000, 7, True, "corruption"),
    ],
)
def test_each_board_and_cycle_has_its_verdict(
    board: int, last: int, index: int, other: bool, counter: str
) -> None:
    made = bench(board)
    made.frame(last - 9, index, board=board ^ int(other), sequence=3)
    run = made.run(12_000)
    counters = ("start", "delay", "corruption", "masquerade", "time", "format", "comparator")
    seen = {name: changes(run, f"{name}_count") for name in counters}
    assert seen.pop(counter) == [(last + VERDICT + 1, 1)]
    assert not any(seen.values())


def test_a_wrong_bit_anywhere_is_corruption() -> None:
    for place in range(80):
        made = bench()
        data = framed(SMALL, 0, 5, sequence=0x12345678, image=1, acknowledge=2)
        data[place // 8] ^= 1 << place % 8
        made.data(1_000, data)
        run = made.run(1_200, ["corruption_count", "format_count"])
        beyond = place // 8 in (4, 5) and place % 8 > 1
        name = "format_count" if beyond else "corruption_count"
        assert changes(run, name) == [(1_144, 1)], place


def test_sequence_numbers_tell_what_is_accepted() -> None:
    made = bench()
    sent = (9, 9, 10, 12, 11, 11, 8, 12)
    for place, sequence in enumerate(sent):
        made.frame(1_000 + 500 * place, 5, sequence=sequence)
    run = made.run(6_000)
    shown = [1_144 + 500 * place for place in range(len(sent))]
    assert changes(run, "start_count") == [(shown[0], 1)]
    # With life 0 each good frame is the reference of the next.
    assert changes(run, "repetition_count") == [(shown[1], 1), (shown[5], 2)]
    assert changes(run, "accepted_count") == [(shown[2], 1)]
    assert changes(run, "insertion_count") == [(shown[3], 1), (shown[7], 2)]
    assert changes(run, "resequence_count") == [(shown[4], 1), (shown[6], 2)]
    assert changes(run, "sequence") == [(shown[2], 10)]
    assert changes(run, "lost_count") == []


def test_sequence_numbers_go_on_beyond_their_width() -> None:
    made = bench()
    made.frame(1_000, 5, sequence=(1 << 32) - 1)
    made.frame(2_000, 5, sequence=0)
    run = made.run(3_000)
    assert changes(run, "accepted_count") == [(2_144, 1)]


def test_counters_take_their_width() -> None:
    made = Bench(replace(SMALL, count_bits=4))
    for place in range(18):
        made.data(1_000 + 200 * place, [1 << 9])
    run = made.run(5_000)
    assert [value for _, value in changes(run, "format_count")] == [*range(1, 16), 0, 1, 2]
