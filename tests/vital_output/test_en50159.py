"""EN 50159's threats to each field of a frame in a pair that drives: rejected, counted by their
cause, never followed, and over with the next frame (DRV-2 to DRV-6).

All false frames command an output that is off, wherever their image is not what is false.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest

from railgate.vital_output.plant.cpu import Frame
from railgate.vital_output.simulate import Run
from railgate.vital_output.spec import Cause, Config, pack
from vital_output.pair import driving, frames_of, inputs, run, wrong
from vital_output.small import SMALL

pytestmark = pytest.mark.shows("DRV-5", kind="sweep")

PAIR = driving(SMALL, 9, ppm_1=100, ppm_2=-100)
CYCLE = 11
"""In which a false frame comes: the contact has been closed for some cycles."""

FALSE = 0b11
"""An image that commands what is off."""

LAYOUT = SMALL.layout
PLACES = {"sequence": (0, 4), "image": (4, 5), "acknowledge": (5, 6), "crc": (6, 10)}
"""The bytes of each field."""


def kept(data: bytes) -> bytes:
    return data


@dataclass(frozen=True, kw_only=True)
class FalseFrame(Frame):
    """A frame whose CRC is for this board's ID, if it is given, and whose bytes are spoilt."""

    identity: int | None = None
    spoilt: Callable[[bytes], bytes] = kept

    def made(self, config: Config) -> Frame:
        fields = {name: getattr(self, name) for name in ("sequence", "image", "acknowledge")}
        identity = config.boards[self.board] if self.identity is None else self.identity
        crc = LAYOUT.crc(identity, self.time, fields)
        whole = pack(LAYOUT.frame, {**fields, "crc": crc}) ^ self.inverted
        return replace(self, instead=self.spoilt(whole.to_bytes(LAYOUT.frame_bytes, "big")))


Change = Callable[[FalseFrame], FalseFrame]
"""Makes the next frame a false one."""


def step(by: int) -> Change:
    """As far ahead of the frame last accepted."""
    return lambda frame: replace(frame, sequence=(frame.sequence - 1 + by) % (1 << 32))


def late(cycles: int) -> Change:
    return lambda frame: replace(frame, time=frame.time - cycles)


def for_the_other(cycles: int) -> Change:
    return lambda frame: replace(frame, board=1 - frame.board, time=frame.time - cycles)


def spoilt(by: Callable[[bytes], bytes]) -> Change:
    return lambda frame: replace(frame, spoilt=by)


def without(field: str) -> Change:
    """A byte of it is not there."""
    at = PLACES[field][0]
    return spoilt(lambda data: data[:at] + data[at + 1 :])


def doubled(field: str) -> Change:
    """A byte of it comes twice."""
    at = PLACES[field][0]
    return spoilt(lambda data: data[: at + 1] + data[at:])


def turned(first: str, last: str) -> Change:
    """The bytes from one field to another come in the opposite order."""
    begin, end = PLACES[first][0], PLACES[last][1]
    return spoilt(lambda data: data[:begin] + data[begin:end][::-1] + data[end:])


def inverted(field: str, bits: int) -> Change:
    below = 8 * (LAYOUT.frame_bytes - PLACES[field][1])
    return lambda frame: replace(frame, inverted=bits << below)


def both(*changes: Change) -> Change:
    def change(frame: FalseFrame) -> FalseFrame:
        for each in changes:
            frame = each(frame)
        return frame

    return change


