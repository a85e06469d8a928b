"""The gateware's bit clock, request, phase of the delivery and radio line, against the contract."""

from fractions import Fraction

import pytest
from amaranth.hdl import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import Out

from position_link.line import answer, begin, deliveries, frames, run, small
from railgate.engines import Clock, Design, open_engine
from railgate.position_link.gateware.timing import Timing
from railgate.position_link.spec import Cause, Check, Config, Status
from railgate.waves import Trace, Waveform

RATES = {
    "10 ticks a bit": {},
    "125/12 ticks a bit": {"bit_rate_hz": Fraction(96_000), "cycle_s": Fraction(1, 1000)},
    "16 ticks a bit": {"bit_rate_hz": Fraction(62_500), "cycle_s": Fraction(1, 500)},
    "800/81 ticks a bit": {"bit_rate_hz": Fraction(101_250)},
    "8 ticks a bit": {"bit_rate_hz": Fraction(125_000), "cycle_s": Fraction(1, 1000)},
}
every_rate = pytest.mark.parametrize("changes", RATES.values(), ids=RATES)
CLOCKS_HZ = (40_000_000, 48_000_000, 50_000_000, 100_000_000, 125_000_000)


def lines(config, cycles):
    """CLK and ANF as the contract has them."""
    clk, anf = [0], [0]
    for cycle in range(cycles):
        c = begin(config, cycle)
        for n in range(config.cycle_bits):
            clk += [c + config.rise(n), c + config.fall(n)]
        anf += [c, c + config.rise(config.request_bits)]
    return tuple(Waveform.of(ticks, [i % 2 for i in range(len(ticks))]) for ticks in (clk, anf))


@pytest.mark.shows("LNK-1", "LNK-2")
@every_rate
def test_clk_and_anf_are_the_contracts_in_every_tick(changes):
    config = small(**changes)
    result = run(config, 3)
    assert (result["clk"], result["anf"]) == lines(config, 3)


class Clocks(wiring.Component):
    """The timing of the default configuration at each of CLOCKS_HZ; a tick is a tick."""

    def __init__(self):
        super().__init__({f"{name}_{hz}": Out(1) for hz in CLOCKS_HZ for name in ("clk", "anf")})

    def elaborate(self, _platform):
        m = Module()
        for hz in CLOCKS_HZ:
            m.submodules[f"timing_{hz}"] = timing = Timing(Config(clock_hz=hz))
            for name in ("clk", "anf"):
                m.d.comb += getattr(self, f"{name}_{hz}").eq(getattr(timing, name))
        return m


@pytest.mark.shows("LNK-1", "LNK-2")
def test_at_every_reference_clock_a_cycle_is_10240_clk_of_512_khz():
    clock = Clock(frequency_hz=Fraction(1))
    engine = open_engine(Design(name="clocks", component=Clocks, clocks=(clock,)), "cxxrtl")
    end = begin(Config(clock_hz=max(CLOCKS_HZ)), 1) + 1
    result = engine.advance(end, Trace({}, Fraction(1), 0, end))
    for hz in CLOCKS_HZ:
        config = Config(clock_hz=hz)
        once = begin(config, 1)
        clk, anf = (result[f"{name}_{hz}"].slice(0, once) for name in ("clk", "anf"))
        assert (clk, anf) == lines(config, 1)
        assert clk.rising().size == 10_240
        assert once in result[f"clk_{hz}"].rising()
        assert once in result[f"anf_{hz}"].rising()


@pytest.mark.shows("LNK-6")
@every_rate
def test_a_delivery_comes_in_every_cycle_at_the_same_phase_and_fields_change_in_no_other_tick(
    changes,
):
    config = small(**changes)
    result = run(config, 4, answer(config, 0, 0x5A, 2), answer(config, 2, 0xA6, 5))
    expected = [begin(config, cycle) + config.delivery_ticks for cycle in range(4)]
    assert result["delivery"].rising().tolist() == expected
    assert result["delivery"].falling().tolist() == [tick + 1 for tick in expected]
    for field in config.fields:
        assert set(result[field.name].ticks[1:].tolist()) <= set(expected)
        assert result[field.name].at(0) == field.start
    assert result["number"].ticks[1:].tolist() == expected
    assert [one["number"] for one in deliveries(config, result)] == [1, 2, 3, 4]


