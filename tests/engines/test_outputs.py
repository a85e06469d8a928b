"""Every engine gives just the outputs that are asked for, the same as when all are asked for."""

import pytest

from odometer.stimuli import SMALL, Pins
from railgate.engines import ENGINES, open_engine
from railgate.odometer.design import design
from railgate.odometer.spec import Config
from railgate.waves import Trace

ODOMETER = design(Config(**SMALL))
END = 400


def stimulus() -> Trace:
    pins = Pins()
    for _ in range(30):
        pins.step(10, forward=True)
    signals = {f"sensor.0.{name}": pins.wave(channel) for channel, name in enumerate("ab")}
    return Trace(signals, ODOMETER.period, 0, END)


@pytest.mark.parametrize("kind", ENGINES)
def test_only_the_outputs_asked_for_are_given_and_later_all_again(kind) -> None:
    asked = ["busy", "sensor.0.since_edge"]
    whole, part = open_engine(ODOMETER, kind), open_engine(ODOMETER, kind)
    first = part.advance(200, stimulus(), asked)
    assert list(first.signals) == asked
    assert first == whole.advance(200, stimulus()).select(asked)
    assert part.advance(END, stimulus()) == whole.advance(END, stimulus())
    assert part.advance(END, stimulus(), []).signals == {}


@pytest.mark.parametrize("kind", ENGINES)
def test_an_output_that_is_not_there_is_named_with_those_that_are(kind) -> None:
    engine = open_engine(ODOMETER, kind)
    with pytest.raises(ValueError, match=r'no output "bussy" in \w+; there are: busy'):
        engine.advance(10, stimulus(), ["bussy"])
    assert engine.now == 0
