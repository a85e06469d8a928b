"""The own time of the model's channel keeps the contract (DRV-3). A cycle has 12 000 ticks, the
margin is 300, a cycle is longer or shorter by 20 at most."""

from dataclasses import replace
from fractions import Fraction

import pytest

from vital_output.model.bench import Bench, changes
from vital_output.small import SMALL

END = 40_000


def test_time_runs_from_reset_on_though_nothing_seats_it() -> None:
    assert changes(Bench().run(END), "index") == [(12_000, 1), (24_000, 2), (36_000, 3)]


def test_the_first_update_seats_time_wherever_it_is_and_the_second_is_trusted() -> None:
    bench = Bench()
    bench.update(100, 7, 5_000)  # phase is 5001 in tick 101, and 11999 in 7099
    bench.update(200, 7, 5_100)
    run = bench.run(END)
    assert changes(run, "index") == [(101, 7), (7_100, 8), (19_100, 9), (31_100, 10)]
    assert changes(run, "trusted") == [(202, 1)]
    assert changes(run, "time_jump_count") == []


def test_an_update_in_the_last_tick_of_a_cycle_seats_time_in_the_next() -> None:
    bench = Bench()
    bench.update(10, (1 << 32) - 1, 11_999)
    assert changes(bench.run(END), "index") == [(12_011, 1), (24_011, 2), (36_011, 3)]


@pytest.mark.parametrize(
    ("by", "ends"),
    [
        (30, (11_980, 23_970, 35_970)),
        (-30, (12_020, 24_030, 36_030)),
        (20, (11_980, 23_980, 35_980)),
    ],
)
def test_what_time_is_off_is_made_up_for_by_so_much_a_cycle(by: int, ends: tuple[int, ...]) -> None:
    bench = Bench()
    bench.update(99, 0, 99)
    bench.update(200, 0, 200 + by)
    assert changes(bench.run(END), "index") == [(end, i + 1) for i, end in enumerate(ends)]


def test_a_good_update_in_the_tick_in_which_a_cycle_ends_counts_what_that_makes_up_for() -> None:
    bench = Bench()
    bench.update(99, 0, 99)
    bench.update(200, 0, 230)  # 30 ahead: the cycle ends in 11979, 20 of them made up for
    bench.update(11_979, 1, 25)  # 12025 against 11979: 46 ahead, less 20
    run = bench.run(END)
    assert changes(run, "index") == [(11_980, 1), (23_960, 2), (35_954, 3)]


@pytest.mark.parametrize(("off", "jumps"), [(-300, 0), (-301, 1), (300, 0)])
def test_beyond_the_margin_time_jumps(off: int, jumps: int) -> None:
    bench = Bench()
    bench.trust(0, 1_000)
    bench.update(5_000, 0, 5_990 + off)
    run = bench.run(10_900)
    assert changes(run, "time_jump_count") == [(5_001, 1)] * jumps
    assert changes(run, "trusted") == [(22, 1), (5_002, 0)][: 1 + jumps]
    assert run["index"].values.tolist() == [0]


def test_without_a_life_time_is_seated_ahead_but_never_back() -> None:
    bench = Bench()
    bench.trust(5, 1_000)
    bench.update(2_000, 5, 2_990 + 301)  # ahead by 301: 11999 is reached 301 earlier, in 10708
    bench.update(3_000, 9, 0)  # far ahead
    bench.update(4_000, 8, 11_000)  # back
    run = bench.run(16_000)
    assert changes(run, "index") == [(11, 5), (3_001, 9), (15_000, 10)]
    assert changes(run, "trusted") == [(22, 1), (2_002, 0)]
    assert changes(run, "time_jump_count") == [(4_001, 1)]


def test_no_update_is_one_whose_phase_is_in_no_cycle() -> None:
    bench = Bench()
    bench.update(10, 3, 12_000)
    assert changes(bench.run(13_000), "index") == [(12_000, 1)]


def test_time_is_not_trusted_after_a_holdover() -> None:
    bench = Bench(replace(SMALL, holdover_cycles=2))
    bench.trust(0, 1_000)  # cycles end in the ticks 11009, 23009
    assert changes(bench.run(END), "trusted") == [(22, 1), (23_011, 0)]
    bench.update(23_009, 1, 11_999)  # wins against the end of that cycle
    assert changes(bench.run(50_000), "trusted") == [(22, 1), (47_011, 0)]


def test_a_reset_starts_anew() -> None:
    bench = Bench()
    bench.trust(5, 1_000)
    bench.set("rst", 5_000, 1)
    bench.set("rst", 5_003, 0)  # 5003 is the new tick 0
    run = bench.run(20_000)
    assert changes(run, "index") == [(11, 5), (5_001, 0), (17_003, 1)]
    assert changes(run, "trusted") == [(22, 1), (5_001, 0)]
    assert run.period == Fraction(1, SMALL.clock_hz)
