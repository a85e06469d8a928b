"""The cross-link's receiver: what each message makes of the link and of the peer's fields."""

from __future__ import annotations

from functools import cache
from random import Random

import pytest

from railgate.vital_output.gateware.crosslink import LinkReceiver
from railgate.vital_output.spec import Config
from vital_output.gateware.bench import Bench, high
from vital_output.gateware.messages import line, message, verdict_ticks
from vital_output.small import SMALL

pytestmark = pytest.mark.shows("DRV-6")

PERIOD = SMALL.link_period_ticks
VERDICT = verdict_ticks(SMALL)
LOST = SMALL.lost_ticks
EVENTS = (
    "taken",
    "booted",
    "bad_check",
    "bad_digest",
    "bad_sequence",
    "lost",
    "off_frequency",
    "fresh_frame",
)
FIELDS = {
    field.name: field.width
    for field in SMALL.layout.message
    if field.name not in ("number", "digest", "crc")
}
FORWARDED = ("sequence", "image", "acknowledge", "frame_crc")


@cache
def receiver(config=SMALL, board=1):
    return Bench(LinkReceiver(config, board))


def some(random):
    """Fields of a message, any values."""
    return {name: random.getrandbits(width) for name, width in FIELDS.items()}


def received(messages, end=None, bench=None):
    """What the receiver tells of messages (bits, by the tick in which they begin at the pin)."""
    end = end or max(messages) + SMALL.message_ticks + 40
    return (bench or receiver()).run(end, {"link_rx": line(SMALL, messages)})


def numbered(*numbers, **fields):
    """Messages with these numbers, one every PERIOD ticks."""
    return {
        20 + place * PERIOD: message(SMALL, 0, number=number % 256, **fields)
        for place, number in enumerate(numbers)
    }


def told(result):
    """The events, by the place of the message in whose verdict's tick they are."""
    events = {}
    for name in EVENTS:
        for tick in high(result, name):
            place, off = divmod(tick - 20 - VERDICT, PERIOD)
            events.setdefault(place if not off else f"tick {tick}", set()).add(name)
    return events


@pytest.mark.parametrize("kind", ["pysim", "cxxrtl"])
def test_the_second_of_two_consecutive_messages_links_and_its_fields_are_the_peers(kind):
    random = Random(9)
    sent = [some(random) | {"carries": 1} for _ in range(3)]
    bits = {
        20 + place * PERIOD: message(SMALL, 0, number=254 + place & 255, **fields)
        for place, fields in enumerate(sent)
    }
    result = received(bits, bench=Bench(LinkReceiver(SMALL, 1), kind))
    verdicts = [tick + VERDICT for tick in bits]
    assert high(result, "taken") == verdicts[1:]
    for state in ("linked", "peer_ok"):
        assert high(result, state) == [*range(verdicts[1] + 1, result.end)]
    for name in FIELDS:
        before, first, second = (
            result[f"peer_{name}"].at(tick) for tick in (verdicts[1], verdicts[1] + 1, verdicts[2])
        )
        assert (before, first, second) == (0, sent[1][name], sent[1][name])
        assert result[f"peer_{name}"].at(verdicts[2] + 1) == sent[2][name]
    for name in FORWARDED:
        seen = [int(result[f"new_{name}"].at(tick)) for tick in verdicts[1:]]
        assert seen == [sent[1][name], sent[2][name]]


def test_a_message_is_read_with_the_default_filter_and_bit_too():
    config = Config(outputs=9)
    fields = {"sequence": 0xDEAD_BEEF, "image": 0x155, "codes": 0x2AAAA, "carries": 1}
    starts = (20, 20 + config.link_period_ticks)
    bits = {tick: message(config, 1, number=n, **fields) for n, tick in enumerate(starts)}
    bench = receiver(config, 0)
    result = bench.run(2 * config.link_period_ticks, {"link_rx": line(config, bits)})
    verdict = starts[1] + verdict_ticks(config)
    assert high(result, "taken") == high(result, "fresh_frame") == [verdict]
    assert [result[f"peer_{name}"].at(verdict + 1) for name in fields] == [*fields.values()]


def test_a_message_with_any_one_bit_wrong_is_not_taken():
    for place in range(1, SMALL.layout.message_bits):
        bits = numbered(4, 5, 6, image=2)
        bits[20 + PERIOD][place] ^= 1
        assert told(received(bits)) == {1: {"bad_check"}}


