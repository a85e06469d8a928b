"""Vote, storage and life in the model's channel keep the contract (DRV-6, DRV-7, DRV-15).

Time and messages as in test_command and test_link: phase[k] = k + 990 in cycle 5; message m of the
peer begins in tick 100 + 1336 m and has its verdict in 762 + 1336 m. What comes out of it is in the
registers one tick later. τ0 has 6000 ticks, the decision is at phase 8446.
"""

from dataclasses import replace
from fractions import Fraction

import pytest

from railgate.vital_output.spec import Cause, Config
from vital_output.model.bench import Bench, changes
from vital_output.small import SMALL

PERIOD = 1_336


def verdict(number: int) -> int:
    return 762 + PERIOD * number


def begin(number: int) -> int:
    return 100 + PERIOD * number


def frame(config: Config, index: int, **fields: int) -> dict[str, int]:
    """What the peer's messages tell of its frame."""
    values = {"sequence": 2, "image": 1, "acknowledge": 0, **fields}
    crc = config.layout.crc(config.boards[1], index, values)
    return {"carries": 1, "passed": 0, **values, "frame_crc": crc}


def agreed(config: Config = SMALL, until: int = 60_000, **theirs: int) -> Bench:
    """Frame 2 of cycle 5 has its verdict in 2143; message 2 brings the peer's, with its verdict in
    3568; message 3 that it has passed there."""
    bench = Bench(config)
    bench.trust(5, 1_000)
    bench.frame(1_000, 5, sequence=1)
    assert bench.frame(2_000, 5, sequence=2, image=1) + 134 == 2_143
    bench.peer(100, until, (begin(2), frame(config, 5, **theirs)), (begin(3), {"passed": 1}))
    return bench


def test_what_both_have_sent_passes_and_is_stored_when_both_say_so() -> None:
    run = agreed().run(7_000)
    assert changes(run, "accepted_count") == [(2_144, 1)]
    # Both frames wait from 3569 on; open from 3570 on; the peer says so in 4770.
    assert changes(run, "passed_count") == [(verdict(2) + 134 + 2, 1)] == [(3_570, 1)]
    assert changes(run, "stored_count") == [(verdict(3) + 2, 1)] == [(4_772, 1)]
    for name, value in (("image", 1), ("life", 3)):
        assert changes(run, name) == [(4_772, value)]
    assert changes(run, "acknowledge") == [(4_772, 0)]


@pytest.mark.parametrize(
    "theirs", [{"image": 3}, {"image": 0}, {"acknowledge": 1}, {"sequence": 3}]
)
def test_what_differs_in_anything_is_a_mismatch(theirs: dict[str, int]) -> None:
    run = agreed(**theirs).run(7_000)
    assert changes(run, "mismatch_count") == [(3_570, 1)]
    assert changes(run, "passed_count") == changes(run, "stored_count") == []
    assert changes(run, "first_cause") == [(3_570, Cause.MISMATCH)]


def test_without_the_other_frame_there_is_skew_after_tau0() -> None:
    bench = Bench()
    bench.trust(5, 1_000)
    bench.frame(1_000, 5, sequence=1)
    bench.frame(2_000, 5, sequence=2)  # accepted in 2143: 1 remains in 8143
    run = bench.run(12_000)
    assert changes(run, "skew_count") == [(8_144, 1)]


def test_the_other_frame_alone_is_skew_too_and_so_is_a_wrong_one() -> None:
    bench = Bench()
    bench.trust(5, 1_000)
    bench.peer(100, 9_000, (begin(2), frame(SMALL, 5)))
    assert changes(bench.run(12_000), "skew_count") == [(3_568 + 6_000 + 1, 1)]
    bench.peer(100, 9_000, (begin(2), frame(SMALL, 4)))
    run = bench.run(12_000)
    assert changes(run, "forward_count") == [(3_569, 1)]
    assert changes(run, "skew_count") == []


@pytest.mark.parametrize(("late", "passes"), [(0, True), (1, False)])
def test_the_other_frame_passes_up_to_the_last_tick_of_tau0(late: int, passes: bool) -> None:
    """The peer's frame is there in tick 3569, so own in 9568 at the latest: both are in 9569."""
    bench = Bench()
    bench.trust(5, 1_000)
    bench.frame(1_000, 5, sequence=1)
    bench.peer(100, 9_000, (begin(2), frame(SMALL, 5)))
    bench.frame(9_568 + late - 134 - 9 - 1, 5, sequence=2, image=1)
    run = bench.run(12_000)
    assert bool(changes(run, "passed_count")) == passes
    assert changes(run, "skew_count")[:1] == ([] if passes else [(9_569, 1)])


def test_a_frame_is_forwarded_once() -> None:
    bench = agreed()
    bench.frame(9_500, 5, sequence=3)
    run = bench.run(10_500)
    assert changes(run, "forward_count") == changes(run, "mismatch_count") == []


