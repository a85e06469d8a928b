"""How each kind of fault changes what the CPUs send, the time that is given, and the wires."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from math import ceil

import numpy as np

from railgate.vital_output.plant.cpu import Frame
from railgate.vital_output.plant.draft import Draft, Effect, Hit
from railgate.vital_output.plant.edges import FEMTOSECOND, MICROSECOND, femtoseconds
from railgate.vital_output.spec import Config

__all__ = [
    "corruption",
    "delay",
    "deletion",
    "disagree",
    "insertion",
    "link_cut",
    "link_noise",
    "masquerade",
    "of_cpu",
    "output_held",
    "repetition",
    "resequence",
    "restart",
    "skew",
    "stopped",
    "switch_over",
    "test_fails",
    "time_drift",
    "time_lost",
    "time_step",
]

MOST_CHANGES = 10_000_000
"""Of noise on each line."""

MOST_US = 10**9
OTHER_BASE = 1 << 31
"""So far from the sequence number that was to come is the first one after a switch-over."""

Change = Callable[[Config, Hit, Frame], Sequence[Frame]]
"""What comes in the place of a frame."""


def of_cpu(cpu: int, change: Change) -> Effect:
    """CPU 1's or 2's frames of the cycles hit are changed."""

    def effect(draft: Draft, hit: Hit) -> None:
        draft.frames[cpu - 1] = [
            after
            for frame in draft.frames[cpu - 1]
            for after in (
                change(draft.config, hit, frame) if frame.cycle in hit.cycles else (frame,)
            )
        ]

    return effect


def deletion(_config: Config, _hit: Hit, _frame: Frame) -> Sequence[Frame]:
    return ()


def disagree(config: Config, hit: Hit, frame: Frame) -> Sequence[Frame]:
    return (replace(frame, image=frame.image ^ 1 << hit.given(0, 0, config.outputs - 1)),)


def skew(config: Config, hit: Hit, frame: Frame) -> Sequence[Frame]:
    clearly = config.tau0_ticks + 2 * config.latency_ticks
    later = hit.given(ceil(clearly * 10**6 / config.clock_hz), 0, MOST_US)
    return (replace(frame, sent=frame.sent + later * MICROSECOND),)


def repetition(_config: Config, _hit: Hit, frame: Frame) -> Sequence[Frame]:
    return (frame, frame)


def insertion(config: Config, hit: Hit, frame: Frame) -> Sequence[Frame]:
    ahead = hit.given(config.life_cycles + 1, 1, OTHER_BASE - 1)
    every = (1 << config.outputs) - 1
    return (frame, replace(frame, sequence=frame.sequence + ahead, image=every))


def corruption(config: Config, hit: Hit, frame: Frame) -> Sequence[Frame]:
    bits = 8 * config.layout.frame_bytes
    return (replace(frame, inverted=frame.inverted ^ 1 << bits - hit.given(1, 1, bits)),)


def delay(config: Config, hit: Hit, frame: Frame) -> Sequence[Frame]:
    cycles = hit.given(1, 1, 1_000_000)
    return (replace(frame, sent=frame.sent + femtoseconds(cycles * config.cycle_s)),)


def masquerade(_config: Config, _hit: Hit, frame: Frame) -> Sequence[Frame]:
    return (replace(frame, board=1 - frame.board),)


def resequence(cpu: int) -> Effect:
    """Two frames that follow one another come in each other's place, at the right times."""

    def effect(draft: Draft, hit: Hit) -> None:
        frames = draft.frames[cpu - 1]
        at = 0
        while at + 1 < len(frames):
            if frames[at].cycle in hit.cycles:
                one, other = frames[at : at + 2]
                frames[at : at + 2] = [_in_place(one, other), _in_place(other, one)]
                at += 1
            at += 1

    return effect


def _in_place(place: Frame, content: Frame) -> Frame:
    return replace(content, cycle=place.cycle, sent=place.sent, time=place.time)