def test_a_start_bit_that_is_none_is_told_in_the_tick_of_its_sample():
    # Its level falls in tick 53, the sample in tick 55 sees it back at 1.
    levels = line(SMALL, {}) | {50: 0, 52: 1}
    result = receiver().run(2000, {"link_rx": levels})
    assert high(result, "bad_check") == [55]


def test_the_own_messages_that_come_back_are_not_taken():
    bits = {20 + place * PERIOD: message(SMALL, 1, number=place) for place in range(3)}
    assert told(received(bits)) == {place: {"bad_check"} for place in range(3)}


@pytest.mark.shows("SYS-5")
def test_a_peer_with_another_configuration_is_not_taken():
    for bit in range(32):
        bits = numbered(4, 5, 6, digest=SMALL.digest ^ 1 << bit)
        assert told(received(bits)) == {place: {"bad_digest"} for place in range(3)}


@pytest.mark.parametrize(
    ("numbers", "expected"),
    [
        ((4, 6, 7), {2: {"taken"}}),
        ((4, 4, 5), {2: {"taken"}}),
        ((4, 3, 2), {}),
        ((4, 7, 9, 255, 0), {4: {"taken"}}),
    ],
)
def test_without_a_link_two_consecutive_messages_are_awaited(numbers, expected):
    assert told(received(numbered(*numbers))) == expected


@pytest.mark.parametrize("step", range(256))
def test_linked_one_to_three_steps_are_taken_and_others_change_nothing(step):
    events = told(received(numbered(200, 201, 201 + step, 202)))
    taken = step in (1, 2, 3)
    assert (events[2] >= {"taken"}) == taken
    assert (events[2] == {"bad_sequence"}) == (not taken)
    assert ("taken" in events[3]) == (not taken)


def after(ticks):
    """Two messages, and a third one with its verdict so many ticks after the second one's."""
    bits = numbered(4, 5)
    bits[20 + PERIOD + ticks] = message(SMALL, 0, number=7)
    return bits, 20 + PERIOD + VERDICT


def test_the_link_is_lost_after_its_time_without_a_message_taken():
    for late in (-1, 0, 1):
        bits, second = after(LOST + late)
        result = received(bits)
        lost = late > 0
        assert high(result, "lost") == ([second + LOST] if lost else [])
        linked = [second + 1] + [second + LOST + 1] * lost
        assert result["linked"].ticks.tolist() == [0, *linked]
        assert high(result, "taken") == [second] + [second + LOST + late] * (not lost)


def test_after_a_loss_two_consecutive_messages_are_awaited_anew():
    bits, _ = after(LOST + 1)
    start = max(bits)
    bits |= {start + PERIOD: message(SMALL, 0, number=8)}
    result = received(bits)
    assert high(result, "taken") == [20 + PERIOD + VERDICT, start + PERIOD + VERDICT]


def test_messages_that_are_not_taken_do_not_keep_the_link():
    bits = numbered(4, 5, 5, 5, 5, 5)
    result = received(bits)
    assert high(result, "lost") == [20 + PERIOD + VERDICT + LOST]


@pytest.mark.shows("DRV-5")
def test_a_boot_is_another_number_than_the_last_one_whether_or_not_the_link_was_lost():
    base = numbered(1, 2, boot=5)
    second = 20 + PERIOD
    for gap, numbers in ((PERIOD, [3]), (LOST + PERIOD, [0, 1])):
        for boot in (5, 5 ^ 0x8000):
            later = {
                second + gap + place * PERIOD: message(SMALL, 0, number=number, boot=boot)
                for place, number in enumerate(numbers)
            }
            result = received(base | later)
            booted = [max(later) + VERDICT] if boot != 5 else []
            assert high(result, "booted") == booted
            assert high(result, "taken")[-1] == max(later) + VERDICT


