"""Amaranth's simulator as an engine: time, pieces, pokes, checkpoints, several clocks."""

from fractions import Fraction

import pytest
from amaranth.hdl import ClockDomain, ClockSignal, Module, Signal, signed
from amaranth.lib import wiring
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In, Out
from hypothesis import given, settings
from hypothesis import strategies as st

from railgate.engines import Clock, Design
from railgate.engines.pysim import PySim
from railgate.waves import Trace, Waveform

HZ = Fraction(1_000_000)


class Accumulator(wiring.Component):
    """Adds `step` each tick; `twice` follows combinationally, `echo` is the step 3 ticks ago."""

    def __init__(self):
        super().__init__(
            {
                "step": In(signed(4)),
                "total": Out(signed(8)),
                "twice": Out(signed(9)),
                "echo": Out(signed(4)),
            }
        )

    def elaborate(self, _platform):
        m = Module()
        m.submodules.history = history = Memory(shape=signed(4), depth=4, init=[])
        at = Signal(2)
        write, read = history.write_port(), history.read_port(domain="comb")
        m.d.comb += [
            write.addr.eq(at),
            write.data.eq(self.step),
            write.en.eq(1),
            read.addr.eq(at + 1),
            self.echo.eq(read.data),
            self.twice.eq(self.total << 1),
        ]
        m.d.sync += [at.eq(at + 1), self.total.eq(self.total + self.step)]
        return m


class Exchange(wiring.Component):
    """Two domains that count, each sampling the other's count."""

    def __init__(self):
        super().__init__(
            {name: Out(16) for name in ("left", "right", "left_saw", "right_saw")}
            | {"x": In(8), "left_x": Out(8)}
        )

    def elaborate(self, _platform):
        m = Module()
        m.d.sync += [
            self.left.eq(self.left + 1),
            self.left_saw.eq(self.right),
            self.left_x.eq(self.x),
        ]
        m.d.other += [self.right.eq(self.right + 1), self.right_saw.eq(self.left)]
        return m


accumulator = Design(name="accumulator", component=Accumulator, clocks=(Clock(frequency_hz=HZ),))


def exchange(**other):
    clocks = (Clock(frequency_hz=HZ), Clock(domain="other", **other))
    return Design(name="exchange", component=Exchange, clocks=clocks)


def steps(ticks, values, end, **more):
    wave = Waveform.of(ticks, values, 4, True)
    return Trace({"step": wave, **more}, 1 / HZ, 0, end)


def nothing(design, end):
    return Trace({}, design.period, 0, end)


def test_a_register_changes_in_the_tick_after_the_one_that_it_samples():
    result = PySim(accumulator).advance(12, steps([0, 5, 6], [0, 3, -2], 12))
    totals = [0, 3, 1, -1, -3, -5, -7]
    assert result["total"] == Waveform.of([0, *range(6, 12)], totals, 8, True)
    assert result["twice"].values.tolist() == [2 * total for total in totals]
    assert result["echo"] == Waveform.of([0, 8, 9], [0, 3, -2], 4, True)
    assert (result.start, result.end, result.period) == (0, 12, 1 / HZ)


@settings(max_examples=20, deadline=None)
@given(
    st.lists(st.integers(-8, 7), min_size=60, max_size=60),
    st.lists(st.integers(0, 60), max_size=6),
)
def test_in_pieces_it_does_the_same_as_in_one(values, cuts):
    stimulus = steps(range(60), values, 60)
    whole = PySim(accumulator).advance(60, stimulus)
    engine = PySim(accumulator)
    pieces = []
    for cut in sorted({*cuts, 60} - {0}):
        pieces.append(engine.advance(cut, stimulus.slice(engine.now, cut)))
        assert engine.now == cut
    joined = pieces[0]
    for piece in pieces[1:]:
        joined = joined.concatenate(piece)
    assert joined.first_difference(whole) is None


def test_an_input_left_out_keeps_what_it_last_held():
    engine = PySim(accumulator)
    engine.advance(5, steps([0], [2], 5))
    result = engine.advance(8, nothing(accumulator, 8))
    assert result["total"].values.tolist() == [10, 12, 14]


