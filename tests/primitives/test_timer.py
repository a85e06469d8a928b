"""The one-shot, tick by tick."""

from fractions import Fraction

import pytest

from railgate.engines import Clock, Design
from railgate.engines.pysim import PySim
from railgate.primitives import OneShot
from railgate.waves import Trace, Waveform

END = 40
TRIGGERS = (3, 12, 15, 30, 31)


@pytest.mark.parametrize("ticks", [1, 2, 5, 8])
def test_it_runs_for_its_ticks_after_the_last_trigger(ticks):
    clock = Clock(frequency_hz=Fraction(1))
    design = Design(name="timer", component=lambda: OneShot(ticks), clocks=(clock,))
    levels = [int(tick in TRIGGERS) for tick in range(END)]
    trigger = Waveform.of(range(END), levels)
    result = PySim(design).advance(END, Trace({"trigger": trigger}, Fraction(1), 0, END))
    for tick in range(END):
        since = min((tick - at for at in TRIGGERS if at < tick), default=END)
        remaining = max(ticks + 1 - since, 0)
        assert result["active"].at(tick) == (remaining > 0)
        assert result["remaining"].at(tick) == remaining
