"""One output, whatever it sees: the contract's rules in their order, in ten thousands of ticks."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from random import Random

import pytest

from railgate.vital_output.gateware.output import Output
from railgate.vital_output.spec import Code, State
from vital_output.gateware.bench import Bench, values

pytestmark = pytest.mark.shows("DRV-8", "DRV-9", "DRV-10", "DRV-11", "DRV-12")

IDLE, PRE_DRIVE, DRIVE, WAIT, TEST, HANDSHAKE_ALARM, FEEDBACK_ALARM = State


@dataclass(frozen=True)
class Brief:
    """What an output needs of a configuration, so brief that random inputs meet every limit."""

    tau1_ticks: int = 8
    not_yet_driving_ticks: int = 6
    pulse_grace_ticks: int = 3
    pick_up_ticks: int = 9
    skew_ticks: int = 4
    release_ticks: int = 7
    test_ticks: int = 10
    period_ticks: int = 5
    half_period_ticks: int = 2


class Reference:
    """The contract's paragraph on driving, sentence by sentence."""

    def __init__(self):
        self.state, self.elapsed, self.left, self.pulse = IDLE, 0, False, 0

    def tick(self, seen):
        """The state and the pulse in this tick, and the state that it makes."""
        told = self.state, self.pulse
        drives = self.state in (DRIVE, TEST)
        self.pulse = int(drives and self.elapsed % Brief.period_ticks < Brief.half_period_ticks)
        following = self.following(**seen)
        if self.state is WAIT and not seen["cmd"]:
            self.left = False
        if following is WAIT and self.state is not WAIT:
            self.left = self.state is DRIVE and bool(seen["cmd"])
        self.elapsed = 0 if following is not self.state else self.elapsed + 1
        self.state = following
        return told

    def following(self, cmd, fb, frequency, contact, begins, watching, acknowledged, peer_code):
        elapsed, left, c = self.elapsed, self.left, Brief
        rules = {
            IDLE: [
                (watching and fb, FEEDBACK_ALARM),
                (fb, WAIT),
                (begins, TEST),
                (cmd, PRE_DRIVE),
            ],
            PRE_DRIVE: [
                (not cmd, IDLE),
                (fb, WAIT),
                (peer_code in (Code.PRE_DRIVE, Code.DRIVE), DRIVE),
                (elapsed >= c.tau1_ticks - 1, HANDSHAKE_ALARM),
            ],
            DRIVE: [
                (not cmd, WAIT),
                (peer_code == Code.ALARM, HANDSHAKE_ALARM),
                (peer_code == Code.OFF, WAIT),
                (
                    peer_code == Code.PRE_DRIVE and elapsed >= c.not_yet_driving_ticks,
                    HANDSHAKE_ALARM,
                ),
                (elapsed >= c.pulse_grace_ticks and not frequency, FEEDBACK_ALARM),
                (elapsed >= c.pick_up_ticks and not contact, FEEDBACK_ALARM),
            ],
            WAIT: [
                (left and cmd and elapsed >= c.skew_ticks, HANDSHAKE_ALARM),
                (not fb and not (left and cmd), IDLE),
                (fb and elapsed >= c.release_ticks, FEEDBACK_ALARM),
            ],
            TEST: [
                (contact, FEEDBACK_ALARM),
                (elapsed >= c.test_ticks - 1, WAIT if frequency else FEEDBACK_ALARM),
            ],
            HANDSHAKE_ALARM: [(not cmd and not fb, IDLE)],
            FEEDBACK_ALARM: [(acknowledged and not cmd and not fb, IDLE)],
        }
        return next((state for applies, state in rules[self.state] if applies), self.state)


ODDS = {
    "cmd": 0.9,
    "fb": 0.3,
    "frequency": 0.9,
    "contact": 0.6,
    "begins": 0.3,
    "watching": 0.3,
    "acknowledged": 0.3,
}


def random_ticks(random, count):
    """Inputs that mostly stay as they are."""
    held = dict.fromkeys((*ODDS, "peer_code"), 0)
    change = 0.1
    for tick in range(count):
        if tick % 1000 == 0:
            change = random.choice([0.02, 0.1, 0.5])
        for name, odds in ODDS.items():
            if random.random() < change:
                held[name] = int(random.random() < odds)
        if random.random() < change:
            held["peer_code"] = random.choice([Code.PRE_DRIVE, Code.DRIVE, Code.DRIVE, *Code])
        yield dict(held)


def test_random_inputs_bring_the_states_of_the_contract():
    ticks = list(random_ticks(Random(7), 100_000))
    reference = Reference()
    expected = [reference.tick(seen) for seen in ticks]
    given = {name: {k: int(seen[name]) for k, seen in enumerate(ticks)} for name in ticks[0]}
    result = Bench(Output(Brief())).run(len(ticks), given)
    found = zip(values(result, "state"), values(result, "pulse"), strict=True)
    assert list(found) == expected
    changes = {(a, b) for (a, _), (b, _) in pairwise(expected) if a != b}
    assert len(changes) == 18, "each transition of the contract happens"
