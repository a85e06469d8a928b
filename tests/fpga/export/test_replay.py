"""Four independent engines, one answer: what is exported does what the model does (SYS-2)."""

from __future__ import annotations

import re

import pytest

from fpga.export.judges import Core, icarus, needs_icarus, verilator
from railgate.engines import open_engine
from railgate.fpga.export import core
from railgate.fpga.export.vectors import vectors
from railgate.waves import Trace

pytestmark = pytest.mark.shows("SYS-2")

FUNCTIONS = ("odometer", "position_link", "vital_output")
QUICK = {"odometer": 40_000, "position_link": 60_000}
"""Ticks that Icarus Verilog replays in a few seconds, with a snapshot, with a delivery."""


def passes(result, name: str, ticks: int) -> None:
    assert result.returncode == 0, result.stdout
    assert f"PASS: {name}, {ticks} ticks" in result.stdout


def whole(made: Core) -> int:
    return int(re.search(r"TICKS = (\d+);", made.text("_tb.sv"))[1])


@needs_icarus
@pytest.mark.parametrize("target", QUICK)
def test_icarus_answers_as_the_model_for_a_while(exported, tmp_path, target) -> None:
    made = exported(target)
    passes(icarus(made, tmp_path, QUICK[target]), made.name, QUICK[target])


@needs_icarus
def test_icarus_answers_as_the_model_of_a_small_channel_that_drives(exported, tmp_path) -> None:
    made = exported("vital_output", small=True)
    passes(icarus(made, tmp_path), made.name, whole(made))


@needs_icarus
def test_a_synchroniser_that_is_a_tick_too_short_is_found(exported, tmp_path) -> None:
    made = exported("odometer")
    text = made.text(".v")
    broken, count = re.subn(
        r"(module \S*input_a\S*synchroniser.*?= rst \? 1'h0 : )stage0;",
        r"\1pin;",
        text,
        count=1,
        flags=re.S,
    )
    assert count == 1
    assert sum(a != b for a, b in zip(text.splitlines(), broken.splitlines(), strict=True)) == 1
    result = icarus(made, tmp_path, QUICK["odometer"], broken)
    assert result.returncode != 0
    assert re.search(r"^tick \d+: sensor__\d__\w+ is \w+, must be \w+$", result.stdout, re.M)
    assert "FAIL: railgate_odometer is not as its model" in result.stdout
    assert "PASS" not in result.stdout


@needs_icarus
def test_vectors_that_are_not_there_are_no_pass(exported, tmp_path) -> None:
    made = exported("odometer")
    assert icarus(made, tmp_path, 10).returncode == 0
    made.file(".vectors").rename(tmp_path / "away")
    try:
        result = icarus(made, tmp_path, 10)
    finally:
        (tmp_path / "away").rename(made.file(".vectors"))
    assert result.returncode != 0
    assert "FAIL: no file" in result.stdout


def first(of: Trace, ticks: int) -> Trace:
    return of.slice(0, min(ticks, of.end))


@pytest.mark.parametrize("engine", ["cxxrtl", "pysim"])
def test_the_engines_answer_as_the_vectors(engine) -> None:
    assert_engine("odometer", engine, 400_000 if engine == "cxxrtl" else 10_000)


@pytest.mark.slow
@pytest.mark.parametrize("engine", ["cxxrtl", "pysim"])
@pytest.mark.parametrize("target", FUNCTIONS)
def test_the_engines_answer_as_the_vectors_of_each_function(target, engine) -> None:
    assert_engine(target, engine, 10**8 if engine == "cxxrtl" else 50_000)


def assert_engine(target: str, engine: str, ticks: int) -> None:
    of = core(target)
    golden = vectors(of)
    piece = first(golden.trace, ticks)
    inputs = piece.select([port.name for port in golden.signals if not port.output])
    outputs = piece.select([port.name for port in golden.signals if port.output])
    found = open_engine(of.design, engine).advance(piece.end, inputs)
    assert outputs.first_difference(found) is None
    assert outputs.signals.keys() == found.signals.keys()


@pytest.mark.slow
@pytest.mark.parametrize("target", FUNCTIONS)
def test_verilator_answers_as_the_model_in_every_tick(exported, tmp_path, target) -> None:
    made = exported(target)
    passes(verilator(made, tmp_path), made.name, whole(made))


@pytest.mark.slow
@needs_icarus
@pytest.mark.parametrize("target", QUICK)
def test_icarus_answers_as_the_model_in_every_tick(exported, tmp_path, target) -> None:
    made = exported(target)
    passes(icarus(made, tmp_path), made.name, whole(made))


@pytest.mark.slow
@needs_icarus
@pytest.mark.parametrize("bus", ["axi4-lite", "wishbone", "local", "uart"])
def test_the_vectors_fit_a_core_with_registers_whose_bus_rests(exported, tmp_path, bus) -> None:
    made = exported("odometer", bus)
    passes(icarus(made, tmp_path, QUICK["odometer"]), made.name, QUICK["odometer"])
