"""Command frames byte by byte, against the contract's sentences on form and sequence."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache
from random import Random

import pytest

from railgate.vital_output.gateware.command import Command
from railgate.vital_output.spec import Cause, pack
from vital_output.gateware.bench import Bench, high, pulses, values
from vital_output.small import SMALL

CHECK = SMALL.check_ticks
BYTES = SMALL.layout.frame_bytes
GAP = CHECK + BYTES + 5
INDEX = 500
TOP = (1 << 32) - 1
FIRST, LAST = 1 << 8, 1 << 9
EVENTS = ("accepted", "started", "rejected", "cause")


@cache
def bench(board=0):
    return Bench(Command(SMALL, board))


def encoded(sequence, index=INDEX, board=0, image=0b01, acknowledge=0b10):
    """A frame's bytes as the CPU transfers them."""
    frame = {"sequence": sequence & TOP, "image": image, "acknowledge": acknowledge}
    frame["crc"] = SMALL.layout.crc(SMALL.boards[board], index, frame)
    data = [*pack(SMALL.layout.frame, frame).to_bytes(BYTES, "big")]
    data[0] |= FIRST
    data[-1] |= LAST
    return data


def ending(tick, data):
    """The bytes one after the other, the last one in this tick."""
    return dict(enumerate(data, tick - len(data) + 1))


def run(end, offered, board=0, **more):
    """The bytes offered in these ticks, in the middle of cycle INDEX, in a life, if no more is
    told."""
    steady = {"index": {0: INDEX}, "phase": {0: 6000}, "trusted": {0: 1}, "lifeless": {0: 0}}
    inputs = {"command.payload": pulses(offered), "command.valid": pulses(list(offered))}
    return bench(board).run(end, inputs | steady | more)


def verdicts(result):
    """What is told, by tick: an event's name or a cause's."""
    told = {tick: Cause(int(result["cause"].at(tick))).name for tick in high(result, "cause")}
    told |= {tick: name for name in ("accepted", "started") for tick in high(result, name)}
    rejected = [tick for tick, what in told.items() if what.isupper() and what != "TIME"]
    assert high(result, "rejected") == sorted(rejected)
    return dict(sorted(told.items()))


def sequences(*numbers, **more):
    """What is told of frames with these numbers, one every GAP ticks."""
    offered = {}
    for place, number in enumerate(numbers, 1):
        offered |= ending(place * GAP, encoded(number))
    result = run((len(numbers) + 1) * GAP, offered, **more)
    told = verdicts(result)
    assert list(told) == [place * GAP + CHECK for place in range(1, len(numbers) + 1)]
    return list(told.values()), [int(result["lost"].at(tick)) for tick in told]


@pytest.mark.shows("DRV-1", "DRV-5")
def test_the_second_of_two_consecutive_frames_is_accepted_with_its_fields():
    offered = ending(50, encoded(7)) | ending(
        50 + GAP, encoded(8, INDEX, image=0b11, acknowledge=0b01)
    )
    result = run(3 * GAP, offered, lifeless={0: 1})
    told = 50 + GAP + CHECK
    assert verdicts(result) == {50 + CHECK: "started", told: "accepted"}
    crc = int.from_bytes(bytes(byte & 0xFF for byte in [*offered.values()][-4:]), "big")
    fields = ("sequence", "image", "acknowledge", "crc", "frame_index", "lost")
    assert [result[name].at(told) for name in fields] == [8, 0b11, 0b01, crc, INDEX, 0]


@pytest.mark.shows("DRV-2")
def test_frames_for_the_second_board_are_accepted_there():
    offered = ending(50, encoded(7, board=1)) | ending(50 + GAP, encoded(8, board=1))
    told = {50 + CHECK: "started", 50 + GAP + CHECK: "accepted"}
    assert verdicts(run(3 * GAP, offered, 1, lifeless={0: 1})) == told


def test_nothing_is_ready_while_a_frame_is_checked():
    start = 50
    offered = ending(start, encoded(7)) | ending(start + CHECK + BYTES - 1, encoded(8))
    # The second frame's first byte is offered all the time, and is taken in the verdict's tick.
    offered |= dict.fromkeys(range(start + 1, start + CHECK), encoded(8)[0])
    result = run(3 * GAP, offered, lifeless={0: 1})
    ready = [tick for tick, level in enumerate(values(result, "command.ready")) if not level]
    second = start + CHECK + BYTES - 1
    busy = [range(end + 1, end + CHECK) for end in (start, second)]
    assert ready == [*busy[0], *busy[1]]
    assert verdicts(result) == {start + CHECK: "started", second + CHECK: "accepted"}