@pytest.mark.shows("LNK-6")
@every_rate
def test_the_frame_carries_word_status_age_number_and_the_check_of_all_bits_before(changes):
    config = small(**changes)
    result = run(config, 4, *(answer(config, cycle, 0x35 + cycle, 3) for cycle in (0, 2)))
    seen = deliveries(config, result)
    assert [one["status"] for one in seen] == [Status.FRESH, Status.HELD, Status.FRESH, Status.HELD]
    count = config.frame_bits - config.radio_check.width
    for one, frame in zip(seen, frames(config, result), strict=True):
        sent = 0
        for name, width in (("word", 8), ("status", 2), ("age", config.age_bits), ("number", 8)):
            sent = sent << width | one[name]
        assert frame == sent << config.radio_check.width | config.radio_check.of(sent, count)


@pytest.mark.shows("LNK-6")
def test_the_check_of_the_radio_line_is_the_crc_of_its_name():
    assert Config.radio_check.of(int.from_bytes(b"123456789"), 72) == 0x29B1


@pytest.mark.shows("LNK-6")
@every_rate
@pytest.mark.parametrize("bare", [False, True])
def test_the_radio_line_is_valid_for_one_frame_a_cycle_from_the_first_clk_after_the_delivery(
    changes, bare
):
    config = small(**changes, bare=bare)
    result = run(config, 2, answer(config, 0, 0xB7, 2))
    first, last = config.radio_first, config.radio_first + config.frame_bits
    ticks = [begin(config, c) + config.rise(n) for c in range(2) for n in (first, last)]
    assert result["radio_valid"] == Waveform.of([0, *ticks], [0, 1, 0, 1, 0])
    assert config.rise(first - 1) <= config.delivery_ticks < config.rise(first)
    launches = {begin(config, c) + config.rise(n) for c in range(2) for n in range(first, last + 1)}
    assert set(result["radio_data"].ticks[1:].tolist()) <= launches


@pytest.mark.shows("LNK-6")
def test_a_bare_radio_line_carries_the_word_while_fresh_and_else_the_fault_word():
    config = small(bare=True, fault_word=0x81)
    result = run(config, 4, *(answer(config, cycle, 0x35 + cycle, 3) for cycle in (1, 3)))
    assert [one["status"] for one in deliveries(config, result)] == [
        Status.FAULT,
        Status.FRESH,
        Status.HELD,
        Status.FRESH,
    ]
    assert frames(config, result) == [0x81, 0x36, 0x81, 0x38]


def test_the_default_configuration_answers_on_its_own_line():
    config = Config()
    words = [0x0123_4567_89AB_CDEF, 0xFEDC_BA98_7654_3210]
    result = run(
        config, 2, *(answer(config, c, word, 29 - c) for c, word in enumerate(words)), kind="cxxrtl"
    )
    seen = deliveries(config, result)
    assert [one["word"] for one in seen] == words
    assert [one["status"] for one in seen] == [Status.FRESH] * 2
    assert [one["age_ticks"] for one in seen] == [
        config.delivery_ticks - config.rise(29),
        config.delivery_ticks - config.rise(28),
    ]
    assert [frame >> config.frame_bits - 64 for frame in frames(config, result)] == words
    assert config.cycle_ticks == 800_000


@pytest.mark.shows("LNK-3")
@pytest.mark.parametrize("word_bits", [64, 512])
def test_words_of_64_and_512_bits_pass_whole(word_bits):
    crc = Check(width=32, polynomial=0x04C11DB7, initial=0xFFFFFFFF, final=5)
    config = small(
        clock_hz=800_000,
        word_bits=word_bits,
        cycle_s=Fraction(2 * word_bits + 56, 100_000),
        check=crc,
        zero_is_fault=True,
    )
    payload = int("9A5C3" * word_bits, 16) % (1 << word_bits - crc.width)
    word = payload << crc.width | crc.of(payload, word_bits - crc.width)
    result = run(config, 2, answer(config, 0, word, 2), answer(config, 1, word ^ 1, 2))
    good, bad = deliveries(config, result)
    assert (good["word"], good["status"], good["causes"]) == (word, Status.FRESH, 0)
    assert (bad["word"], bad["status"], bad["causes"]) == (word, Status.HELD, Cause.CHECK)
    assert [frame >> config.frame_bits - word_bits for frame in frames(config, result)] == [
        word
    ] * 2
