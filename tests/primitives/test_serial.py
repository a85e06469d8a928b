"""Serial check and transmitter, bit by bit, against a long division and the bits of a number."""

from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railgate.engines import Clock, Design
from railgate.engines.pysim import PySim
from railgate.primitives import SerialCheck, SerialTransmitter
from railgate.waves import Trace, Waveform

CRC16 = (16, 0x1021, 0xFFFF, 0)


def ran(component, end, **signals):
    """The outputs over `end` ticks; a signal is (width, {tick: value})."""
    waves = {
        name: Waveform.of([0, *sorted(at)], [0, *(at[tick] for tick in sorted(at))], width)
        for name, (width, at) in signals.items()
    }
    clock = Clock(frequency_hz=Fraction(1))
    design = Design(name="serial", component=lambda: component, clocks=(clock,))
    return PySim(design).advance(end, Trace(waves, Fraction(1), 0, end))


def pulses(ticks):
    ticks = set(ticks)
    return 1, {at: int(at in ticks) for tick in ticks for at in (tick, tick + 1)}


def field(arguments, bits, first=2, restart=None):
    """The field after these bits, one every second tick; with `restart`, anew with that bit."""
    end = first + 2 * len(bits)
    inputs = {
        "enable": pulses(range(first, end, 2)),
        "bit": (1, dict(zip(range(first, end, 2), bits, strict=True))),
    }
    if restart is not None:
        inputs["restart"] = pulses([first + 2 * restart])
    return int(ran(SerialCheck(*arguments), end + 1, **inputs)["field"].at(end))


def divided(width, polynomial, initial, final, bits):
    """The same by long division: bits and as many zeros, `initial` added to the first ones."""
    number = int("".join(map(str, bits)) or "0", 2) << width
    number ^= initial << len(bits)
    for at in reversed(range(len(bits))):
        if number >> at + width & 1:
            number ^= (1 << width | polynomial) << at
    return number ^ final


def bits_of(data):
    return [byte >> at & 1 for byte in data for at in reversed(range(8))]


@pytest.mark.parametrize(
    ("arguments", "check"),
    [
        (CRC16, 0x29B1),
        ((16, 0x1021, 0, 0), 0x31C3),
        ((8, 0x07, 0, 0x55), 0xA1),
        ((32, 0x04C11DB7, 0xFFFFFFFF, 0xFFFFFFFF), 0xFC891918),
        ((5, 0x09, 0x09, 0), 0x00),
    ],
    ids=["IBM-3740", "XMODEM", "I-432-1", "BZIP2", "EPC-C1G2"],
)
def test_catalogued_crcs_give_their_check_of_the_nine_digits(arguments, check):
    assert field(arguments, bits_of(b"123456789")) == check


@settings(max_examples=30, deadline=None)
@given(st.data(), st.integers(1, 20), st.lists(st.integers(0, 1), max_size=40))
def test_the_field_is_the_remainder_of_a_long_division(data, width, bits):
    numbers = st.integers(0, (1 << width) - 1)
    arguments = (width, data.draw(numbers), data.draw(numbers), data.draw(numbers))
    assert field(arguments, bits) == divided(*arguments, bits)


def test_it_starts_anew_before_the_bit_of_the_restarts_tick():
    bits = bits_of(b"00123456789")
    assert field(CRC16, bits, restart=16) == 0x29B1
    alone = {"restart": pulses([6]), "enable": pulses([3]), "bit": (1, {3: 0})}
    result = ran(SerialCheck(*CRC16), 9, **alone)
    assert [result["field"].at(tick) for tick in (3, 6, 7)] == [0xFFFF, 0xEFDF ^ 0x0, 0xFFFF]


@pytest.mark.parametrize(("width", "tail_width"), [(8, 0), (8, 3), (3, 8), (1, 0), (1, 1)])
def test_frame_and_tail_are_sent_most_significant_bit_first_one_bit_a_strobe(width, tail_width):
    strobes = list(range(3, 100, 5))
    frame, tail = 0b10110011 >> 8 - width, 0b11010010 >> 8 - tail_width if tail_width else 0
    signals = {
        "strobe": pulses(strobes),
        "start": pulses([strobes[2]]),
        "frame": (width, {strobes[2]: frame, strobes[2] + 1: 0}),
    }
    if tail_width:
        at = strobes[2 + width]
        signals["tail"] = (tail_width, {at: tail, at + 1: 0})
    result = ran(SerialTransmitter(width, tail_width), 101, **signals)
    sent = f"{frame:0{width}b}" + (f"{tail:0{tail_width}b}" if tail_width else "")
    first, last = strobes[2] + 1, strobes[2 + len(sent)] + 1
    assert result["valid"] == Waveform.of([0, first, last], [0, 1, 0])
    seen = "".join(str(result["data"].at(at + 4)) for at in strobes[2:][: len(sent)])
    assert seen == sent
    assert {int(tick) - 1 for tick in result["data"].ticks[1:]} <= set(strobes)
    assert "".join(str(result["bit"].at(at)) for at in strobes[2:][: len(sent)]) == sent


def test_a_transmitter_that_was_not_started_is_silent():
    result = ran(SerialTransmitter(4, 4), 60, strobe=pulses(range(0, 60, 3)), frame=(4, {1: 15}))
    assert len(result["valid"]) == len(result["data"]) == 1
