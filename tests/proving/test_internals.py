"""Signals inside a component, by their path."""

from fractions import Fraction

import pytest
from amaranth.back import rtlil

from proving.counting import Counter, NeverAbove
from railgate.engines import Clock, Design
from railgate.engines.pysim import PySim
from railgate.odometer.gateware import Odometer
from railgate.odometer.spec import Config
from railgate.proving import TICK, Internals
from railgate.waves import Trace, Waveform


@pytest.fixture(scope="module")
def inner() -> Internals:
    found = Internals(Odometer(Config(sensors=1, filter_ticks=3)))
    rtlil.convert(found, ports=[])
    return found


@pytest.mark.parametrize(
    ("path", "width"),
    [
        ("sensor.0.a", 1),
        ("sensor.0.position", 32),
        ("sensor_0.ages.age_0", 32),
        ("sensor_0.input_a.held", 2),
        ("sensor_0.input_a.synchroniser.stage0", 1),
        ("sensor_0.steps.a", 1),
        ("sensor_0.watch.run_a", 8),
        ("sensor_0.happened", 12),
        ("sensor_0.period.broken$2", 1),
    ],
)
def test_ports_registers_and_combinational_signals_are_found(inner, path: str, width: int) -> None:
    assert len(inner[path]) == width
    assert path in inner.names


def test_an_unknown_path_is_told_with_the_nearest(inner) -> None:
    with pytest.raises(ValueError, match=r'no signal "sensor_0.ages.age".*ages\.age_0'):
        inner["sensor_0.ages.age"]


def test_each_signal_has_one_path(inner) -> None:
    assert len({id(inner[name]) for name in inner.names}) == len(inner.names)


def test_a_monitor_sees_inner_signals_in_the_simulator() -> None:
    clock = Clock(frequency_hz=Fraction(1_000_000))
    design = Design(name="counting", component=lambda: NeverAbove(3), clocks=(clock,))
    go = Trace({"go": Waveform.of([0], [1], 1)}, TICK, 0, 8)
    result = PySim(design).advance(8, go)
    assert [int(result["holds"].at(tick)) for tick in range(8)] == [1, 1, 1, 1, 0, 0, 1, 1]
    assert result["reached"].rising().tolist() == [5]
    assert result["assumed"].values.tolist() == [1]


def test_the_component_can_be_used_beside_its_internals() -> None:
    counter = Counter()
    inner = Internals(counter)
    assert inner["count"] is counter.count
    inner.elaborate(None)
    rtlil.convert(inner, ports=[counter.go, counter.count])
