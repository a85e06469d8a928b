"""The safety property: how long contacts stay closed after the last agreed, live 1 (DRV-16)."""

from __future__ import annotations

from dataclasses import dataclass

import pytest
from hypothesis import given
from hypothesis import strategies as st

from railgate.vital_output.observed import Frame
from railgate.vital_output.plant.edges import FEMTOSECOND
from railgate.vital_output.verdict import Verdict, judge
from railgate.waves import Waveform
from vital_output.runs import run_of
from vital_output.small import SMALL

pytestmark = pytest.mark.shows("DRV-16")

DECLARED = int(SMALL.reaction_s / FEMTOSECOND)
"""Whole femtoseconds: at most the declared time, and one more is too long."""
END = 10 * DECLARED


@dataclass
class Channel:
    """Of a channel just what it stored: when, and the frame; and the image that it had then."""

    stores: tuple[tuple[int, Frame], ...]
    latched: bool = False

    def wave(self, name: str) -> Waveform:
        assert name == "image"
        images = [0 if self.latched else frame.image for _, frame in self.stores]
        return Waveform.of([0, *(at for at, _ in self.stores)], [0, *images], SMALL.outputs)


def channel(*stored: tuple[int, int, int], latched: bool = False) -> Channel:
    """Of the last byte's time, the time of the store, and the image."""
    frames = ((at, Frame(tick=0, at=sent, values={"image": image})) for sent, at, image in stored)
    return Channel(tuple(frames), latched)


def closed(*spans: tuple[int, int], output: int = 0, end: int = END) -> Waveform:
    ticks = [0, *(tick for span in spans for tick in span if tick < end)]
    return Waveform.of(ticks, [(i % 2) << output for i in range(len(ticks))], SMALL.outputs)


def judged(contact: Waveform, *channels: Channel, end: int = END) -> Verdict:
    return judge(SMALL, contact, end, channels)  # type: ignore[arg-type]


@pytest.mark.parametrize(("more", "violations"), [(0, 0), (1, 1)])
def test_a_contact_may_be_closed_for_just_the_declared_time_after_the_last_live_1(
    more: int, violations: int
) -> None:
    verdict = judged(closed((50, 100 + DECLARED + more)), channel((100, 150, 1)), channel())
    assert len(verdict.violations) == violations
    assert verdict.worst_s("failure") == (DECLARED + more) * FEMTOSECOND


def test_the_later_one_of_both_channels_counts() -> None:
    one, other = channel((100, 150, 1)), channel((100, 150, 1), (300, 350, 1))
    contact = closed((200, 300 + DECLARED))
    for channels in ((one, other), (other, one)):
        verdict = judged(contact, *channels)
        assert verdict.violations == ()
        assert verdict.closings[0].live == 300
    assert len(judged(contact, one, one).violations) == 1


def test_what_is_stored_after_the_end_of_a_span_does_not_count_for_it() -> None:
    opened = 101 + DECLARED
    late = channel((100, 150, 1), (opened - 10, opened + 1, 1))
    assert judged(closed((200, opened)), late, channel()).closings[0].live == 100
    there = channel((100, 150, 1), (opened - 10, opened, 1))
    assert judged(closed((200, opened)), there, channel()).closings[0].live == opened - 10


def test_a_1_that_a_latch_keeps_out_of_the_image_is_not_live() -> None:
    contact = closed((200, 300 + DECLARED))
    latched = channel((100, 150, 1), (300, 350, 1), latched=True)
    verdict = judged(contact, channel((100, 150, 1)), latched)
    assert verdict.closings[0].live == 100
    assert len(verdict.violations) == 1


def test_only_the_outputs_own_bit_counts() -> None:
    stores = channel((100, 150, 0b01), (300, 350, 0b10))
    assert judged(closed((200, 900)), stores, channel()).closings[0].live == 100
    assert judged(closed((200, 900), output=1), stores, channel()).closings[0].live == 300


def test_a_span_to_the_end_of_the_run_is_held_to_it_too() -> None:
    for end, violations in ((100 + DECLARED, 0), (101 + DECLARED, 1)):
        verdict = judged(closed((50, end), end=end), channel((100, 150, 1)), channel(), end=end)
        assert len(verdict.violations) == violations
        assert (verdict.closings[0].lasts, verdict.closings[0].opened_by) == (True, None)
        assert verdict.worst_s("failure") is verdict.worst_s("command") is None


def test_without_any_live_1_it_is_bounded_from_its_beginning() -> None:
    for more, violations in ((0, 0), (1, 1)):
        verdict = judged(closed((500, 500 + DECLARED + more)), channel((100, 150, 0)), channel())
        assert len(verdict.violations) == violations
        assert verdict.closings[0].late
        assert verdict.closings[0].since_live_s is None
        assert verdict.worst_s("failure") is None


def test_a_span_long_after_the_last_live_1_is_late_and_no_measure_of_a_reaction() -> None:
    start = 101 + DECLARED
    verdict = judged(closed((start, start + 9)), channel((100, 150, 1), (300, 350, 0)), channel())
    (closing,) = verdict.closings
    assert (closing.late, closing.opened_by) == (True, "failure")
    assert verdict.worst_s("failure") is verdict.worst_s("command") is None


def test_a_stored_0_opens_by_command_all_else_is_a_failure() -> None:
    contact = closed((200, 900))
    off = channel((100, 150, 1), (300, 350, 0))
    on = channel((100, 150, 1))
    for channels in ((off, off), (off, on), (on, off)):
        verdict = judged(contact, *channels)
        assert verdict.closings[0].opened_by == "command"
        assert verdict.worst_s("command") == 800 * FEMTOSECOND
    assert judged(contact, on, on).closings[0].opened_by == "failure"
    again = channel((100, 150, 0), (300, 350, 1))
    assert judged(contact, again, again).closings[0].opened_by == "failure"


times = st.integers(1, END // 1000).map(lambda part: 1000 * part)
stores = st.lists(st.tuples(times, st.integers(1, DECLARED // 20), st.integers(0, 3)), max_size=12)


@given(st.lists(times, unique=True, max_size=9), st.sampled_from([0, 1]), st.tuples(stores, stores))
def test_it_is_what_the_property_says_span_by_span(
    changes: list[int], output: int, stored: tuple[list[tuple[int, int, int]], ...]
) -> None:
    ends = [*sorted(changes), END]
    spans = list(zip(ends[::2], ends[1::2], strict=False))
    stores_at = [{sent + later: (sent, image) for sent, later, image in each} for each in stored]
    told = [[(sent, at, image) for at, (sent, image) in sorted(s.items())] for s in stores_at]
    too_long = []
    for a, b in spans:
        ones = [
            sent for each in told for sent, at, image in each if at <= b and image >> output & 1
        ]
        g = max(ones, default=a)
        if (b - max(a, g)) * FEMTOSECOND > SMALL.reaction_s:
            too_long.append(a)
    verdict = judged(closed(*spans, output=output), *(channel(*each) for each in told))
    assert [each.closed for each in verdict.violations] == too_long
    assert len(verdict.closings) == len([1 for a, _ in spans if a < END])


def test_in_a_run_the_last_live_1_is_the_last_frame_that_both_cpus_sent() -> None:
    run = run_of("cpu-dead")
    (closing,) = run.verdict.closings
    sent = [frame.at for frame in run.channels[0].frames]
    assert closing.live in (sent[-1], run.channels[1].frames[len(sent) - 1].at)
    assert 0 < run.verdict.worst_s("failure") <= SMALL.reaction_s  # type: ignore[operator]
    assert run.verdict.declared_s == SMALL.reaction_s
