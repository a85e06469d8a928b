"""Chunked counters and sums against whole numbers."""

from fractions import Fraction

from amaranth.hdl import Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out
from hypothesis import given, settings
from hypothesis import strategies as st

from railgate.engines import Clock, Design
from railgate.engines.pysim import PySim
from railgate.primitives.chunked import PACE, accumulate, chunks, count, exceeds, masked, skewed
from railgate.proving import TICK
from railgate.waves import Trace, Waveform

WIDTH = 40
ALL = (1 << WIDTH) - 1
BITS = 8


class Counter(wiring.Component):
    """A counter that starts just below a number, and whether it is above it."""

    def __init__(self, start: int, limit: int, saturates: bool) -> None:
        self._start, self._limit, self._saturates = start, limit, saturates
        super().__init__(
            {"up": In(1), "restart": In(1), "value": Out(WIDTH), "full": Out(1), "over": Out(1)}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        value, free = Signal(WIDTH, init=self._start), Signal(WIDTH, init=1)
        full = count(m, value, self.up, restart=self.restart, saturates=self._saturates)
        first = Signal(init=1)
        m.d.sync += first.eq(0)
        count(m, free, restart=self.restart | first)
        over = exceeds(m, free, self._limit, restart=self.restart | first)
        m.d.comb += [self.value.eq(value), self.full.eq(full), self.over.eq(over)]
        return m


class Total(wiring.Component):
    """A sum of what is added, and a sum of that sum, with what each has told once more in step."""

    def __init__(self) -> None:
        super().__init__(
            {
                "add": In(WIDTH),
                "take": In(1),
                "restart": In(1),
                "sum": Out(WIDTH),
                "sums": Out(WIDTH),
            }
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        total, nested = Signal(WIDTH), Signal(WIDTH)
        accumulate(m, total, skewed(m, self.add, BITS), BITS, restart=self.restart)
        accumulate(m, nested, masked(m, total, self.take, BITS), BITS)
        m.d.comb += [self.sum.eq(total), self.sums.eq(nested)]
        return m


def run(component, ticks, **inputs):
    """The outputs of each tick, by name."""
    clock = Clock(frequency_hz=Fraction(1_000_000))
    design = Design(name="chunked", component=lambda: component, clocks=(clock,))
    waves = {
        name: Waveform.of(range(ticks), list(values), WIDTH if name == "add" else 1)
        for name, values in inputs.items()
    }
    return PySim(design).advance(ticks, Trace(waves, TICK, 0, ticks))


def bits(seed, ticks):
    return [seed >> tick & 1 for tick in range(ticks)]


@settings(max_examples=40, deadline=None)
@given(
    st.sampled_from((0, 7, (1 << 15) - 3, (1 << 27) - 3, (1 << 39) - 2, ALL - 5, ALL)),
    st.integers(0, (1 << 60) - 1) | st.just((1 << 60) - 1),
    st.integers(0, 59),
    st.booleans(),
)
def test_a_counter_is_exact_in_every_tick(start, ups, restart, saturates):
    up, again = bits(ups, 60), [tick == restart for tick in range(60)]
    told = run(Counter(start, 30, saturates), 60, up=up, restart=again)
    value, age = start, 0
    for tick in range(60):
        assert told["value"].at(tick) == value
        assert told["full"].at(tick) == (value == ALL)
        if tick > 1:
            assert told["over"].at(tick) == (age > 30)
        value = start if again[tick] else value + up[tick]
        value = min(value, ALL) if saturates else value & ALL
        age = 1 if again[tick] or not tick else age + 1


@settings(max_examples=40, deadline=None)
@given(
    st.lists(st.integers(0, ALL) | st.just(ALL), min_size=40, max_size=40),
    st.integers(0, (1 << 40) - 1),
    st.integers(0, 39),
)
def test_skewed_chunks_are_those_of_the_whole_sum(added, taken, restart):
    again = [tick == restart for tick in range(40)]
    take = bits(taken, 40)
    told = run(Total(), 40, add=added, take=take, restart=again)
    total, nested, sums, sums_of_sums = 0, 0, [0], [0, 0, 0]
    for tick in range(40):
        total = 0 if again[tick] else (total + added[tick]) & ALL
        sums.append(total)
        nested = (nested + (total if take[tick] else 0)) & ALL
        sums_of_sums.append(nested)
    for late, part in enumerate(chunks(WIDTH, BITS)):
        mask = (1 << part.stop - part.start) - 1
        for name, exact in (("sum", sums), ("sums", sums_of_sums)):
            for tick in range(PACE * late, 40):
                of = int(told[name].at(tick)) >> part.start & mask
                assert of == exact[tick - PACE * late] >> part.start & mask