MOST = 1 << 31
AGAIN = step(0)
OWN: dict[str, tuple[Change, Cause]] = {
    "repetition": (AGAIN, Cause.REPETITION),
    "repetition, image": (both(AGAIN, lambda f: replace(f, image=0b10)), Cause.REPETITION),
    "repetition, acknowledge": (both(AGAIN, lambda f: replace(f, acknowledge=1)), Cause.REPETITION),
    "repetition, time": (both(AGAIN, late(1)), Cause.DELAY),
    "deletion, sequence": (without("sequence"), Cause.FORMAT),
    "deletion, image": (without("image"), Cause.FORMAT),
    "deletion, acknowledge": (without("acknowledge"), Cause.FORMAT),
    "deletion, crc": (without("crc"), Cause.FORMAT),
    "insertion, sequence": (step(SMALL.life_cycles + 1), Cause.INSERTION),
    "insertion, far": (step(MOST - 1), Cause.INSERTION),
    "insertion, sequence's byte": (doubled("sequence"), Cause.FORMAT),
    "insertion, image's byte": (doubled("image"), Cause.FORMAT),
    "insertion, acknowledge's byte": (doubled("acknowledge"), Cause.FORMAT),
    "insertion, crc's byte": (doubled("crc"), Cause.FORMAT),
    "re-sequence, one back": (step(-1), Cause.RESEQUENCE),
    "re-sequence, far back": (step(-MOST), Cause.RESEQUENCE),
    "re-sequence, sequence's bytes": (turned("sequence", "sequence"), Cause.CORRUPTION),
    "re-sequence, image and acknowledge": (turned("image", "acknowledge"), Cause.CORRUPTION),
    "re-sequence, crc's bytes": (turned("crc", "crc"), Cause.CORRUPTION),
    "corruption, board": (lambda f: replace(f, identity=SMALL.boards[0] ^ 4), Cause.CORRUPTION),
    "corruption, mask": (
        lambda f: replace(f, identity=SMALL.masks[f.board][f.time % 32]),
        Cause.CORRUPTION,
    ),
    "corruption, time": (lambda f: replace(f, time=f.time ^ MOST), Cause.CORRUPTION),
    "corruption, sequence": (inverted("sequence", 0x0010_0204), Cause.CORRUPTION),
    "corruption, image": (inverted("image", 0b11), Cause.CORRUPTION),
    "corruption, image beyond": (inverted("image", 0b0100_0001), Cause.FORMAT),
    "corruption, acknowledge": (inverted("acknowledge", 0b10), Cause.CORRUPTION),
    "corruption, acknowledge beyond": (inverted("acknowledge", 0b1000_0000), Cause.FORMAT),
    "corruption, crc": (inverted("crc", 0xFFFF_FFFF), Cause.CORRUPTION),
    "delay, one cycle": (late(1), Cause.DELAY),
    "delay, all that are tried": (late(SMALL.delay_cycles), Cause.DELAY),
    "delay, more": (late(SMALL.delay_cycles + 1), Cause.CORRUPTION),
    "delay, to come": (late(-1), Cause.DELAY),
    "masquerade": (for_the_other(0), Cause.MASQUERADE),
    "masquerade, time": (for_the_other(SMALL.delay_cycles), Cause.MASQUERADE),
    "masquerade, time to come": (for_the_other(-1), Cause.MASQUERADE),
    "masquerade, sequence": (both(for_the_other(0), AGAIN), Cause.MASQUERADE),
}
"""What is done to the next frame, and its cause."""


@cache
def clean() -> Run:
    found = run(PAIR, SMALL)
    assert wrong(found) == ({}, {})
    assert found.trace["contact"].values.tolist() == [0, 1]
    return found


def false_frame(cpu: int, change: Change, after: Frame, now: Frame) -> FalseFrame:
    """The one that would follow a frame, sent now, made false."""
    frame = FalseFrame(
        cycle=now.cycle,
        sent=now.sent,
        board=cpu - 1,
        time=now.time,
        sequence=after.sequence + 1,
        image=FALSE,
        acknowledge=0,
    )
    return change(frame)


def with_frames(cpu: int, changed: Callable[[list[Frame]], Iterable[Frame]]) -> Run:
    """The pair's run with other frames of a CPU."""
    frames = list(frames_of(PAIR, SMALL))
    frames[cpu - 1] = [
        frame.made(SMALL) if isinstance(frame, FalseFrame) else frame
        for frame in changed(frames[cpu - 1])
    ]
    return run(PAIR, SMALL, inputs(PAIR, SMALL, frames=frames))


def at_cycle(frames: Sequence[Frame]) -> int:
    return next(i for i, frame in enumerate(frames) if frame.cycle == CYCLE)


def differing(found: Run) -> set[str]:
    """Outputs that are not as in the clean run."""
    expected = clean().trace
    inputs_of = PAIR.controls(SMALL).signals
    names = [name for name in expected.signals if name not in inputs_of]
    return {n for n in names if expected[n].first_difference(found.trace[n]) is not None}


@pytest.mark.parametrize("cpu", [1, 2])
@pytest.mark.parametrize("threat", OWN)
def test_a_false_frame_beside_the_right_one_is_counted_and_changes_nothing(
    threat: str, cpu: int
) -> None:
    change, cause = OWN[threat]
    later = SMALL.check_ticks * 10**9 * 2

    def changed(frames: list[Frame]) -> Iterable[Frame]:
        right = frames[at_cycle(frames)]
        false = false_frame(cpu, change, right, right)
        return [*frames, replace(false, sent=right.sent + later)]

    found = with_frames(cpu, changed)
    assert wrong(found)[cpu - 1] == {cause.name.lower(): 1}
    assert wrong(found)[2 - cpu] == {}
    of = f"fpga_{cpu}"
    told = {f"{of}.{cause.name.lower()}_count", f"{of}.first_cause", f"{of}.command.ready"}
    assert differing(found) == told


