"""The check of a frame, against the specification's CRC, for each error of EN 50159."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from random import Random

import pytest

from railgate.vital_output.gateware.check import FrameCheck
from railgate.vital_output.spec import Cause, Config
from vital_output.gateware.bench import Bench, high, pulses
from vital_output.small import SMALL

LATE = SMALL.margin_ticks + SMALL.latency_ticks
EARLY = SMALL.cycle_ticks - SMALL.margin_ticks
MIDDLE = SMALL.cycle_ticks // 2
TOP = (1 << 32) - 1
START = 3
FRAME = {"sequence": 0x1234_5678, "image": 0b10, "acknowledge": 0b01}


@cache
def bench(config=SMALL, board=0, late=LATE):
    return Bench(FrameCheck(config, board, late))


def sent(index, board=0, config=SMALL, **frame):
    """A frame as the CPU of this board sends it in this cycle."""
    frame = {**FRAME, **frame}
    return {**frame, "crc": config.layout.crc(config.boards[board], index, frame)}


def inputs(frame, index, phase=MIDDLE, trusted=1, malformed=0, start=START):
    told = {f"frame.{name}": value for name, value in frame.items()}
    told |= {"frame.malformed": malformed, "index": index, "phase": phase, "trusted": trusted}
    return {name: pulses({start: value}) for name, value in (told | {"start": 1}).items()}


def verdict(engine, config, given):
    """Cause and index of the one verdict; all inputs are 0 but in the tick of the start."""
    done = START + config.check_ticks
    result = engine.run(done + config.check_ticks + 5, given)
    assert (high(result, "due"), high(result, "done")) == ([done - 1], [done])
    cause = Cause(int(result["cause"].at(done)))
    assert result["good"].at(done) == (cause is Cause.NONE)
    return cause, int(result["good_index"].at(done))


def checked(frame, index, **more):
    return verdict(bench(), SMALL, inputs(frame, index, **more))


BIG = Config(outputs=9, delay_cycles=5, life_cycles=4)
LEAST = replace(SMALL, outputs=1, delay_cycles=1)


@pytest.mark.shows("DRV-2")
@pytest.mark.parametrize(("config", "board"), [(SMALL, 0), (BIG, 1), (LEAST, 1)])
def test_the_verdict_comes_in_its_tick_and_names_the_frames_cycle(config, board):
    engine = bench(config, board, config.margin_ticks)
    last = config.cycle_ticks - 1
    frame = {"sequence": 0x9234_5678, "image": 1, "acknowledge": (1 << config.outputs) - 1}
    for index, offset, phase in [(500, 0, last), (501, 0, 0), (8, 1, last), (9, -1, 0)]:
        given = inputs(sent(index + offset, board, config, **frame), index, phase)
        assert verdict(engine, config, given) == (Cause.NONE, index + offset)


@pytest.mark.shows("DRV-3")
@pytest.mark.parametrize(
    ("offset", "phases"),
    [
        (1, range(EARLY, SMALL.cycle_ticks + SMALL.slew_ticks)),
        (0, range(SMALL.cycle_ticks + SMALL.slew_ticks)),
        (-1, range(LATE)),
        (-2, range(0)),
    ],
)
def test_a_neighbouring_cycle_is_acceptable_only_within_its_margin(offset, phases):
    longest = SMALL.cycle_ticks + SMALL.slew_ticks - 1
    for phase in (0, LATE - 1, LATE, MIDDLE, EARLY - 1, EARLY, longest):
        cause, index = checked(sent(70 + offset), 70, phase=phase)
        assert cause is (Cause.NONE if phase in phases else Cause.DELAY)
        if phase in phases:
            assert index == 70 + offset


@pytest.mark.shows("DRV-3")
@pytest.mark.parametrize(("index", "sent_in", "phase"), [(0, TOP, 0), (TOP, 0, EARLY), (0, 0, 9)])
def test_cycles_wrap(index, sent_in, phase):
    assert checked(sent(sent_in), index, phase=phase) == (Cause.NONE, sent_in)


@pytest.mark.shows("DRV-2", "DRV-5")
@pytest.mark.parametrize("field", ["sequence", "image", "acknowledge", "crc"])
def test_corruption_a_single_wrong_bit(field):
    widths = {"sequence": 32, "image": 2, "acknowledge": 2, "crc": 32}
    for bit in range(widths[field]):
        frame = sent(9)
        frame[field] ^= 1 << bit
        assert checked(frame, 9)[0] is Cause.CORRUPTION


@pytest.mark.shows("DRV-3", "DRV-5")
@pytest.mark.parametrize("offset", [-2, -1, 1])
def test_delay_a_frame_of_another_cycle_that_is_tried(offset):
    assert checked(sent(40 + offset), 40)[0] is Cause.DELAY


@pytest.mark.shows("DRV-5")
@pytest.mark.parametrize("offset", [-3, 2, 1 << 31])
def test_a_frame_of_a_cycle_that_is_not_tried_counts_as_corrupted(offset):
    assert checked(sent(40 + offset), 40)[0] is Cause.CORRUPTION


@pytest.mark.shows("DRV-2", "DRV-5")
@pytest.mark.parametrize("offset", [-2, -1, 0, 1])
def test_masquerade_a_frame_for_the_other_board(offset):
    assert checked(sent(40 + offset, board=1), 40)[0] is Cause.MASQUERADE
    other = bench(board=1)
    assert verdict(other, SMALL, inputs(sent(40 + offset), 40))[0] is Cause.MASQUERADE


@pytest.mark.shows("DRV-3")
@pytest.mark.parametrize("frame", [sent(40), sent(39), sent(40, board=1), sent(9)])
def test_a_wrong_form_comes_first_and_then_time_that_is_not_trusted(frame):
    assert checked(frame, 40, trusted=0, malformed=1)[0] is Cause.FORMAT
    assert checked(frame, 40, trusted=1, malformed=1)[0] is Cause.FORMAT
    assert checked(frame, 40, trusted=0)[0] is Cause.TIME


def masked(index, flipped):
    """The cause where, for the run with the mask, the comparator's wanted bits are flipped."""
    frame = sent(index)
    given = inputs(frame, index)
    engine = bench()
    end = START + SMALL.check_ticks + 1
    compares = end - 1 - SMALL.check_overhead_ticks + 2
    engine.run(compares, given)
    engine.engine.poke("wanted", frame["crc"] ^ flipped)
    return int(engine.go_on(end, given)["cause"].at(end - 1))