def test_nothing_is_stored_that_the_peer_has_not_passed() -> None:
    bench = Bench()
    bench.trust(5, 1_000)
    bench.frame(1_000, 5, sequence=1)
    bench.frame(2_000, 5, sequence=2, image=1)
    bench.peer(100, 30_000, (begin(2), frame(SMALL, 5)), (begin(6), {"passed": 1}))
    # Cycle 5 is decided in 11010 + 8446: until then what is open may be stored.
    assert changes(bench.run(12_000), "stored_count") == [(verdict(6) + 2, 1)]
    bench.peer(100, 30_000, (begin(2), frame(SMALL, 5)), (begin(14), {"passed": 1}))
    assert begin(14) < 19_456 < verdict(14)
    assert changes(bench.run(30_000), "stored_count") == []


def test_life_falls_with_each_decision_without_a_frame_and_the_image_with_it() -> None:
    run = agreed().run(60_000)
    # Cycle 5 itself is decided in 19456, 6, 7 and 8 each 12000 later.
    assert changes(run, "life") == [(4_772, 3), (31_457, 2), (43_457, 1), (55_457, 0)]
    assert changes(run, "image") == [(4_772, 1), (55_457, 0)]
    assert changes(run, "life_out_count") == [(55_457, 1)]
    assert changes(run, "blocked") == [(4_773, 1)]


def test_the_image_is_0_at_the_life_bound_in_the_latest_case() -> None:
    """Each cycle is longer by the slew; the last byte comes at the first phase at which the frame
    is good for the next cycle."""
    bench = Bench()
    bench.update(10, 5, 1_000)
    bench.update(20, 5, 1_010 - 300)  # 300 behind: made up for in 15 cycles
    bench.frame(1_000, 5, sequence=1)
    last = bench.frame(10_710 - 9, 6, sequence=2, image=1)
    assert last == 10_710  # phase 11700
    told = {**frame(SMALL, 6), "passed": 1}
    bench.peer(100, 70_000, (begin(8), told))
    run = bench.run(70_000)
    assert changes(run, "image")[0] == (changes(run, "life")[0][0], 1)
    assert changes(run, "image")[-1] == (last + SMALL.life_bound_ticks, 0)
    assert SMALL.life_bound_ticks == 320 + 4 * 12_020 + 8_446 + 1


def test_a_zero_of_either_cpu_is_obeyed_at_once_where_configured() -> None:
    for config, image in ((SMALL, 1), (replace(SMALL, zero_at_once=True), 0)):
        bench = agreed(config)
        bench.frame(6_000, 5, sequence=3, image=2)
        assert changes(bench.run(9_000), "image")[1:] == [(6_144, 0)] * (1 - image)


def test_a_second_rejection_in_the_interval_latches_until_acknowledged() -> None:
    config = replace(SMALL, error_interval_s=Fraction(12, 1000))
    bench = agreed(config)
    bench.frame(5_000, 5, sequence=2)
    bench.frame(5_500, 5, sequence=2)
    later = {**frame(config, 6, sequence=3, image=1, acknowledge=2), "passed": 1}
    bench.frame(13_000, 6, sequence=3, image=1, acknowledge=2)
    first = (begin(2), frame(config, 5)), (begin(3), {"passed": 1})
    bench.peer(100, 20_000, *first, (begin(10), later))
    run = bench.run(20_000)
    assert changes(run, "repetition_count") == [(5_144, 1), (5_644, 2)]
    assert changes(run, "latched_count") == [(5_644, 1)]
    # Both wait from verdict(10) + 135 on, it is open one tick later, and stored in that.
    shown = verdict(10) + 134 + 3
    assert changes(run, "stored_count") == [(4_772, 1), (shown, 2)]
    assert changes(run, "latched") == [(5_644, 1), (shown, 0)]
    # Latched no more, it stores the image of the frame that acknowledges.
    assert changes(run, "image") == [(4_772, 1), (5_644, 0), (shown, 1)]
    assert changes(run, "first_cause")[0] == (5_144, Cause.REPETITION)
    assert (shown, 0) in changes(run, "first_cause")


def test_rejections_far_apart_do_not_latch() -> None:
    config = replace(SMALL, error_interval_s=Fraction(12, 1000))
    bench = agreed(config)
    bench.frame(5_000, 5, sequence=2)  # one interval is over with the next decision, in 7456
    bench.frame(7_400, 5, sequence=2)
    run = bench.run(9_000)
    assert changes(run, "repetition_count") == [(5_144, 1), (7_544, 2)]
    assert changes(run, "latched") == []


def test_a_peer_that_booted_blocks_until_a_live_0() -> None:
    bench = agreed()
    bench.peer(
        100,
        60_000,
        (begin(2), frame(SMALL, 5)),
        (begin(3), {"passed": 1}),
        (begin(5), {"boot": 8}),
    )
    run = bench.run(9_000)
    # Output 1 is commanded 0, and so is not blocked for longer than a tick.
    assert changes(run, "blocked") == [(4_773, 1), (verdict(5) + 1, 3), (verdict(5) + 2, 1)]