@pytest.mark.parametrize("cpu", [1, 2])
@pytest.mark.parametrize("threat", OWN)
def test_a_false_frame_in_place_of_the_right_one_is_not_followed_and_the_next_one_is(
    threat: str, cpu: int
) -> None:
    change, cause = OWN[threat]

    def changed(frames: list[Frame]) -> Iterable[Frame]:
        at = at_cycle(frames)
        false = false_frame(cpu, change, frames[at - 1], frames[at])
        return [*frames[:at], false, *frames[at + 1 :]]

    found = with_frames(cpu, changed)
    told = {cause.name.lower(): 1, "skew": 1}
    assert wrong(found)[cpu - 1] == told | {"lost": 1}
    assert wrong(found)[2 - cpu] == {"skew": 1}
    assert_unmoved(found)
    for fpga in (1, 2):
        of = found.channels[fpga - 1]
        assert of.total("accepted") == clean().channels[fpga - 1].total("accepted") - (fpga == cpu)
        assert of.total("stored") == clean().channels[fpga - 1].total("stored") - 1
        assert of.wave("life").values.tolist() == [0, 3]


def assert_unmoved(found: Run) -> None:
    """Contact, images and states are as in the clean run."""
    names = {"contact", *(f"fpga_{c}.{n}" for c in (1, 2) for n in ("image", "states", "blocked"))}
    assert not names & differing(found)


@pytest.mark.shows("DRV-6")
@pytest.mark.parametrize("cpu", [1, 2])
def test_a_frame_that_does_not_come_is_counted_as_lost(cpu: int) -> None:
    found = with_frames(cpu, lambda frames: [f for f in frames if f.cycle != CYCLE])
    assert wrong(found)[cpu - 1] == {"skew": 1, "lost": 1}
    assert wrong(found)[2 - cpu] == {"skew": 1}
    assert_unmoved(found)


@pytest.mark.shows("DRV-6")
@pytest.mark.parametrize("cpu", [1, 2])
@pytest.mark.parametrize("change", [{"image": FALSE}, {"image": 0}, {"acknowledge": 1}])
def test_what_one_cpu_alone_commands_is_accepted_but_never_followed(
    change: dict[str, int], cpu: int
) -> None:
    def changed(frames: list[Frame]) -> Iterable[Frame]:
        return [replace(f, **change) if f.cycle == CYCLE else f for f in frames]

    found = with_frames(cpu, changed)
    assert wrong(found) == ({"mismatch": 1}, {"mismatch": 1})
    assert_unmoved(found)


@pytest.mark.shows("DRV-2")
@pytest.mark.parametrize("cpu", [1, 2])
def test_every_bit_of_a_frame_is_needed(cpu: int) -> None:
    """Each inverted alone, in a copy of the next frame that comes beside the right ones."""
    bits = 8 * LAYOUT.frame_bytes
    room = (SMALL.check_ticks + LAYOUT.frame_bytes + 2) * 10**9

    def changed(frames: list[Frame]) -> Iterable[Frame]:
        at = at_cycle(frames)
        false = []
        for bit in range(bits):
            right = frames[at + bit // 50]
            made = false_frame(cpu, lambda f, b=bit: replace(f, inverted=1 << b), right, right)
            false.append(replace(made, sent=right.sent + (2 + bit % 50) * room))
        return [*frames, *false]

    found = with_frames(cpu, changed)
    causes = (Cause.FORMAT, Cause.CORRUPTION)
    told = sorted(
        (at, c) for c in causes for at, _ in found.channels[cpu - 1].counted(c.name.lower())
    )
    places = LAYOUT.frame_bytes - np.arange(bits) // 8 - 1
    beyond = ((places == 4) | (places == 5)) & (np.arange(bits) % 8 >= SMALL.outputs)
    assert [cause for _, cause in told] == [causes[not each] for each in beyond]
    of = f"fpga_{cpu}"
    names = {f"{of}.{name}" for name in ("format_count", "corruption_count", "first_cause")}
    assert differing(found) == names | {f"{of}.command.ready"}