@pytest.mark.shows("DRV-2")
def test_over_32_cycles_each_bit_of_the_comparator_is_seen_to_reject():
    for index in range(1000, 1032):
        assert masked(index, 1 << index % 32) == Cause.COMPARATOR
        assert masked(index, 0) == masked(index, 1 << (index + 1) % 32) == Cause.NONE


@pytest.mark.shows("DRV-2")
def test_a_comparator_that_only_says_yes_accepts_nothing():
    """Which board and which cycle match does not matter: none differs."""
    engine, end = bench(), START + SMALL.check_ticks + 1
    for frame in (sent(40), sent(39), sent(40, board=1), sent(9)):
        given = inputs(frame, 40)
        engine.run(START + 1, given)
        while engine.engine.now < end:
            engine.engine.poke("match", 1)
            result = engine.go_on(engine.engine.now + 1, given)
        assert result["cause"].at(end - 1) == Cause.COMPARATOR


@pytest.mark.shows("DRV-16")
def test_a_check_that_an_upset_ends_early_accepts_nothing():
    engine, again = bench(), START + SMALL.check_ticks + 10
    first, second = inputs(sent(40), 40), inputs(sent(40), 40, start=again)
    given = {name: first[name] | second[name] for name in first}
    result = engine.run(again + 2, given)
    assert result["good"].at(START + SMALL.check_ticks)
    engine.engine.poke("run", 2 * (SMALL.delay_cycles + 2) + 1)
    end = again + SMALL.check_ticks
    assert engine.go_on(end + 1, given)["cause"].at(end) == Cause.CORRUPTION


def expected(frame, index, phase, trusted, malformed):
    """The contract's verdict, by the CRCs that the specification computes."""

    def fits(board, offset):
        return SMALL.layout.crc(SMALL.boards[board], index + offset, frame) == frame["crc"]

    acceptable = [0] + [-1] * (phase < LATE) + [1] * (phase >= EARLY)
    tried = range(-SMALL.delay_cycles, 2)
    if malformed or not trusted:
        return Cause.FORMAT if malformed else Cause.TIME
    if any(fits(0, offset) for offset in acceptable):
        return Cause.NONE
    if any(fits(0, offset) for offset in tried):
        return Cause.DELAY
    return Cause.MASQUERADE if any(fits(1, offset) for offset in tried) else Cause.CORRUPTION


@pytest.mark.shows("DRV-2", "DRV-3")
def test_random_frames_get_the_verdict_of_the_contract():
    random = Random(4)
    found = set()
    for _ in range(400):
        index = random.choice([random.getrandbits(32), 0, 1, TOP])
        widths = {"sequence": 32, "image": 2, "acknowledge": 2}
        told = {name: random.getrandbits(width) for name, width in widths.items()}
        frame = sent(index + random.randrange(-3, 3), random.choice([0, 0, 0, 1]), **told)
        if random.random() < 0.1:
            frame["crc"] ^= 1 << random.randrange(32)
        more = {
            "phase": random.choice([0, LATE - 1, LATE, MIDDLE, EARLY - 1, EARLY]),
            "trusted": int(random.random() < 0.9),
            "malformed": int(random.random() < 0.05),
        }
        cause = checked(frame, index, **more)[0]
        assert cause is expected(frame, index, **more)
        found.add(cause)
    assert len(found) == 6