def test_reset_is_an_input():
    rst = Waveform.of([0, 4, 6], [0, 1, 0])
    result = PySim(accumulator).advance(9, steps([0], [1], 9, rst=rst))
    assert result["total"] == Waveform.of(range(9), [0, 1, 2, 3, 4, 0, 0, 1, 2], 8, True)


def test_a_poked_register_holds_in_the_tick_now_and_goes_on_from_there():
    engine = PySim(accumulator)
    engine.advance(5, steps([0], [1], 5))
    engine.poke("total", -100)
    result = engine.advance(8, steps([0], [1], 8))
    assert result["total"].values.tolist() == [-100, -99, -98]
    assert result["twice"].values.tolist() == [-200, -198, -196]


def test_a_poke_names_the_registers_there_are():
    engine = PySim(accumulator)
    with pytest.raises(ValueError, match=r'no register "nil" in accumulator; there are: .*total'):
        engine.poke("nil", 1)
    with pytest.raises(ValueError, match='no register "twice"'):
        engine.poke("twice", 1)
    with pytest.raises(ValueError, match='"total" must be between -128 and 127, not 128'):
        engine.poke("total", 128)


def test_from_a_checkpoint_all_goes_on_as_it_did():
    stimulus = steps(range(40), [(7 * i) % 15 - 7 for i in range(40)], 40)
    engine, other = PySim(accumulator), PySim(accumulator)
    engine.advance(17, stimulus)
    saved = engine.checkpoint()
    first = engine.advance(40, stimulus)
    engine.restore(saved)
    engine.advance(18, stimulus)
    engine.restore(saved)  # the next tick takes the very value that was just undone
    assert engine.now == 17
    assert engine.advance(40, stimulus) == first
    other.restore(saved)
    assert other.advance(40, stimulus) == first


def test_a_checkpoint_of_another_design_is_refused():
    other = PySim(exchange(frequency_hz=HZ))
    with pytest.raises(ValueError, match="a checkpoint must be of accumulator"):
        PySim(accumulator).restore(other.checkpoint())