def test_a_forwarded_frame_is_fresh_once():
    told_of = [
        {"carries": 0, "sequence": 9},
        {"carries": 0, "sequence": 9},
        {"carries": 1, "sequence": 0},  # the first one seen, whatever its number
        {"carries": 1, "sequence": 0},
        {"carries": 1, "sequence": 5},
        {"carries": 0, "sequence": 6},
        {"carries": 1, "sequence": 5},
        {"carries": 1, "sequence": 5, "boot": 1},  # after a boot it is fresh again
        {"carries": 1, "sequence": 5, "boot": 1},
        {"carries": 0, "sequence": 5, "boot": 2},
        {"carries": 1, "sequence": 5, "boot": 2},
    ]
    bits = {
        20 + place * PERIOD: message(SMALL, 0, number=place, **fields)
        for place, fields in enumerate(told_of)
    }
    events = told(received(bits))
    assert [place for place, what in events.items() if "fresh_frame" in what] == [2, 4, 7, 10]
    assert [place for place, what in events.items() if "booted" in what] == [7, 9]


class Peer:
    """The contract of the receiver, one verdict after the other."""

    def __init__(self):
        self.linked = self.is_numbered = self.drifting = False
        self.number = self.taken_at = self.mark = self.window = 0
        self.boot = self.seen = None
        self.events = {name: [] for name in EVENTS}

    def loses(self, tick):
        """What happens before this tick if nothing is taken until then."""
        if self.linked and self.taken_at + LOST < tick:
            self.events["lost"].append(self.taken_at + LOST)
            self.linked = self.is_numbered = False

    def verdict(self, tick, fault, fields):
        self.loses(tick)
        step = (fields["number"] - self.number) % 256
        if fault:
            return self.events[fault].append(tick)
        if self.linked and step not in (1, 2, 3):
            return self.events["bad_sequence"].append(tick)
        takes = self.linked or (self.is_numbered and step == 1)
        self.number, self.is_numbered = fields["number"], True
        if takes:
            self.take(tick, step, fields)
        return None

    def take(self, tick, step, fields):
        self.events["taken"].append(tick)
        if not self.linked:
            self.mark, self.window = tick, 0
        else:
            self.measure(tick, step)
        self.linked, self.taken_at = True, tick
        if self.boot not in (None, fields["boot"]):
            self.events["booted"].append(tick)
            self.seen = None
        self.boot = fields["boot"]
        if fields["carries"] and fields["sequence"] != self.seen:
            self.seen = fields["sequence"]
            self.events["fresh_frame"].append(tick)

    def measure(self, tick, step):
        """`mark` is where the window began, moved on by the periods that have passed."""
        self.mark += step * PERIOD
        self.window += step
        off = abs(tick - self.mark) > SMALL.drift_limit_ticks
        if off:
            self.events["off_frequency"].append(tick)
        if off or self.window >= SMALL.window_messages:
            self.drifting = off
            self.mark, self.window = tick, 0


def random_messages(random, count):
    """Messages by the tick in which they begin, with the fault of each, or none, and its fields."""
    tick, number, rate = 30.0, random.randrange(256), random.choice([0, 0.3, -0.6, 0.8, 3])
    fields = {"boot": 3, "carries": 0, "sequence": 0}
    for _ in range(count):
        number += random.choice([1] * 30 + [0, 2, 3, 4])
        if random.random() < 0.2:
            fields |= {"carries": random.randrange(2), "sequence": random.choice([0, 1, 1 << 31])}
        if random.random() < 0.05:
            fields["boot"] ^= 1 << random.randrange(16)
        fault = random.choice([None] * 30 + ["bad_check", "bad_digest"])
        yield int(tick), fault, fields | {"number": number % 256}
        periods = random.choice([1] * 40 + [0.6, 2, 2.49, 2.5, 2.51, 3])
        tick += periods * (PERIOD + rate) + random.choice([0, 0, 0, 1, -1])


@pytest.mark.parametrize("seed", range(20))
def test_whatever_messages_come_they_are_told_as_the_contract_says(seed):
    random, peer, bits = Random(seed), Peer(), {}
    for start, fault, fields in random_messages(random, 120):
        digest = SMALL.digest ^ (fault == "bad_digest")
        sent = message(SMALL, 0, **fields, digest=digest)
        sent[random.randrange(1, len(sent))] ^= fault == "bad_check"
        bits[start] = sent
        peer.verdict(start + VERDICT, fault, fields)
    end = max(bits) + VERDICT + 2 * LOST
    peer.loses(end)
    result = received(bits, end)
    assert {name: high(result, name) for name in EVENTS} == peer.events
    assert (result["linked"].at(end - 1), result["drifting"].at(end - 1)) == (0, peer.drifting)
