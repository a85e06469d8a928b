"""What is stored, whatever happens: the contract's rules on it, in thousands of ticks."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from random import Random

import pytest

from railgate.vital_output.gateware.storage import Storage
from vital_output.gateware.bench import Bench, pulses, values
from vital_output.gateware.slots import slots
from vital_output.small import SMALL

pytestmark = pytest.mark.shows("DRV-5", "DRV-7", "DRV-15")

LIFE = SMALL.life_cycles
ONES = (1 << SMALL.outputs) - 1
INTERVAL = 3
BOTH = replace(SMALL, zero_at_once=True, error_interval_s=INTERVAL * SMALL.cycle_s)


class Reference:
    """The contract's paragraphs on life, errors, acknowledgement and start, with both options."""

    def __init__(self):
        self.life = self.image = self.stored_index = self.errors = 0
        self.latched = False
        self.acknowledge = self.blocked = ONES

    def tick(self, given):
        life, image = self.life, self.image
        told = {
            "life": life,
            "image": image,
            "acknowledge": self.acknowledge,
            "blocked": self.blocked,
            "latched": self.latched,
            "acknowledged": 0,
            "life_out": False,
            "latches": False,
        }
        own = given["stored"]
        if own:
            told["acknowledged"] = own["acknowledge"] & ~self.acknowledge
            self.acknowledge = own["acknowledge"]
        behind = (self.stored_index - given["decided"]) % 2**32 >= 2**31
        if own:
            self.image, self.life, self.stored_index = own["image"], LIFE, own["index"]
        elif given["decides"] and behind and life:
            self.life -= 1
            if not self.life:
                told["life_out"] = True
                self.image = 0
        for name in ("accepted", "peer_accepted"):
            if given[name] is not None:
                self.image &= given[name]
        if told["acknowledged"]:
            self.latched = False
        if given["rejected"]:
            if self.errors:
                told["latches"] = not self.latched
                self.latched = True
            self.errors = INTERVAL
        elif given["decides"] and self.errors:
            self.errors -= 1
        if self.latched:
            self.image = 0
        if given["booted"]:
            self.blocked = ONES
        elif life:
            self.blocked &= image
        return told


def random_ticks(random, count):
    for _ in range(count):
        images = [random.randrange(ONES + 1) if random.random() < 0.05 else None for _ in range(2)]
        stored = {
            "index": random.choice([3, 4, 5]),
            "sequence": 0,
            "image": random.randrange(ONES + 1),
            "acknowledge": random.randrange(ONES + 1),
        }
        yield {
            "stored": stored if random.random() < 0.1 else None,
            "accepted": images[0],
            "peer_accepted": images[1],
            "decides": random.random() < 0.2,
            "decided": random.choice([2, 3, 4, 5]),
            "rejected": random.random() < 0.06,
            "booted": random.random() < 0.03,
        }


@cache
def bench():
    return Bench(Storage(BOTH))


@pytest.mark.parametrize("seed", range(4))
def test_random_events_have_the_effect_of_the_contract(seed):
    count = 5_000
    ticks = list(random_ticks(Random(seed), count))
    stored = {k: told["stored"] for k, told in enumerate(ticks) if told["stored"]}
    given = {"stored": pulses(list(stored)), **slots("own", stored)}
    for name, image in (("accepted", "accepted_image"), ("peer_accepted", "forwarded_image")):
        given[name] = {k: int(told[name] is not None) for k, told in enumerate(ticks)}
        given[image] = {k: told[name] or 0 for k, told in enumerate(ticks)}
    for name in ("decides", "decided", "rejected", "booted"):
        given[name] = {k: int(told[name]) for k, told in enumerate(ticks)}
    result = bench().run(count, given)
    reference = Reference()
    expected = [reference.tick(told) for told in ticks]
    for name in expected[0]:
        assert values(result, name) == [told[name] for told in expected], name
        assert len({told[name] for told in expected}) > 1
