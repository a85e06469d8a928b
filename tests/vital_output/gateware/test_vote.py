"""The vote, tick by tick: what passes inside τ0, what is stored, and what an upset does."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from random import Random

import pytest

from railgate.vital_output.gateware.vote import Vote
from vital_output.gateware.bench import Bench, high, pulses, values
from vital_output.gateware.slots import FIELDS, slots
from vital_output.small import SMALL

pytestmark = pytest.mark.shows("DRV-6")

TAU0 = SMALL.tau0_ticks
TOP = (1 << 32) - 1
INDEX, SEQUENCE = 700, 41
FRAME = {"index": INDEX, "sequence": SEQUENCE, "image": 0b10, "acknowledge": 0b01}
EVENTS = ("passes", "mismatch", "skew", "stored")
PEER = {"peer_ok": 1, "peer_passed": 1, "peer_carries": 1, "peer_sequence": SEQUENCE}
STEADY = {name: {0: 0} for name in PEER}


@dataclass(frozen=True)
class Brief:
    """What a vote needs of a configuration, with a τ0 of so few ticks that random frames meet each
    of its edges."""

    outputs: int = 2
    tau0_ticks: int = 6


@cache
def bench(config=SMALL):
    return Bench(Vote(config))


def comes(own=None, forwarded=None):
    """The inputs for frames by their ticks; a number alone is FRAME's tick."""
    own, forwarded = ({it: FRAME} if isinstance(it, int) else it or {} for it in (own, forwarded))
    return {
        "accepted": pulses(list(own)),
        "peer_accepted": pulses(list(forwarded)),
        **slots("own_frame", own),
        **slots("forwarded_frame", forwarded),
    }


def told(result):
    """Each event by its ticks, those that happen."""
    found = {name: high(result, name) for name in EVENTS}
    return {name: ticks for name, ticks in found.items() if ticks}


def other(**fields):
    return FRAME | fields


@pytest.mark.parametrize(("own", "forwarded"), [(10, 30), (30, 10), (20, 20)])
def test_the_same_frames_pass_in_the_tick_after_both_are_there(own, forwarded):
    result = bench().run(2 * TAU0, comes(own, forwarded))
    after = max(own, forwarded) + 1
    assert told(result) == {"passes": [after]}
    assert high(result, "passed") == [*range(after + 1, 2 * TAU0)]
    assert high(result, "carries") == [*range(own + 1, 2 * TAU0)]


@pytest.mark.parametrize("own_first", [True, False])
def test_the_last_tick_of_tau0_passes_and_the_next_is_skew(own_first):
    def pair(apart):
        return comes(10, 10 + apart) if own_first else comes(10 + apart, 10)

    assert told(bench().run(3 * TAU0, pair(TAU0 - 1))) == {"passes": [10 + TAU0]}
    late = {"skew": [10 + TAU0, 10 + 2 * TAU0]}
    assert told(bench().run(3 * TAU0, pair(TAU0))) == late
    assert told(bench().run(3 * TAU0, pair(TAU0 + 1))) == {"skew": [10 + TAU0, 11 + 2 * TAU0]}


def test_a_single_differing_bit_fails_the_whole_image():
    for name, width in FIELDS.items():
        for bit in range(width):
            wrong = other(**{name: FRAME[name] ^ 1 << bit})
            result = bench().run(2 * TAU0, comes(10, {30: wrong}))
            assert told(result) == {"mismatch": [31]}
            assert not high(result, "passed")


def test_a_later_frame_takes_the_slot_and_leaves_the_window_as_it_was():
    newer = other(sequence=SEQUENCE + 1)
    told_of = told(bench().run(2 * TAU0, comes({10: FRAME, 50: newer}, {60: newer})))
    assert told_of == {"passes": [61]}
    assert told(bench().run(2 * TAU0, comes({10: FRAME, 50: newer}))) == {"skew": [10 + TAU0]}


def test_a_frame_in_the_tick_of_a_vote_begins_a_new_window():
    """The frame of tick 31 is not the one that passes in 31: it has not passed."""
    result = bench().run(2 * TAU0, comes({10: FRAME, 31: other(sequence=9)}, 30))
    assert told(result) == {"passes": [31], "skew": [31 + TAU0]}
    assert not high(result, "passed")
    result = bench().run(2 * TAU0, comes({10: FRAME}, {30: FRAME, 31: FRAME}))
    assert told(result) == {"passes": [31], "skew": [31 + TAU0]}
    assert high(result, "passed")[0] == 32


def test_the_own_frame_is_kept_with_its_crc():
    given = comes({10: FRAME, 40: other(sequence=TOP)}) | {"crc": pulses({10: 77, 40: TOP})}
    result = bench().run(60, given)
    assert [values(result, "own_crc")[k] for k in (10, 11, 40, 41)] == [0, 77, 77, TOP]
    assert values(result, "own.1")[11] == FRAME["image"] | FRAME["acknowledge"] << 2
    assert [values(result, "own.0")[k] >> 32 for k in (10, 11, 40, 41)] == [0, 41, 41, TOP]


def peer(**changes):
    """A peer that has passed the frame, but for these changes by tick."""
    steady = {name: {0: value} for name, value in PEER.items()}
    return steady | changes


def test_a_frame_is_stored_once_when_both_have_passed_it():
    assert told(bench().run(200, comes(10, 30) | peer())) == {"passes": [31], "stored": [32]}


