"""An engine is opened by its name, and only then imported."""

from __future__ import annotations

import subprocess
import sys
from fractions import Fraction

import pytest
from amaranth.hdl import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import Out

from railgate.engines import ENGINES, Clock, Design, open_engine
from railgate.waves import Trace


class Counter(wiring.Component):
    def __init__(self) -> None:
        super().__init__({"count": Out(8)})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        m.d.sync += self.count.eq(self.count + 1)
        return m


COUNTER = Design(name="counter", component=Counter, clocks=(Clock(frequency_hz=Fraction(1_000)),))


@pytest.mark.parametrize("kind", ["cxxrtl", "pysim"])
def test_an_engine_is_opened_by_name(kind: str) -> None:
    stimulus = Trace({}, COUNTER.period, 0, 5)
    engine = open_engine(COUNTER, kind)
    assert engine.advance(5, stimulus)["count"].values.tolist() == [0, 1, 2, 3, 4]


def test_leap_is_the_designs_model() -> None:
    stand_in = open_engine(COUNTER, "pysim")
    twin = Design(name="counter", component=Counter, clocks=COUNTER.clocks, model=lambda: stand_in)
    assert open_engine(twin, "leap") is stand_in


def test_what_cannot_be_opened_is_an_error() -> None:
    with pytest.raises(ValueError, match='must be one of leap, cxxrtl, pysim, not "verilog"'):
        open_engine(COUNTER, "verilog")
    with pytest.raises(ValueError, match="counter has no model"):
        open_engine(COUNTER, "leap")
    assert ENGINES == ("leap", "cxxrtl", "pysim")


def test_engines_are_imported_only_when_opened() -> None:
    program = "import sys, railgate.engines; sys.exit('amaranth' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0
