"""The bank against its contract, tick by tick, on random registers, ports and accesses."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railgate.field import Field
from railgate.registers import Access, Block, Gate, Group, Register, identity
from railgate.registers.gateware import Bank
from registers.gateware.reference import Reference, Request
from registers.gateware.requester import simulated

pytestmark = pytest.mark.shows("SYS-1", "ODO-7")


def register(name, access, *fields, **more):
    return Register(name=name, fields=fields, access=access, **more)


def group(name, gate, *fields):
    registers = tuple(register(field.name, Access.READ, field) for field in fields)
    return Group(name=name, description="", registers=registers, gate=gate)


BLOCK = Block(
    name="all_kinds",
    description="every access, every gate, wide and signed fields",
    entries=(
        *identity("TST", 7, 0x1234_5678),
        register("plain", Access.READ, Field("level", 3, ""), Field("speed", 9, "", signed=True)),
        group("strobed", Gate.STROBE, Field("number", 8, ""), Field("wide", 40, "", signed=True)),
        register(
            "control",
            Access.TRIGGER,
            Field("strobe", 1, ""),
            Field("idle", 8, ""),
            Field("go", 12, ""),
        ),
        register("once", Access.READ_TO_CLEAR, Field("came", 12, "")),
        register("marks", Access.WRITE_ONE_TO_CLEAR, Field("hit", 20, "")),
        register(
            "steps",
            Access.WRITE_ONE_TO_CLEAR,
            Field("left_seen", 1, ""),
            Field("right_seen", 1, ""),
            counters=("left", "right"),
        ),
        group(
            "latched",
            Gate.LATCH,
            Field("left", 4, "", start=3),
            Field("right", 33, ""),
        ),
        group("taken", Gate.TAKE, Field("valid", 1, ""), Field("entry", 32, "")),
        register(
            "settings",
            Access.READ_WRITE,
            Field("limit", 10, "", start=77),
            Field("offset", 14, "", signed=True, start=-5),
        ),
    ),
)
STEPPED = ("left", "right")
WORDS = BLOCK.size // 4
FIELDS = BLOCK.fields
INPUTS = {name: FIELDS[name] for name in ("level", "speed", "number", "wide", "came", "hit")}
INPUTS |= {name: FIELDS[name] for name in (*STEPPED, "valid", "entry")}
INPUTS |= {"busy": Field("busy", 1, "")}
OUTPUTS = ("strobe", "idle", "go", "taken_ready", "limit", "offset")


def ran(stimulus):
    """What the bank tells in each tick of this stimulus."""
    bank = Bank(BLOCK)
    record = []

    async def ticks(ctx):
        request, response = bank.bus.request, bank.bus.response
        outputs = {name: getattr(bank, name) for name in OUTPUTS}
        outputs |= {"ready": request.ready}
        outputs |= {name: getattr(response, name) for name in ("valid", "data", "error")}
        waiting = None
        for inputs, wanted in stimulus:
            waiting = waiting or wanted
            for name, value in inputs.items():
                ctx.set(getattr(bank, name), value)
            ctx.set(request.valid, waiting is not None)
            if waiting:
                asked = {"address": waiting.address, "write": waiting.data is not None}
                asked |= {"data": waiting.data or 0, "strobes": waiting.strobes}
                ctx.set(request.payload, asked)
            record.append({name: ctx.get(port) for name, port in outputs.items()})
            if record[-1]["ready"]:
                waiting = None
            await ctx.tick()

    simulated(bank, ticks)
    return record


def stimulus_of(random):
    """Of each of 150 ticks the inputs, and a request that is wanted then, or is not."""
    words = random.choices(range(WORDS), k=random.choice((1, 2, 4, WORDS)))
    busy, events = random.choice((0, 0.3, 0.9)), random.choice((0.02, 0.3, 0.8))
    wishes, writes = random.choice((0.1, 0.8)), random.choice((0.1, 0.5))
    counts = {name: INPUTS[name].start for name in STEPPED}
    ticks = []
    for _ in range(150):
        inputs = {}
        for name, field in INPUTS.items():
            low = -(1 << field.width - 1) if field.signed else 0
            inputs[name] = low + random.getrandbits(field.width)
        inputs |= {name: inputs[name] * (random.random() < events) for name in ("came", "hit")}
        inputs["busy"] = int(random.random() < busy)
        for name in STEPPED:
            step = int(random.random() < events)
            counts[name] = (counts[name] + step) % (1 << INPUTS[name].width)
            inputs[name] = counts[name]
        wanted = None
        if random.random() < wishes:
            address = 4 * random.choice(words) + random.randrange(4)
            data = random.getrandbits(32) if random.random() < writes else None
            wanted = Request(address, data, random.choice((15, random.randrange(16))))
        ticks.append((inputs, wanted))
    return ticks


@settings(max_examples=60, deadline=None)
@given(st.randoms(use_true_random=True))
def test_every_tick_is_as_the_contract_says(random):
    stimulus = stimulus_of(random)
    reference = Reference(BLOCK)
    waiting = None
    for tick, ((inputs, wanted), told) in enumerate(zip(stimulus, ran(stimulus), strict=True)):
        waiting = waiting or wanted
        assert told == reference.tick(inputs, waiting), f"in tick {tick}"
        if told["ready"]:
            waiting = None


def test_every_word_is_reached_by_its_own_address_and_no_other():
    """A block's places cover what the bank answers without an error."""
    there = {
        first // 4 + word: place.register
        for place in BLOCK.places
        for first in (place.offset, place.again)
        if first is not None
        for word in range(place.register.words)
    }
    assert sorted(there) == list(range(BLOCK.words))
    quiet = {name: FIELDS[name].start if name in STEPPED else 0 for name in INPUTS}
    requests = [Request(4 * word, data) for data in (None, 0) for word in range(WORDS)]
    stimulus = [(quiet, request if at == 0 else None) for request in requests for at in range(4)]
    errors = [told["error"] for told in ran(stimulus) if told["valid"]]
    allowed = [
        word in there and getattr(there[word].access, kind)
        for kind in ("reads", "writes")
        for word in range(WORDS)
    ]
    assert errors == [int(not each) for each in allowed]
