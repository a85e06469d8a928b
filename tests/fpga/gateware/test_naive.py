"""The naive odometer keeps the contract of the odometer that it is held against."""

from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from odometer.stimuli import SMALL, configs, stimuli
from railgate.engines import Design, Engine, open_engine
from railgate.fpga.gateware import NaiveOdometer
from railgate.odometer.design import design
from railgate.odometer.gateware import Odometer
from railgate.odometer.measure import stimulus
from railgate.odometer.spec import Config
from railgate.waves import Trace, read

CAPTURE = sorted((Path(__file__).parents[2] / "data" / "sigrok").glob("*.sr"))[0]
SMALLS = (
    Config(**SMALL, filter_ticks=0, missing_pulses=3, window_pulses=12),
    Config(**SMALL | {"sensors": 2}, filter_ticks=5, phase_fault_periods=1, window_pulses=1),
)


def naive(config: Config) -> Design:
    return replace(design(config), name="naive", component=lambda: NaiveOdometer(config))


@cache
def opened(config: Config) -> tuple[Engine, Any]:
    engine = open_engine(naive(config), "cxxrtl")
    return engine, engine.checkpoint()


def assert_model(gateware: Engine, config: Config, inputs: Trace) -> None:
    leap = open_engine(design(config), "leap").advance(inputs.end, inputs)
    assert leap.first_difference(gateware.advance(inputs.end, inputs)) is None


@given(stimuli(of=st.sampled_from(SMALLS)))
@settings(max_examples=300, deadline=None)
def test_it_is_the_model_under_any_stimulus(drawn: tuple[Config, Trace]) -> None:
    config, inputs = drawn
    gateware, start = opened(config)
    gateware.restore(start)
    assert_model(gateware, config, inputs)


@given(stimuli(of=configs(stamp_depths=(0,)), end=700))
@settings(max_examples=15, deadline=None)
def test_it_is_the_model_in_any_configuration(drawn: tuple[Config, Trace]) -> None:
    config, inputs = drawn
    assert_model(open_engine(naive(config), "pysim"), config, inputs)


def test_it_is_the_model_on_a_whole_capture() -> None:
    config = Config(sensors=1)
    pins = read(CAPTURE, ["XA", "XB"]).rename({"XA": "a", "XB": "b"})
    inputs = stimulus(pins, config, Fraction(1, 50))
    assert_model(open_engine(naive(config), "cxxrtl"), config, inputs)


def test_its_ports_are_those_of_the_odometer() -> None:
    config = Config(stamp_depth=0)
    assert NaiveOdometer(config).signature.members == Odometer(config).signature.members


def test_it_has_no_stamps() -> None:
    with pytest.raises(ValueError, match=r"^stamp_depth must be 0, not 3$"):
        NaiveOdometer(Config(stamp_depth=3))