def switch_over(draft: Draft, hit: Hit) -> None:
    first = hit.cycles.start
    least = hit.given(draft.config.life_cycles + 2, 0, 1_000_000)
    resumed = max(hit.cycles.stop, first + least)
    for cpu, frames in enumerate(draft.frames):
        draft.frames[cpu] = [frame for frame in frames if frame.cycle < first] + [
            replace(frame, sequence=frame.sequence + OTHER_BASE)
            for frame in frames
            if frame.cycle >= resumed
        ]


def time_lost(fpga: int) -> Effect:
    """No update comes to FPGA 1 or 2."""

    def effect(draft: Draft, hit: Hit) -> None:
        given = draft.updates[fpga - 1]
        draft.updates[fpga - 1] = [each for each in given if each.cycle not in hit.cycles]

    return effect


def time_step(fpga: int) -> Effect:
    """The time given is ahead by the value."""

    def effect(draft: Draft, hit: Hit) -> None:
        microseconds = hit.given(ceil(draft.config.cycle_s * 10**6), -MOST_US, MOST_US)
        _put_ahead(draft, fpga, hit, lambda _: microseconds * MICROSECOND)

    return effect


def time_drift(fpga: int) -> Effect:
    """The time given runs fast by the value, in ppm."""

    def effect(draft: Draft, hit: Hit) -> None:
        ppm = hit.given(1_000, -100_000, 100_000)
        _put_ahead(draft, fpga, hit, lambda due: (due - hit.start) * ppm // 10**6)

    return effect


def _put_ahead(draft: Draft, fpga: int, hit: Hit, by: Callable[[int], int]) -> None:
    """The updates in the cycles hit are ahead by so many femtoseconds."""
    per_femtosecond = draft.config.clock_hz * FEMTOSECOND
    draft.updates[fpga - 1] = [
        replace(each, ahead_ticks=each.ahead_ticks + round(by(each.due) * per_femtosecond))
        if each.cycle in hit.cycles
        else each
        for each in draft.updates[fpga - 1]
    ]


def link_cut(fpga: int) -> Effect:
    """The line from FPGA 1 or 2 holds a level."""

    def effect(draft: Draft, hit: Hit) -> None:
        level = ("low", "high")[hit.given(1, 0, 1)]
        draft.hold(f"line_{fpga}.{level}", hit.start, hit.stop)

    return effect


def link_noise(draft: Draft, hit: Hit) -> None:
    config = draft.config
    mean = hit.given(config.message_ticks, 1, 1 << 40) * 10**15 / config.clock_hz
    for fpga in (1, 2):
        count = hit.random.poisson((hit.stop - hit.start) / mean)
        if count > MOST_CHANGES:
            raise ValueError(f"noise must be at most {MOST_CHANGES} changes, not {count}")
        times = np.sort(hit.random.integers(hit.start, hit.stop, 2 * (count // 2)))
        draft.hold(f"line_{fpga}.flip", times[::2], times[1::2])


def restart(fpga: int) -> Effect:
    """FPGA 1 or 2 starts anew, with another boot number."""

    def effect(draft: Draft, hit: Hit) -> None:
        first = draft.hold_ticks(fpga, "_rst", hit.start, hit.stop)
        draft.starts[fpga - 1].append(first)

    return effect


def stopped(fpga: int) -> Effect:
    """The clock of FPGA 1 or 2 has no edges."""

    def effect(draft: Draft, hit: Hit) -> None:
        draft.hold_ticks(fpga, ".stopped", hit.start, hit.stop)

    return effect


def output_held(wire: str) -> Effect:
    """A wire of the relays or the feedback is 1, of the output that the value tells."""

    def effect(draft: Draft, hit: Hit) -> None:
        output = hit.given(0, 0, draft.config.outputs - 1)
        draft.hold(f"relay.{wire}", hit.start, hit.stop, output)

    return effect


def test_fails(draft: Draft, hit: Hit) -> None:
    output_held("rogue_2")(draft, hit)
    for fpga in (1, 2):
        draft.hold_ticks(fpga, ".test", hit.start, hit.start)