def test_bytes_may_come_with_gaps():
    offered = {}
    for place, byte in enumerate(encoded(7)):
        offered[10 + 3 * place] = byte
    assert list(verdicts(run(2 * GAP, offered))) == [10 + 3 * (BYTES - 1) + CHECK]


good = encoded(7)
no_last, no_first = [*good[:-1], good[-1] & 0xFF], [good[0] & 0xFF, *good[1:]]
FORMS = {
    "as it should be": (good, "started"),
    "after bytes of no frame": ([1, 2, 3, *good], "started"),
    "a byte too short": ([good[0], *good[2:]], "FORMAT"),
    "a byte too long": ([*good[:-1], 0, good[-1]], "FORMAT"),
    "much too long": ([good[0], *[0] * 200, good[-1]], "FORMAT"),
    "of one byte": ([FIRST | LAST], "FORMAT"),
    "without its first": (no_first, "FORMAT"),
    "begun anew": ([*good[:4], *good], "FORMAT"),
    "begun anew with all bytes before": ([*no_last, *good], "FORMAT"),
    "bits beyond the image": (encoded(7, image=0b100), "FORMAT"),
    "bits beyond the acknowledge bits": (encoded(7, acknowledge=0x80), "FORMAT"),
    "for the other board": (encoded(7, board=1), "MASQUERADE"),
    "of the cycle before": (encoded(7, INDEX - 1), "DELAY"),
    "corrupted": ([*good[:6], good[6] ^ 1, *good[7:]], "CORRUPTION"),
}


@pytest.mark.shows("DRV-1", "DRV-2")
@pytest.mark.parametrize(("data", "told"), FORMS.values(), ids=FORMS)
def test_a_frame_is_told_by_its_form_and_its_check(data, told):
    assert verdicts(run(600, ending(300, data))) == {300 + CHECK: told}


@pytest.mark.shows("DRV-1")
@pytest.mark.parametrize("name", [name for name, (_, told) in FORMS.items() if told == "FORMAT"])
def test_a_frame_of_wrong_form_does_not_harm_the_next_one(name):
    offered = ending(300, FORMS[name][0]) | ending(300 + GAP, good)
    told = {300 + CHECK: "FORMAT", 300 + GAP + CHECK: "started"}
    assert verdicts(run(1000, offered)) == told


@pytest.mark.shows("DRV-3")
def test_a_frame_while_time_is_not_trusted_is_no_rejection():
    assert list(verdicts(run(600, ending(300, good), trusted={0: 0})).values()) == ["TIME"]


@pytest.mark.shows("DRV-3")
def test_the_own_cpus_frames_are_acceptable_by_the_margin_alone():
    offered = ending(300, encoded(7, INDEX - 1))
    margin = SMALL.margin_ticks
    for phase, told in ((margin - 1, "started"), (margin, "DELAY")):
        result = run(600, offered, phase=pulses({300: phase}))
        assert list(verdicts(result).values()) == [told]


REFERENCED = {"lifeless": {0: 1, 2 * GAP + CHECK + 1: 0}}
"""Life begins with the second frame."""


@pytest.mark.shows("DRV-5")
@pytest.mark.parametrize("start", [7, TOP - 2, (1 << 31) - 2])
@pytest.mark.parametrize(
    ("step", "told", "lost"),
    [
        (1, "accepted", 0),
        (2, "accepted", 1),
        (3, "accepted", 2),
        (4, "INSERTION", None),
        ((1 << 31) - 1, "INSERTION", None),
        (0, "REPETITION", None),
        (-1, "RESEQUENCE", None),
        (-(1 << 31), "RESEQUENCE", None),
    ],
)
def test_in_a_life_so_many_steps_are_accepted_as_it_has_cycles(start, step, told, lost):
    numbers = [start, start + 1, start + 1 + step]
    events, missing = sequences(*numbers, **REFERENCED)
    assert events == ["started", "accepted", told]
    assert lost is None or missing[-1] == lost
    # What is not accepted in a life leaves the reference where it was.
    then = start + 1 + step * (told == "accepted") + 1
    assert sequences(*numbers, then, **REFERENCED)[0][-1] == "accepted"


@pytest.mark.shows("DRV-5")
@pytest.mark.parametrize(
    ("step", "told"), [(1, "accepted"), (2, "INSERTION"), (0, "REPETITION"), (-5, "RESEQUENCE")]
)
def test_without_life_one_step_is_accepted_and_any_good_frame_is_the_new_reference(step, told):
    number = 100 + step
    assert sequences(100, number, number + 1, lifeless={0: 1})[0] == ["started", told, "accepted"]


