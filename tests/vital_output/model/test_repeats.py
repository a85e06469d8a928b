"""Messages that repeat the one before are leapt over; all is as if each had come."""

from fractions import Fraction

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from railgate.engines import Clock
from railgate.vital_output.model import PairModel
from railgate.waves import Trace, Waveform
from vital_output.equality import assert_same
from vital_output.model.random_pair import FS, Times, inputs_of
from vital_output.small import SMALL

random = settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
SEEDS = st.integers(0, 1 << 32)
CYCLES = 24
CYCLE = SMALL.cycle_ticks * 10**9
LIMIT = SMALL.drift_limit_ppm

PPM = st.integers(-100, 100)
FAR = st.integers(LIMIT * 9 // 10, LIMIT * 3 // 2)
APART = st.one_of(PPM, FAR, FAR.map(lambda ppm: -ppm))
"""One clock from the other: by less than is allowed, or by about as much as is found."""

QUIET = SMALL.link_period_ticks - SMALL.message_ticks
DELAYS = st.one_of(st.integers(0, 4), st.integers(QUIET - 24, QUIET + 8), st.integers(0, 5_000))
"""A message comes long before the next is made, about then, or later."""

STOPS = st.lists(
    st.tuples(st.integers(3, 200), st.integers(0, CYCLE // 10), st.integers(1, 40)), max_size=3
)
"""When a clock stops, in tenths of a cycle and a rest, and for how many ticks: its offset jumps."""


def surrounded(clocks: tuple[Clock, ...], seed: int, stops: list[tuple[int, int, int]]) -> Trace:
    """Random surroundings in which FPGA 1 stops at these times too."""
    stimulus = inputs_of(SMALL, clocks, CYCLES, seed)
    tick, held = CYCLE // SMALL.cycle_ticks, {0: 0}
    for tenth, rest, ticks in sorted(stops):
        begin = max(tenth * CYCLE // 10 + rest, max(held) + tick)
        held |= {begin: 1, begin + ticks * tick: 0}
    stopped = Waveform.of(list(held), list(held.values()))
    return Trace({**stimulus.signals, "fpga_1.stopped": stopped}, FS, 0, stimulus.end)


@random
@given(SEEDS, PPM, APART, DELAYS, STOPS)
def test_what_is_leapt_over_is_as_if_it_had_come(
    seed: int, ppm: int, apart: int, delay: int, stops: list[tuple[int, int, int]]
) -> None:
    """Bits of link_tx are of each message: where they are asked for, none is leapt over."""
    rates = {"fpga_1": ppm, "fpga_2": ppm + apart, "relay": 0}
    clocks = tuple(
        Clock(frequency_hz=Fraction(1_000_000), domain=domain, ppm=Fraction(rate))
        for domain, rate in rates.items()
    )
    stimulus = surrounded(clocks, seed, stops)
    each, leapt = (PairModel(SMALL, Times(), clocks, delay) for _ in range(2))
    found = each.advance(stimulus.end, stimulus)
    told = [name for name in found.signals if not name.endswith("link_tx")]
    assert_same(leapt.advance(stimulus.end, stimulus, told), found.select(told), seed)
