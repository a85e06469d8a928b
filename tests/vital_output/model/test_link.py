"""The cross-link in the model's channel keeps the contract (DRV-6, DRV-17).

A message has 165 bits of 4 ticks, the next one begins 1336 ticks later. One whose start bit falls
at the pin in tick 100 is seen to begin in 103 and has its verdict in 103 + 164 · 4 + 2 + 1 = 762.
"""

from dataclasses import replace

import pytest

from railgate.vital_output.spec import Cause
from vital_output.model.bench import Bench, changes
from vital_output.small import SMALL

PERIOD = 1_336


def linked() -> Bench:
    """Messages 0 and 1; linked from tick 2099 on."""
    bench = Bench()
    assert [bench.message(100 + PERIOD * number, number) for number in (0, 1)] == [762, 2_098]
    return bench


def test_the_second_message_links_and_the_last_one_holds_for_so_long() -> None:
    run = linked().run(8_000)
    # Lost are 2 messages and half a period: 3340 ticks after 2098.
    assert changes(run, "linked") == [(2_099, 1), (5_439, 0)]
    assert changes(run, "link_lost_count") == [(5_439, 1)]
    assert changes(run, "first_cause") == [(5_439, Cause.LINK_LOST)]


def test_a_lost_link_needs_two_messages_again() -> None:
    bench = linked()
    for number in (4, 5, 9):
        bench.message(100 + PERIOD * number, number)
    run = bench.run(14_000)
    assert changes(run, "linked")[:3] == [(2_099, 1), (5_439, 0), (762 + 5 * PERIOD + 1, 1)]
    assert changes(run, "link_sequence_count") == []  # it is lost again before the last one


def test_a_message_in_the_tick_in_which_the_link_would_be_lost_holds_it() -> None:
    for late, lost in ((-1, 0), (0, 0), (1, 1)):
        bench = linked()
        bench.message(1_436 + 3_340 + late, 2)
        assert len(changes(bench.run(6_000), "link_lost_count")) == lost, late


@pytest.mark.parametrize(("step", "wrong"), [(0, 1), (1, 0), (3, 0), (4, 1), (255, 1)])
def test_steps_of_one_to_three_are_taken(step: int, wrong: int) -> None:
    bench = linked()
    told = bench.message(100 + 2 * PERIOD, 1 + step)
    run = bench.run(5_000)
    assert changes(run, "link_sequence_count") == [(told + 1, 1)] * wrong
    assert changes(run, "linked")[:1] == [(2_099, 1)]


def test_wrong_messages_have_their_causes() -> None:
    bench = linked()
    told = bench.message(100 + 2 * PERIOD, 2, board=0)  # as if its own came back
    assert changes(bench.run(5_000), "link_check_count") == [(told + 1, 1)]
    bench = linked()
    told = bench.message(100 + 2 * PERIOD, 2, digest=SMALL.digest ^ 1)
    run = bench.run(5_000)
    assert changes(run, "link_digest_count") == [(told + 1, 1)]
    assert changes(run, "link_check_count") == []


def test_every_wrong_bit_is_seen() -> None:
    for place in range(1, 165):
        bench = linked()
        at = 100 + 2 * PERIOD + 4 * place
        told = bench.message(100 + 2 * PERIOD, 2)
        levels = {tick: bench.drawn["link_rx"][tick] for tick in (at, at + 4)}
        bench.set("link_rx", at, 1 - levels[at])
        run = bench.run(4_000, ["link_check_count"])
        assert changes(run, "link_check_count")[:1] == [(told + 1, 1)], place


def test_a_start_bit_that_is_none_is_link_check_in_its_middle() -> None:
    for ticks, wrong in ((1, 1), (2, 1), (3, 0)):
        bench = Bench()
        bench.set("link_rx", 50, 0)  # begins in 53, is sampled in 55
        bench.set("link_rx", 50 + ticks, 1)
        run = bench.run(100)
        assert changes(run, "link_check_count") == [(56, 1)] * wrong, ticks


def test_a_message_may_begin_in_the_tick_of_the_verdict_but_not_before() -> None:
    """It falls within the last bit of the one before, which must be a 1."""
    boot = next(boot for boot in range(64) if last_bit(boot))
    for late, links in ((-1, False), (0, True)):
        bench = Bench()
        assert bench.message(100, 0, boot=boot) == 762
        del bench.drawn["link_rx"][760]
        told = bench.message(759 + late, 1)
        run = bench.run(3_000)
        assert changes(run, "linked") == [(told + 1, 1)] * links, late


def last_bit(boot: int) -> int:
    bench = Bench()
    bench.message(0, 0, boot=boot)
    return max((tick, level) for tick, level in bench.drawn["link_rx"].items() if tick < 660)[1]


def test_the_first_level_is_no_edge() -> None:
    bench = Bench()
    bench.set("link_rx", 0, 0)
    bench.set("link_rx", 500, 1)
    assert changes(bench.run(2_000), "link_check_count") == []


def test_short_levels_vanish_in_the_filter() -> None:
    config = replace(SMALL, link_filter_ticks=1)
    for ticks, count in ((1, 0), (2, 1)):
        bench = Bench(config)
        bench.set("link_rx", 50, 0)
        bench.set("link_rx", 50 + ticks, 1)
        # Behind the filter it begins in 54 and is sampled in 56, when 2 ticks are over.
        run = bench.run(100)
        assert changes(run, "link_check_count") == [(57, 1)] * count, ticks


def test_a_clock_beyond_the_limit_drifts_until_a_window_is_right() -> None:
    """4 ‰ off, 17 ticks are too many: at 3 ticks a message the 6th after the first taken one."""
    bench = Bench()
    for number in range(60):
        late = 3 * min(number, 7)
        told = bench.message(100 + PERIOD * number + late, number)
        if number == 7:
            drifts = told
    run = bench.run(100 + PERIOD * 60)
    assert changes(run, "oscillator_count") == [(drifts + 1, 1)]
    # The window is of 32 messages, from the one that was too late.
    assert changes(run, "drifting") == [(drifts + 1, 1), (drifts + 32 * PERIOD + 1, 0)]


def test_what_goes_out_is_the_message_of_the_registers() -> None:
    bench = Bench(board=1)
    bench.set("boot", 0, 0xBEEF)
    bench.set("boot", 1, 0)
    run = bench.run(2_600)
    peer = Bench(board=0)  # whose peer is FPGA 2
    for number in (0, 1):
        peer.message(8 + PERIOD * number, number, boot=0xBEEF)
    assert run["link_tx"] == peer.stimulus(2_600)["link_rx"]


def test_a_reset_cuts_a_message_short() -> None:
    bench = Bench()
    bench.set("rst", 200, 1)
    bench.set("rst", 201, 0)
    again = bench.run(900)["link_tx"]
    whole = Bench().run(900)["link_tx"]
    assert again.at(range(201)).tolist() == whole.at(range(201)).tolist()
    assert again.at(range(201, 900)).tolist() == whole.at(range(699)).tolist()
