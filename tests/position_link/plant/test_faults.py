"""Each kind of fault does to the pins what FAULTS says of it; faults are read from text."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from position_link.plant.stimuli import CONFIGS, SMALL
from railgate.position_link.plant import FAULTS, Fault, Scenario, drive, fault
from railgate.position_link.spec import Config
from railgate.waves import Trace

CONFIG = CONFIGS[0]
CYCLE, CLK, CYCLES = 800, 10, 6
WORDS = np.array([0xA5, 0x3C, 0x0F, 0xC3, 0x81, 0x7E], np.uint64)
LATENCY = 4
"""By default, between the earliest CLK 2 and the last 6."""

Pulse = tuple[int, int, int]


def pins(*texts: str, config: Config = CONFIG, seed: int = 0) -> Trace:
    faults = tuple(fault(text) for text in texts)
    return drive(Scenario(words=WORDS, faults=faults, seed=seed), config, CYCLES)


CLEAN = pins()


def pulses(found: Trace, delay: int = 2) -> list[Pulse]:
    """Of each pulse of UEF its cycle, the CLK that it begins with and the CLK that it lasts."""
    uef = found["uef"]
    edges = np.stack([uef.rising(), uef.falling()], axis=1) - 2 - delay
    assert (edges % CLK == 0).all()
    return [(a // CYCLE, a % CYCLE // CLK + 1, (b - a) // CLK) for a, b in edges.tolist()]


def word(found: Trace, cycle: int, first_clk: int = LATENCY, bits: int = 8) -> int:
    """What is read with falling CLK from that CLK on."""
    at = [1 + cycle * CYCLE + CONFIG.fall(first_clk - 1 + i) for i in range(bits)]
    return int("".join(str(level) for level in found["data"].at(at)), 2)


def differing(pin: str, found: Trace) -> list[int]:
    """The ticks in which a pin is not as it is without faults."""
    every = np.arange(CLEAN.end)
    return np.flatnonzero(found[pin].at(every) != CLEAN[pin].at(every)).tolist()


USUAL = [(cycle, LATENCY, 8) for cycle in range(CYCLES)]


def but(cycle: int, *instead: Pulse) -> list[Pulse]:
    return sorted([pulse for pulse in USUAL if pulse[0] != cycle] + list(instead))


def test_without_faults_each_cycle_has_its_word() -> None:
    assert pulses(CLEAN) == USUAL
    assert [word(CLEAN, cycle) for cycle in range(CYCLES)] == WORDS.tolist()
    assert word(CLEAN, 0, LATENCY + 8) == 0


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("missing@1.7ms", but(2)),
        ("short@1.6ms", but(2, (2, LATENCY, 7))),
        ("short:3@1.6ms", but(2, (2, LATENCY, 3))),
        ("long@2.3999ms", but(2, (2, LATENCY, 9))),
        ("long:20@1.6ms", but(2, (2, LATENCY, 20))),
        ("early@1.6ms", but(2, (2, 1, 8))),
        ("early:3@1.6ms", but(2, (2, 3, 8))),
        ("late@1.6ms", but(2, (2, 7, 8))),
        ("late:72@1.6ms", but(2, (2, 72, 8))),
        ("late:78@1.6ms", but(2, (2, 78, 3))),
        ("unrequested@1.6ms", but(2, (2, LATENCY, 8), (2, 60, 2))),
        ("unrequested:70@0s", but(0, (0, LATENCY, 8), (0, 70, 2))),
        ("second@1.6ms", but(2, (2, LATENCY, 8), (2, 13, 8))),
        ("second:30@1.6ms", but(2, (2, LATENCY, 8), (2, 30, 8))),
        ("missing@0s..2.4ms", USUAL[3:]),
        ("missing@0.8ms..0.8001ms", but(1)),
        ("missing@4ms..1s", USUAL[:5]),
        ("fault-word@1.6ms", USUAL),
        ("zero-word@1.6ms", USUAL),
        ("bit-error@1.6ms", USUAL),
    ],
)
def test_uef_has_the_pulses_that_the_fault_tells(text: str, expected: list[Pulse]) -> None:
    assert pulses(pins(text)) == expected


def test_uef_that_is_short_takes_data_with_it_and_long_leaves_it_low() -> None:
    assert word(pins("short:3@0s"), 0) == 0xA0
    assert word(pins("long:20@0s"), 0, LATENCY, 20) == 0xA5 << 12


def test_a_second_answer_has_the_word_again_and_an_unrequested_pulse_its_first_bits() -> None:
    assert word(pins("second@0s"), 0, LATENCY, 17) == 0xA5 << 9 | 0xA5
    assert word(pins("unrequested:20@0s"), 0, 20) == 0x80


def test_a_second_answer_after_a_late_and_short_one_follows_that() -> None:
    assert pulses(pins("late:10@0s", "short:2@0s", "second@0s"))[:2] == [(0, 10, 2), (0, 13, 8)]


def test_fault_word_and_zero_word_are_sent_in_their_cycle_only() -> None:
    for text, sent in (("fault-word@1.6ms", 0xFF), ("zero-word@1.6ms", 0)):
        found = [word(pins(text), cycle) for cycle in range(CYCLES)]
        assert found == [*WORDS[:2].tolist(), sent, *WORDS[3:].tolist()]
    config = Config(**SMALL, fault_word=0x5A)
    assert word(pins("fault-word@0s", config=config), 0) == 0x5A


@pytest.mark.parametrize(("text", "bit"), [("bit-error@1.6ms", 1), ("bit-error:8@1.6ms", 8)])
def test_a_bit_error_inverts_just_that_bit(text: str, bit: int) -> None:
    found = pins(text)
    first = 1 + 2 * CYCLE + (LATENCY - 1 + bit - 1) * CLK + 1 + 2
    assert differing("data", found) == list(range(first, first + CLK))
    assert differing("uef", found) == []
    assert word(found, 2) == 0x0F ^ 1 << 8 - bit


def test_a_bit_error_is_where_the_bit_is_and_nowhere_without_one() -> None:
    moved = pins("bit-error:2@0s", "late:9@0s", "drift:5@0s")
    assert differing_from(pins("late:9@0s", "drift:5@0s"), moved, "data") == list(range(99, 109))
    for other in ("missing@0s", "short:1@0s"):
        assert pins("bit-error:2@0s", other) == pins(other)


def differing_from(one: Trace, other: Trace, pin: str) -> list[int]:
    every = np.arange(one.end)
    return np.flatnonzero(one[pin].at(every) != other[pin].at(every)).tolist()


def test_stuck_holds_uef_alone_in_just_the_ticks_of_the_span() -> None:
    for text, level in (("stuck@1ms..2ms", 1), ("stuck:0@1ms..2ms", 0)):
        found = pins(text)
        assert set(found["uef"].at(np.arange(1001, 2001)).tolist()) == {level}
        assert all(1001 <= tick < 2001 for tick in differing("uef", found))
        assert differing("uef", found)
        assert differing("data", found) == []


def test_a_fault_of_the_line_at_a_time_holds_for_the_cycle_that_it_falls_in() -> None:
    uef = pins("stuck@1.7ms")["uef"]
    assert (uef.rising()[2], uef.falling()[2]) == (1 + 2 * CYCLE, 1 + 3 * CYCLE)


@pytest.mark.parametrize(("text", "level"), [("unplugged-low", 0), ("unplugged-high", 1)])
def test_an_unplugged_line_holds_both_pins(text: str, level: int) -> None:
    found = pins(f"{text}@1ms..2ms")
    for pin in ("uef", "data"):
        assert set(found[pin].at(np.arange(1001, 2001)).tolist()) == {level}
        assert all(1001 <= tick < 2001 for tick in differing(pin, found))


def test_noise_inverts_both_pins_at_random_inside_its_span() -> None:
    found = pins("noise:7@1ms..3ms")
    ticks = {pin: differing(pin, found) for pin in ("uef", "data")}
    for pin in ("uef", "data"):
        assert all(1001 <= tick < 3001 for tick in ticks[pin])
        assert 700 < len(ticks[pin]) < 1300
        changes = np.count_nonzero(np.diff(ticks[pin]) > 1)
        assert 0.6 < changes / (2000 / 7 / 2) < 1.4
    assert ticks["uef"] != ticks["data"]


def test_noise_is_that_of_the_seed_and_of_its_place_among_the_faults() -> None:
    assert pins("noise@1ms..3ms") == pins("noise@1ms..3ms")
    assert pins("noise@1ms..3ms") != pins("noise@1ms..3ms", seed=1)
    twice = pins("noise@1ms..3ms", "noise@1ms..3ms")
    assert differing("uef", twice)


@pytest.mark.parametrize(
    ("text", "delays"),
    [
        ("drift:4@1.6ms..3.2ms", [2, 2, 4, 6, 6, 6]),
        ("drift:30@1.6ms", [2, 2, 32, 32, 32, 32]),
        ("drift:-2@0.8ms..4ms", [2, 1, 1, 0, 0, 0]),
        ("drift@1.6ms", [2, 2, 7, 7, 7, 7]),
    ],
)
def test_drift_makes_the_delay_grow_evenly_and_stay(text: str, delays: list[int]) -> None:
    found = pins(text)
    rises = found["uef"].rising() - np.arange(CYCLES) * CYCLE - (LATENCY - 1) * CLK - 2
    assert rises.tolist() == delays


def test_a_glitch_inverts_uef_from_its_tick_on_and_in_a_span_once_a_cycle() -> None:
    assert differing("uef", pins("glitch:3@1.7ms")) == [1701, 1702, 1703]
    assert differing("uef", pins("glitch@1.634ms")) == [1635]
    many = pins("glitch:2@1ms..3ms")
    assert differing("uef", many) == [1001, 1002, 1801, 1802, 2601, 2602]
    assert differing("data", many) == []
    assert differing("uef", pins("glitch:3@4.799ms")) == [4800]


def test_two_glitches_at_once_cancel_out() -> None:
    assert pins("glitch:3@1.7ms", "glitch:3@1.7ms") == CLEAN


def test_all_the_kinds_are_told_in_words() -> None:
    assert set(FAULTS) == {
        *("missing", "short", "long", "early", "late", "stuck", "unrequested", "second"),
        *("bit-error", "unplugged-low", "unplugged-high", "noise", "drift", "fault-word"),
        *("zero-word", "glitch"),
    }
    for kind in FAULTS.values():
        assert kind.does
        assert bool(kind.value) == bool(kind.default)


def test_faults_are_read_from_text() -> None:
    assert fault("short@0.1s") == Fault("short", Fraction(1, 10))
    assert fault(" stuck@60ms..140ms") == Fault("stuck", Fraction(3, 50), Fraction(7, 50))
    assert fault("drift:-30@1s..2s") == Fault("drift", Fraction(1), Fraction(2), -30)
    assert fault("late:40@20ms") == Fault("late", Fraction(1, 50), None, 40)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("shirt@1s", r'a fault must be one of missing, short, .*, glitch, not "shirt"'),
        ("short", r"a fault must be KIND@TIME.* KIND of missing, .*, not 'short'"),
        ("", "a fault must be KIND@TIME.*missing, .*, not ''"),
        ("late:4.5@1s", "with a whole number.*missing, .*, not 'late:4.5@1s'"),
        ("late:@1s", "with a whole number.*missing, .*, not 'late:@1s'"),
        ("short@1x", "a number with s, ms, us, .* is needed, not '1x'"),
        ("short@2s..1s", "a span must end after it begins, not '2s..1s'"),
        ("short@-1s", "short must begin at 0 s at the earliest, not -1 s"),
        ("missing:3@1s", "missing takes no value, not 3"),
        ("unplugged-low:0@1s", "unplugged-low takes no value, not 0"),
    ],
)
def test_text_that_is_no_fault_is_refused_in_one_line(text: str, message: str) -> None:
    with pytest.raises(ValueError, match=message) as raised:
        fault(text)
    assert "\n" not in str(raised.value)


@given(
    st.text(alphabet="aelsthorg-:@.0123456789ms \n", max_size=20)
    | st.builds("{}:{}@{}".format, st.sampled_from(list(FAULTS)), st.text(), st.text())
)
def test_any_text_is_a_fault_or_refused_in_one_line(text: str) -> None:
    try:
        told = f"{fault(text)}"
    except ValueError as error:
        told = str(error)
    assert "\n" not in told


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("early:0@0s", "the value of early must be between 1 and 80, not 0"),
        ("long:81@0s", "the value of long must be between 1 and 80, not 81"),
        ("bit-error:9@0s", "the value of bit-error must be between 1 and 8, not 9"),
        ("stuck:2@0s", "the value of stuck must be between 0 and 1, not 2"),
        ("noise:0@0s", "the value of noise must be between 1 and .*, not 0"),
        ("glitch:0@0s", "the value of glitch must be between 1 and 800, not 0"),
        ("drift:254@0s", "delay must be between 0 and 255, not 256"),
        ("drift:-3@0s", "delay must be between 0 and 255, not -1"),
        ("short@4.8ms", "short must begin before the run's end at 0.0048 s, not at 0.0048 s"),
    ],
)
def test_a_fault_that_does_not_fit_the_run_is_refused(text: str, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        pins(text)


def test_noise_without_bound_is_refused() -> None:
    with pytest.raises(ValueError, match="noise must be at most 10000000 changes, not"):
        drive(Scenario(faults=(fault("noise:1@0s..60s"),)), Config(), 3000)


def test_a_fault_is_checked_when_it_is_made() -> None:
    with pytest.raises(ValueError, match=r'a fault must be one of missing, .*, not "x"'):
        Fault("x", Fraction(0))
    with pytest.raises(ValueError, match="short must end after it begins at 1 s, not at 1 s"):
        Fault("short", Fraction(1), Fraction(1))