@pytest.mark.parametrize("name", PEER)
def test_a_frame_waits_for_each_condition_of_the_peer(name):
    given = comes(10, 30) | peer(**{name: {0: 0, 90: PEER[name]}})
    assert told(bench().run(200, given)) == {"passes": [31], "stored": [90]}


def test_a_frame_is_not_stored_once_its_cycle_is_decided():
    """In tick 80 the peer has passed it, in tick 60 a cycle is decided."""

    def stored(decided, index=INDEX, at=60, peer_at=80):
        frame = other(index=index)
        given = comes({10: frame}, {30: frame}) | peer(peer_passed={0: 0, peer_at: 1})
        given |= {"decides": pulses([at]), "decided": pulses({at: decided & TOP})}
        return told(bench().run(200, given)).get("stored")

    assert stored(INDEX - 1) == [80]
    assert stored(INDEX) is stored(INDEX + 1) is None
    assert stored(TOP, index=0) == [80]
    assert stored(0, index=TOP) is stored(TOP, index=TOP) is None
    assert stored(INDEX, at=60, peer_at=60) == [60]
    assert stored(INDEX, at=31) is None  # in the tick in which it passes
    assert stored(INDEX, at=30) == [80]


def test_a_frame_accepted_meanwhile_is_not_the_one_that_the_peer_has_passed():
    given = comes({10: FRAME, 40: other(sequence=SEQUENCE + 1)}, 30)
    given |= peer(peer_passed={0: 0, 60: 1}, peer_sequence={0: SEQUENCE + 1})
    assert told(bench().run(TAU0, given)) == {"passes": [31]}


class Reference:
    """The contract's paragraph on the vote, sentence by sentence."""

    def __init__(self):
        self.own = self.forwarded = dict.fromkeys(FIELDS, 0)
        self.own_there = self.forwarded_there = False
        self.passed = self.open = False
        self.remaining = 0

    def tick(self, given):
        """The events of this tick, and the register `passed` in it."""
        events = {"passed": self.passed} | dict.fromkeys(EVENTS, False)
        events["stored"] = (
            self.open
            and given["peer_ok"]
            and given["peer_passed"]
            and given["peer_carries"]
            and given["peer_sequence"] == self.own["sequence"]
        )
        if events["stored"]:
            self.open = False
        not_ahead = (given["decided"] - self.own["index"]) % 2**32 < 2**31
        if self.own_there and self.forwarded_there:
            same = self.own == self.forwarded
            events["passes" if same else "mismatch"] = True
            if same:
                self.passed = self.open = True
            self.own_there = self.forwarded_there = False
            self.remaining = 0
        elif self.remaining == 1:
            events["skew"] = self.own_there or self.forwarded_there
            self.own_there = self.forwarded_there = False
            self.remaining = 0
        elif self.remaining > 1:
            self.remaining -= 1
        if given["decides"] and not_ahead:
            self.open = False
        if given["own"]:
            self.own, self.own_there = given["own"], True
            self.passed = self.open = False
        if given["forwarded"]:
            self.forwarded, self.forwarded_there = given["forwarded"], True
        if (given["own"] or given["forwarded"]) and not self.remaining:
            self.remaining = Brief.tau0_ticks
        return events


def random_ticks(random, count):
    """What happens in each tick: few values, so that they often meet."""
    for _ in range(count):
        told = {name: random.random() < 0.7 for name in ("peer_ok", "peer_passed", "peer_carries")}
        frame = [
            {name: random.choice([3, 3, 3, 2]) % 2**width for name, width in FIELDS.items()}
            if random.random() < 0.15
            else None
            for _ in range(2)
        ]
        yield told | {
            "peer_sequence": random.choice([3, 3, 2]),
            "decides": random.random() < 0.05,
            "decided": random.choice([1, 2, 3, 4, TOP]),
            "own": frame[0],
            "forwarded": frame[1],
        }


@pytest.mark.parametrize("seed", range(4))
def test_random_frames_have_the_fate_of_the_contract(seed):
    count = 5_000
    ticks = list(random_ticks(Random(seed), count))
    given = comes(
        {k: told["own"] for k, told in enumerate(ticks) if told["own"]},
        {k: told["forwarded"] for k, told in enumerate(ticks) if told["forwarded"]},
    )
    for name in (*PEER, "decides", "decided"):
        given[name] = {k: int(told[name]) for k, told in enumerate(ticks)}
    result = bench(Brief()).run(count, given)
    reference = Reference()
    expected = [reference.tick(told) for told in ticks]
    for name in (*EVENTS, "passed"):
        ticks_of = [k for k, events in enumerate(expected) if events[name]]
        assert high(result, name) == ticks_of
        assert len(ticks_of) > 10


@pytest.mark.shows("DRV-16")
@pytest.mark.parametrize("copy", ["value_copy", "inverse_copy"])
@pytest.mark.parametrize("bit", range(TAU0.bit_length()))
def test_an_upset_of_the_window_is_told_and_closes_it(copy, bit):
    vote, given = bench(), comes(10, 30)
    vote.run(20, given)
    remaining = TAU0 - 9
    held = {"value_copy": remaining, "inverse_copy": remaining ^ (1 << TAU0.bit_length()) - 1}
    vote.engine.poke(f"held_remaining.{copy}", held[copy] ^ 1 << bit)
    result = vote.go_on(3 * TAU0, given)
    assert high(result, "error") == [20]
    assert told(result) == {"skew": [20, 30 + TAU0]}