def test_unrelated_clocks_have_their_edges_at_the_times_of_their_frequency_and_phase():
    # other: 3 MHz + 50 ppm, a quarter period late; by hand, in fs, rounded up.
    design = exchange(frequency_hz=3 * HZ, ppm=Fraction(50), phase=Fraction(1, 4))
    end = 10**10
    result = PySim(design).advance(end, nothing(design, end))
    assert result["left"].ticks.tolist() == [0, *range(10**9, end, 10**9)]
    period = Fraction(10**15) / (3_000_150)
    ticks = [
        -(-(period * (n + Fraction(5, 4))).numerator // (period * (n + Fraction(5, 4))).denominator)
        for n in range(30)
    ]
    assert ticks[0] == 416_645_835  # 1.25 / 3.00015 MHz = 416 645 834.375 fs
    assert result["right"].ticks.tolist() == [0, *(tick for tick in ticks if tick < end)]
    # What one domain sampled of the other is what that held just before the edge.
    for n, tick in enumerate(range(10**9, end, 10**9)):
        assert result["left_saw"].at(tick) == result["right"].at(tick - 1)
        assert result["left"].at(tick) == n + 1


def test_coincident_edges_sample_what_was_before_them():
    design = exchange(frequency_hz=HZ)
    end = 5 * 10**9 + 1
    result = PySim(design).advance(end, nothing(design, end))
    assert result["left"].values.tolist() == result["right"].values.tolist() == [0, 1, 2, 3, 4, 5]
    assert result["left_saw"].values.tolist() == [0, 1, 2, 3, 4]
    assert result["left_saw"] == result["right_saw"]


def test_an_edge_samples_the_input_of_the_tick_before():
    design = exchange(frequency_hz=2 * HZ)
    end = 3 * 10**9
    for change, seen in ((10**9 - 1, 10**9), (10**9, 2 * 10**9)):
        x = Waveform.of([0, change], [0, 7], 8)
        result = PySim(design).advance(end, Trace({"x": x}, design.period, 0, end))
        assert result["left_x"] == Waveform.of([0, seen], [0, 7], 8)


def test_several_clocks_in_pieces_cut_at_and_beside_edges():
    design = exchange(frequency_hz=Fraction(7, 3) * HZ, phase=Fraction(1, 3))
    end = 6 * 10**9
    whole = PySim(design).advance(end, nothing(design, end))
    engine = PySim(design)
    joined = engine.advance(10**9 - 1, nothing(design, end))
    for cut in (10**9, 10**9 + 1, *whole["right"].ticks[5:8].tolist(), end):
        joined = joined.concatenate(engine.advance(cut, nothing(design, end)))
    assert joined.first_difference(whole) is None


def test_the_resets_of_several_domains_are_apart():
    design = exchange(frequency_hz=HZ)
    end = 5 * 10**9 + 1
    rst = Waveform.of([0], [1])
    result = PySim(design).advance(end, Trace({"other_rst": rst}, design.period, 0, end))
    assert (result["left"].values[-1], result["right"].values[-1]) == (5, 0)


def test_a_domain_without_a_clock_is_an_error():
    design = Design(name="exchange", component=Exchange, clocks=(Clock(frequency_hz=HZ),))
    with pytest.raises(ValueError, match="a clock for each domain, not none for other"):
        PySim(design)


class Inner(wiring.Component):
    """A counter in a domain that the component makes itself."""

    def __init__(self, domain):
        super().__init__({"count": Out(4)})
        self._domain = domain

    def elaborate(self, _platform):
        m = Module()
        m.domains += self._domain
        m.d.comb += self._domain.clk.eq(ClockSignal("sync"))
        m.d[self._domain.name] += self.count.eq(self.count + 1)
        m.submodules.inner = Accumulator()
        return m


@pytest.mark.parametrize("more", [{"clk_edge": "neg"}, {"local": True}, {}])
def test_a_domain_of_the_components_own_is_refused(more):
    design = Design(
        name="inner",
        component=lambda: Inner(ClockDomain("own", **more)),
        clocks=(Clock(frequency_hz=HZ), Clock(domain="own", frequency_hz=HZ)),
    )
    with pytest.raises(ValueError, match=r"must have no domains but .* not its own own"):
        PySim(design)


def test_a_run_ends_before_its_ticks_leave_64_bits():
    end = 2**63 - 2**58 + 1
    with pytest.raises(ValueError, match=f"must end at tick {end - 1} at the latest, not {end}"):
        PySim(accumulator).advance(end, nothing(accumulator, end))


@pytest.mark.parametrize(
    ("stimulus", "message"),
    [
        (Trace({}, Fraction(1, 10**15), 0, 9), "a tick .* must last 1/1000000 s, not 1/10+ s"),
        (Trace({}, 1 / HZ, 0, 8), r"must cover ticks 0\.\.9, not 0\.\.8"),
        (Trace({}, 1 / HZ, 1, 9), r"must cover ticks 0\.\.9, not 1\.\.9"),
        (steps([0], [0], 9, y=Waveform.of([0], [0])), 'no input "y" .*; there are: step, rst'),
        (steps([0], [0], 9, total=Waveform.of([0], [0])), 'no input "total"'),
        (
            Trace({"step": Waveform.of([0], [0], 4)}, 1 / HZ, 0, 9),
            '"step" must be 4 bits signed, not 4 bits',
        ),
        (
            steps([0], [0], 9, rst=Waveform.of([0], [0], 2)),
            '"rst" must be 1 bit, not 2 bits',
        ),
    ],
)
def test_a_stimulus_that_does_not_fit_is_refused_in_one_line(stimulus, message):
    with pytest.raises(ValueError, match=message) as error:
        PySim(accumulator).advance(9, stimulus)
    assert "\n" not in str(error.value)


def test_it_does_not_run_backwards():
    engine = PySim(accumulator)
    engine.advance(5, nothing(accumulator, 5))
    with pytest.raises(ValueError, match="is at tick 5 already, it cannot run to tick 4"):
        engine.advance(4, nothing(accumulator, 5))
