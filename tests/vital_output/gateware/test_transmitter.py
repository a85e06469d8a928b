"""The cross-link's transmitter, tick by tick on the line."""

from __future__ import annotations

from functools import cache
from random import Random

import pytest

from railgate.vital_output.gateware.crosslink import LinkTransmitter
from railgate.vital_output.spec import Config
from vital_output.gateware.bench import Bench, pulses, values
from vital_output.gateware.messages import levelled, line, message
from vital_output.small import SMALL

pytestmark = pytest.mark.shows("DRV-6")

PERIOD = SMALL.link_period_ticks


@cache
def transmitter(config=SMALL, board=0):
    return Bench(LinkTransmitter(config, board))


@pytest.mark.parametrize(("config", "board"), [(SMALL, 0), (SMALL, 1), (Config(outputs=9), 1)])
def test_each_message_is_on_the_line_in_its_ticks_with_the_fields_of_two_ticks_before(
    config, board
):
    random = Random(board)
    made_there = ("number", "digest", "crc")
    fields = [field for field in config.layout.message if field.name not in made_there]
    begins = [8 + m * config.link_period_ticks for m in range(4)]
    sent = [
        {field.name: random.getrandbits(field.width) for field in fields} | {"boot": 0x1234}
        for _ in begins
    ]
    inputs = {
        field.name: pulses(
            {tick - 2: each[field.name] for tick, each in zip(begins, sent, strict=True)}
        )
        for field in fields
    }
    inputs["boot"] = pulses({0: 0x1234})
    end = begins[-1] + config.link_period_ticks
    result = transmitter(config, board).run(end, inputs)
    bits = {
        begins[number]: message(config, board, number=number, **each)
        for number, each in enumerate(sent)
    }
    assert values(result, "link_tx") == levelled(line(config, bits), end)


def test_messages_are_numbered_modulo_256():
    result = transmitter().run(8 + 258 * PERIOD, {})
    samples = range(1, SMALL.message_ticks, SMALL.bit_ticks)
    for at in (1, 255, 256, 257):
        begins = 8 + at * PERIOD
        sent = result["link_tx"].at([begins + sample for sample in samples]).tolist()
        assert sent == message(SMALL, 0, number=at % 256)


def test_after_a_reset_all_is_sent_as_from_the_start():
    inputs = {"boot": {0: 5, 401: 6, 402: 7}, "image": {0: 1}}
    result = transmitter().run(3000, inputs | {"rst": pulses([400])}, "link_tx")
    before = levelled(line(SMALL, {8: message(SMALL, 0, boot=5, image=1)}), 401)
    anew = [message(SMALL, 0, boot=6, image=1, number=number) for number in (0, 1)]
    after = levelled(line(SMALL, {8: anew[0], 8 + PERIOD: anew[1]}), 3000 - 401)
    assert values(result, "link_tx") == before + after
