"""What is stored, how long it lives, and what forces a 0 (DRV-5, DRV-7, DRV-12, DRV-15)."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import pytest

from railgate.vital_output.gateware.storage import Storage
from vital_output.gateware.bench import Bench, high, pulses, values
from vital_output.gateware.slots import slots
from vital_output.small import SMALL

TOP = (1 << 32) - 1
LIFE = SMALL.life_cycles
ONES = (1 << SMALL.outputs) - 1
INTERVAL = 3
EAGER = replace(SMALL, zero_at_once=True)
LATCHING = replace(SMALL, error_interval_s=INTERVAL * SMALL.cycle_s)
INDEX = 700


@cache
def bench(config=SMALL):
    return Bench(Storage(config))


def frame(index=INDEX, image=ONES, acknowledge=0):
    return {"index": index, "sequence": 0, "image": image, "acknowledge": acknowledge}


def stores(frames):
    """The inputs that store these frames in their ticks."""
    return {"stored": pulses(list(frames)), **slots("own", frames)}


def decides(decided):
    """The inputs that decide these cycles in their ticks."""
    return {"decides": pulses(list(decided)), "decided": pulses(decided)}


def events(name, *ticks):
    return {name: pulses(ticks)}


def at(result, name, *ticks):
    held = values(result, name)
    return [held[tick - result.start] for tick in ticks]


@pytest.mark.shows("DRV-7")
def test_what_is_stored_has_its_whole_life():
    result = bench().run(20, stores({10: frame(image=0b10, acknowledge=0b01)}))
    for name, before, after in [
        ("image", 0, 0b10),
        ("life", 0, LIFE),
        ("acknowledge", ONES, 0b01),
    ]:
        assert at(result, name, 10, 11, 19) == [before, after, after]


@pytest.mark.shows("DRV-7")
def test_life_falls_with_each_cycle_that_is_decided_unstored_and_at_0_so_does_the_image():
    cycles = {20 + cycle * 10: INDEX + cycle for cycle in range(6)}
    result = bench().run(90, stores({10: frame()}) | decides(cycles))
    assert at(result, "life", 21, 31, 41, 51, 61) == [3, 2, 1, 0, 0]
    assert at(result, "image", 50, 51) == [ONES, 0]
    assert high(result, "life_out") == high(result, "life_ends") == [50]


@pytest.mark.shows("DRV-7")
@pytest.mark.parametrize(
    ("index", "decided", "falls"),
    [
        (INDEX, INDEX, False),
        (INDEX, INDEX - 1, False),
        (INDEX, INDEX + 1, True),
        (0, TOP, False),
        (TOP, 0, True),
        (0, (1 << 31) - 1, True),
        (0, 1 << 31, True),
        (0, (1 << 31) + 1, False),
    ],
)
def test_a_cycle_is_in_time_while_the_stored_one_is_not_behind_it(index, decided, falls):
    result = bench().run(30, stores({10: frame(index)}) | decides({20: decided}))
    assert at(result, "life", 20, 21) == [LIFE, LIFE - falls]


@pytest.mark.shows("DRV-7")
def test_what_is_stored_in_the_tick_of_decision_is_in_time():
    cycles = {20 + cycle: INDEX + 1 + cycle for cycle in range(LIFE)}
    last = 20 + LIFE - 1
    result = bench().run(40, stores({10: frame(), last: frame(image=0b01)}) | decides(cycles))
    assert at(result, "life", last, last + 1) == [1, LIFE]
    assert at(result, "image", last, last + 1) == [ONES, 0b01]
    assert not high(result, "life_out")


@pytest.mark.shows("DRV-12")
def test_an_output_is_acknowledged_by_the_rise_of_its_bit_in_what_is_stored():
    told = [ONES, 0, 0b01, 0b11, 0b11, 0b10, 0b01]
    frames = {10 + place: frame(acknowledge=bits) for place, bits in enumerate(told)}
    result = bench().run(30, stores(frames))
    rises = {tick: at(result, "acknowledged", tick)[0] for tick in high(result, "acknowledged")}
    assert rises == {12: 0b01, 13: 0b10, 16: 0b01}


@pytest.mark.shows("DRV-7")
def test_with_zero_at_once_a_0_of_either_frame_is_obeyed_and_a_1_is_not():
    given = stores({10: frame(), 30: frame(), 50: frame(image=0)})
    given |= events("accepted", 20, 30, 60) | events("peer_accepted", 40, 60)
    given |= {
        "accepted_image": pulses({20: 0b10, 30: 0b01, 60: ONES}),
        "forwarded_image": pulses({40: 0b10, 60: ONES}),
    }
    ticks = (11, 20, 21, 31, 40, 41, 51, 61)
    assert at(bench(EAGER).run(70, given), "image", *ticks) == [3, 3, 2, 1, 1, 0, 0, 0]
    assert at(bench().run(70, given), "image", *ticks) == [3, 3, 3, 3, 3, 3, 0, 0]


@pytest.mark.shows("DRV-7")
def test_zeros_of_both_frames_of_a_tick_are_obeyed():
    given = stores({10: frame()}) | events("accepted", 20) | events("peer_accepted", 20)
    given |= {"accepted_image": {0: 0b10}, "forwarded_image": {0: 0b01}}
    assert at(bench(EAGER).run(30, given), "image", 20, 21) == [ONES, 0]


def latched(rejections, decisions=(), **more):
    cycles = dict.fromkeys(decisions, INDEX - 1)
    given = stores({5: frame()}) | decides(cycles) | events("rejected", *rejections)
    return bench(LATCHING).run(100, given | more)


@pytest.mark.shows("DRV-15")
def test_a_second_rejection_inside_the_interval_latches_and_forces_0():
    result = latched([10, 20, 30], decisions=[12, 14])
    assert high(result, "latches") == [20]
    assert high(result, "latched") == [*range(21, 100)]
    assert at(result, "image", 20, 21) == [ONES, 0]
    assert at(result, "life", 21) == [LIFE]


@pytest.mark.shows("DRV-15")
def test_the_interval_ends_with_its_last_decision():
    assert not high(latched([10, 20], decisions=[12, 14, 16]), "latched")
    assert high(latched([10, 20], decisions=[12, 14, 20]), "latches") == [20]
    assert high(latched([10, 20], decisions=[10, 12, 14]), "latches") == [20]
    assert not high(latched([10, 20], decisions=[12, 14, 19]), "latched")
    assert high(latched([10, 20, 30], decisions=[12, 14, 16, 22, 24]), "latches") == [30]


@pytest.mark.shows("DRV-15")
def test_while_it_is_latched_what_is_stored_does_not_drive():
    stored = stores({5: frame(), 30: frame(), 40: frame(acknowledge=0b10), 50: frame()})
    result = latched([10, 20], **stored)
    assert at(result, "life", 31) == [LIFE]
    assert at(result, "image", 31, 40, 41, 51) == [0, 0, ONES, ONES]
    assert high(result, "latched") == [*range(21, 41)]


@pytest.mark.shows("DRV-15")
def test_a_rejection_in_the_tick_of_the_acknowledgement_latches_anew():
    stored = stores({5: frame(), 40: frame(acknowledge=0b10)})
    result = latched([10, 20, 40], **stored)
    assert high(result, "latches") == [20, 40]
    assert high(result, "latched") == [*range(21, 100)]
    assert at(result, "image", 41) == [0]


@pytest.mark.shows("DRV-15")
def test_without_an_error_interval_nothing_latches():
    result = bench().run(100, events("rejected", *range(10, 20)))
    assert not high(result, "latched")
    assert not high(result, "latches")


@pytest.mark.shows("DRV-5")
def test_an_output_is_blocked_until_a_live_0_and_again_when_the_peer_has_started_anew():
    given = stores({10: frame(image=0b10), 30: frame(image=0), 50: frame(image=0b01)})
    given |= events("booted", 20, 40)
    result = bench().run(70, given)
    assert at(result, "blocked", 10, 11, 12, 21, 22, 31, 32) == [3, 3, 2, 3, 2, 2, 0]
    assert at(result, "blocked", 40, 41, 42, 51, 52) == [0, 3, 0, 0, 0]


@pytest.mark.shows("DRV-5")
def test_an_image_without_life_unblocks_nothing():
    assert values(bench().run(30, {}), "blocked") == [ONES] * 30
    cycles = {11 + cycle: INDEX + 1 + cycle for cycle in range(LIFE)}
    given = stores({10: frame()}) | decides(cycles) | events("booted", 20)
    assert at(bench().run(40, given), "blocked", 14, 20, 21, 39) == [ONES] * 4


COPIES = [
    (register, held, copy, bit)
    for register, held, width in [
        ("held_life", LIFE, 4),
        ("held_image", ONES, SMALL.outputs),
        ("errors.held_remaining", INTERVAL, INTERVAL.bit_length()),
    ]
    for copy, held in [("value_copy", held), ("inverse_copy", held ^ (1 << width) - 1)]
    for bit in range(width)
]


@pytest.mark.shows("DRV-16")
@pytest.mark.parametrize(("register", "held", "copy", "bit"), COPIES)
def test_each_bit_of_either_copy_is_told_when_it_is_upset(register, held, copy, bit):
    storage = bench(LATCHING)
    given = stores({10: frame()}) | events("rejected", 12)
    assert not high(storage.run(20, given), "error")
    storage.engine.poke(f"{register}.{copy}", held ^ 1 << bit)
    assert high(storage.go_on(40, given), "error") == [20]


@pytest.mark.shows("DRV-16")
@pytest.mark.parametrize("stored_at", [10, 20])
def test_an_upset_ends_life_and_image_whatever_is_stored(stored_at):
    given = stores({stored_at: frame()}) | events("upset", 20)
    result = bench().run(40, given)
    assert at(result, "life", 21, 39) == at(result, "image", 21, 39) == [0, 0]
    assert high(result, "life_ends") == [20]
    assert not high(result, "life_out")


@pytest.mark.shows("DRV-16")
def test_an_upset_unblocks_nothing():
    given = stores({10: frame()}) | events("upset", 20)
    storage = bench()
    storage.run(20, given)
    storage.engine.poke("held_image.value_copy", 0)
    assert at(storage.go_on(40, given), "blocked", 20, 21, 39) == [ONES] * 3


@pytest.mark.shows("DRV-16")
@pytest.mark.parametrize("again", [20, 40])
def test_an_upset_interval_begins_anew_and_is_not_over(again):
    storage = bench(LATCHING)
    given = decides({12: 0, 14: 0, 30: 0, 32: 0}) | events("rejected", 10, again)
    storage.run(20, given)
    storage.engine.poke("errors.held_remaining.value_copy", 0)
    assert high(storage.go_on(60, given), "latches") == [again]