@pytest.mark.shows("DRV-5")
@pytest.mark.parametrize(
    ("ends", "told"),
    [
        (2 * GAP + CHECK + 1, ["started", "accepted", "started", "accepted"]),
        (3 * GAP + CHECK - 1, ["started", "accepted", "started", "accepted"]),
        # In the tick of a verdict that accepts, this one is the later.
        (3 * GAP + CHECK, ["started", "accepted", "accepted", "accepted"]),
        (3 * GAP + CHECK + 1, ["started", "accepted", "accepted", "started"]),
    ],
)
def test_the_end_of_a_life_ends_the_sequence(ends, told):
    lifeless = {0: 1, 2 * GAP + CHECK + 1: 0, ends + 1: 1}
    assert sequences(1, 2, 3, 4, lifeless=lifeless, life_ends=pulses([ends]))[0] == told


@pytest.mark.shows("DRV-5")
def test_a_verdict_that_does_not_accept_does_not_keep_the_sequence_at_the_end_of_a_life():
    ends = 3 * GAP + CHECK
    lifeless = {0: 1, 2 * GAP + CHECK + 1: 0, ends + 1: 1}
    told = sequences(1, 2, 9, 3, lifeless=lifeless, life_ends=pulses([ends]))[0]
    assert told == ["started", "accepted", "INSERTION", "started"]


@dataclass
class Reading:
    """The contract, one transferred byte and one verdict after the other."""

    referenced: bool = False
    reference: int = 0
    begun: int = 0
    data: list[int] = field(default_factory=list)

    def form(self, byte):
        """Whether the frame that ends with this byte has the right form; None if none ends."""
        if byte & FIRST:
            self.begun += 1
            self.data = []
        self.data.append(byte & 0xFF)
        if not byte & LAST:
            return None
        once, self.begun = self.begun == 1, 0
        return once and len(self.data) == BYTES and max(self.data[4:6]) < 1 << SMALL.outputs

    def judge(self, cause, lifeless, life_ends):
        """What becomes of the frame that `data` still holds."""
        referenced, self.referenced = self.referenced, self.referenced and not life_ends
        if cause:
            return cause.name
        sequence = int.from_bytes(self.data[:4], "big")
        step = (sequence - self.reference + (1 << 31) & TOP) - (1 << 31)
        within = not lifeless and 1 <= step <= SMALL.life_cycles
        accepted = referenced and (step == 1 or within)
        if accepted or lifeless:
            self.reference, self.referenced = sequence, True
        if accepted or not referenced:
            return "accepted" if accepted else "started"
        return "REPETITION" if step == 0 else "RESEQUENCE" if step < 0 else "INSERTION"


def random_frames(random, count):
    """Offered bytes, and the cause that each frame's check must find; by the tick of its end."""
    offered, causes, tick, number = {}, {}, 20, random.choice([3, TOP - 3])
    for _ in range(count):
        number += random.choice([0, -1, 1, 1, 1, 1, 2, 3, 4])
        cause = random.choice([Cause.NONE] * 8 + [Cause.DELAY, Cause.MASQUERADE, Cause.CORRUPTION])
        image, acknowledge = (random.choice([0, 1, 2, 3] * 5 + [wrong]) for wrong in (4, 128))
        index, board = INDEX - (cause is Cause.DELAY), int(cause is Cause.MASQUERADE)
        data = encoded(number, index, board, image, acknowledge)
        data[7] ^= 16 * (cause is Cause.CORRUPTION)
        if random.random() < 0.15:
            place = random.randrange(BYTES)
            data[place:place] = random.choice([[FIRST], [0], data[:place]])
        elif random.random() < 0.1:
            del data[random.randrange(BYTES - 1)]
        for byte in data:
            offered[tick] = byte
            end, tick = tick, tick + random.choice([1, 1, 1, 2, 9])
        causes[end] = cause
        tick = end + CHECK + random.choice([0, 1, 30])
    return offered, causes, tick


@pytest.mark.shows("DRV-1", "DRV-5")
@pytest.mark.parametrize("seed", range(12))
def test_whatever_frames_come_they_are_told_as_the_contract_says(seed):
    random = Random(seed)
    offered, causes, end = random_frames(random, 40)
    toggles = sorted(random.sample(range(end), 12))
    lifeless = {0: 1} | {tick: place % 2 for place, tick in enumerate(toggles)}
    ends = [tick - 1 for place, tick in enumerate(toggles) if place % 2]
    result = run(end + 1, offered, lifeless=lifeless, life_ends=pulses(ends))

    reading, checked, expected, without_life = Reading(), {}, {}, 1
    for tick in range(end + 1):
        without_life = lifeless.get(tick, without_life)
        if tick in checked:
            expected[tick] = reading.judge(checked[tick], without_life, tick in ends)
        elif tick in ends:
            reading.referenced = False
        if tick in offered and (well_formed := reading.form(offered[tick])) is not None:
            checked[tick + CHECK] = causes[tick] if well_formed else Cause.FORMAT
    assert verdicts(result) == expected
