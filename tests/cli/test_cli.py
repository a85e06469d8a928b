"""The command line: what it prints, what it writes, and how it fails."""

import json
import re
from dataclasses import replace
from inspect import Parameter, signature
from pathlib import Path

import pyarrow.parquet
import pytest
from typer.models import OptionInfo

from proving.counting import NeverAbove, claim
from railgate.cli import (
    attach,
    build,
    evidence,
    export,
    fpga,
    odometer,
    position_link,
    proofs,
    registers,
    residual,
    vital_output,
)
from railgate.odometer.spec import Flag
from railgate.position_link.plant import FAULTS
from railgate.position_link.spec import Cause
from railgate.waves import read

HERE = Path(__file__).parent.parent
DATA = HERE / "data" / "sigrok"
FAST = str(DATA / "avago_adns_2051_move_mouse_fast.sr")
DOCS = (HERE.parent / "docs" / "commands.md").read_text(encoding="utf-8")


def test_measure_prints_a_table_and_a_summary(railgate) -> None:
    code, out, _ = railgate("measure", FAST, "--a", "XA", "--b", "XB")
    assert code == 0
    for word in ("km/h", "direction", "rising edges", "quarter pitches", "resting on"):
        assert word in out


def test_json_is_one_object_as_documented(railgate) -> None:
    code, out, _ = railgate("measure", FAST, "--a", "XA", "--b", "XB", "--json")
    result = json.loads(out)
    assert code == 0
    documented = set(re.findall(r"`(\w+)`", " ".join(re.findall(r"^\| (`.*?) \|", DOCS, re.M))))
    flags = {flag.name.lower() for flag in Flag if flag.name}
    assert flags <= documented, "every flag has its line in docs/commands.md"
    assert result.keys() | result["windows"][0].keys() <= documented
    assert {
        "engine clock_hz duration_s a_rising b_rising position_x4 direction_changes "
        "illegal_transitions rejected_glitches distance_m windows"
    } <= {" ".join(k for k in result if k not in ("estimator", "guarantee", "rests_on"))}
    raised = {flag for window in result["windows"] for flag in window["flags"]}
    assert raised <= documented


def test_leap_and_cxxrtl_print_the_same_object(railgate) -> None:
    results = []
    for engine in ("leap", "cxxrtl"):
        arguments = ("--window", "1s..1.2s", "--engine", engine, "--json")
        _, out, _ = railgate("measure", FAST, "--a", "YA", "--b", "YB", *arguments)
        results.append({**json.loads(out), "engine": ""})
    assert results[0] == results[1]


def test_out_writes_tables_waves_and_a_picture(railgate, tmp_path) -> None:
    folder = tmp_path / "new" / "out"
    code, out, _ = railgate("measure", FAST, "--a", "XA", "--b", "XB", "--out", str(folder))
    assert code == 0
    names = {"windows.parquet", "windows.csv", "gateware.vcd", "gateware.gtkw", "speed.png"}
    assert {path.name for path in folder.iterdir()} == names
    assert all(str(folder / name) in out for name in names)
    rows = pyarrow.parquet.read_table(folder / "windows.parquet")
    assert rows.num_rows == 250
    assert len((folder / "windows.csv").read_text(encoding="utf-8").splitlines()) == 251
    waves = read(folder / "gateware.vcd", ["sensor.0.a", "sensor.0.a_rising"])
    assert waves["sensor.0.a"].rising().size == waves["sensor.0.a_rising"].values[-1] == 143
    assert (folder / "speed.png").read_bytes().startswith(b"\x89PNG")


def test_simulate_shows_the_truth(railgate) -> None:
    code, out, _ = railgate(
        *("simulate", "odometer", "--profile", "constant"),
        *("--seconds", "1", "--speed", "80", "--json"),
    )
    assert code == 0
    windows = json.loads(out)["windows"]
    assert all(w["true_speed_kmh"] == pytest.approx(80) for w in windows)
    assert all(w["speed_low_kmh"] <= 80 <= w["speed_high_kmh"] for w in windows[1:])


def test_simulate_takes_a_profile_from_a_file(railgate, tmp_path) -> None:
    profile = tmp_path / "profile.csv"
    profile.write_text("time_s,speed_kmh\n0,0\n20,72\n")
    code, out, _ = railgate("simulate", "odometer", "--profile", str(profile), "--json")
    assert code == 0
    assert json.loads(out)["distance_m"] == pytest.approx(200, abs=0.01)


@pytest.fixture
def claimed(monkeypatch) -> None:
    """Two claims of a counter, of which one is wrong."""
    right, wrong = claim(NeverAbove), claim(lambda: NeverAbove(3))
    there = (replace(right, name="counter.right"), replace(wrong, name="counter.wrong", fast=False))
    monkeypatch.setattr("railgate.evidence.claims.claims", lambda: there)


@pytest.mark.usefixtures("claimed")
def test_prove_prints_a_table_and_ends_with_1_where_a_claim_fails(railgate, tmp_path) -> None:
    code, out, _ = railgate("prove", "--out", str(tmp_path))
    assert code == 1
    assert re.search(r"counter\.right .* ODO-9 .* induction, k = 1 .* proven", out)
    assert "counter.wrong: failed: holds is 0 in tick 4" in out
    found = tmp_path / "counter.wrong" / "counterexample.vcd"
    assert f"wrote {found}" in out
    again = railgate("prove", "counter.wrong", "--replay", str(found))
    assert again == (1, "counter.wrong: holds is 0 in tick 4\n", "")
    again = railgate("prove", "counter.right", "--replay", str(found))
    assert again == (0, "counter.right: holds throughout\n", "")


@pytest.mark.usefixtures("claimed")
def test_prove_prints_an_array_as_documented(railgate, tmp_path) -> None:
    code, out, _ = railgate("prove", "--fast", "--json", "--out", str(tmp_path))
    (result,) = json.loads(out)
    assert code == 0
    assert (result["name"], result["status"], result["bound"]) == ("counter.right", "proven", None)
    assert result["mutants"] == [{"name": n, "rejected": None} for n in ("one", "two")]
    page = DOCS.partition("## railgate prove")[2].partition("## railgate doctor")[0]
    assert result.keys() <= set(re.findall(r"`(\w+)`", page.partition("| name |")[2]))


@pytest.mark.usefixtures("claimed")
def test_prove_with_mutants_fails_where_one_passes(railgate, tmp_path) -> None:
    code, out, _ = railgate("prove", "counter.right", "--mutants", "--out", str(tmp_path))
    assert code == 1
    assert "counts as unproven: one, two not rejected" in out
    assert "0 of 2" in out


@pytest.mark.usefixtures("claimed")
def test_nothing_to_prove_is_no_success(railgate) -> None:
    code, out, err = railgate("prove", "counter.wrong", "--fast")
    assert (code, out, err) == (2, "", "railgate: --fast leaves no claim to prove\n")


def test_doctor_finds_every_engine_running(railgate) -> None:
    code, out, _ = railgate("doctor")
    assert code == 0
    for engine in ("leap", "cxxrtl", "pysim"):
        assert re.search(rf"engine {engine}\W+runs", out)


COMMANDS = {
    ("measure",): odometer.measure_,
    ("simulate", "odometer"): odometer.simulate_odometer,
    ("simulate", "link"): position_link.simulate_link,
    ("decode",): position_link.decode_,
    ("simulate", "vital"): vital_output.simulate_vital,
    ("residual",): residual.residual_,
    ("prove",): proofs.prove_,
    ("evidence",): evidence.evidence_,
    ("attach",): attach.attach_,
    ("build",): build.build_,
    ("fpga", "report"): fpga.report_,
    ("registers",): registers.registers_,
    ("export",): export.export_,
}
ELSEWHERE = {("simulate", "odometer"): ("measure",), ("decode",): ("simulate", "link")}
"""Where the options that a command shares with another are told."""


@pytest.mark.parametrize("command", [*COMMANDS, ("doctor",)], ids=" ".join)
def test_every_command_has_help_and_a_page(railgate, command) -> None:
    code, out, _ = railgate(*command, "--help")
    assert code == 0
    assert "Usage" in out
    assert f"## railgate {' '.join(command)}\n" in DOCS


def page(command: tuple[str, ...]) -> str:
    return DOCS.split(f"## railgate {' '.join(command)}\n")[1].split("\n## ")[0]


@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_the_tables_of_options_are_those_of_the_command(command) -> None:
    told = page(command) + (page(ELSEWHERE[command]) if command in ELSEWHERE else "")
    for name, parameter in signature(COMMANDS[command], eval_str=True).parameters.items():
        option = next(m for m in parameter.annotation.__metadata__ if hasattr(m, "help"))
        if isinstance(option, OptionInfo) and name != "jobs":
            bare = parameter.default in (None, Parameter.empty) or parameter.default is False
            default = "" if bare else f"`{parameter.default}`"
            row = f"| `--{name.replace('_', '-')}` | {default} | {option.help} |"
            assert row in told


def test_every_kind_of_fault_and_every_cause_is_told() -> None:
    told = page(("simulate", "link"))
    for name, kind in FAULTS.items():
        assert f"| `{name}` | {kind.does} | {kind.value} | {kind.default} |" in told
    for cause in Cause:
        assert f"`{cause.name.lower()}`" in told


def test_a_run_beyond_the_assumed_acceleration_is_named(railgate) -> None:
    _, _, err = railgate("simulate", "odometer", "--profile", "ramp", "--seconds", "5", "--json")
    assert err == (
        "railgate: the run accelerates at up to 11.11 m/s², above the 1.5 m/s² assumed "
        "(--acceleration-max)\n"
    )


MEASURE = ("measure", FAST, "--a", "XA", "--b", "XB")


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("fly",), "No such command 'fly'"),
        (("measure",), "Missing argument"),
        (("measure", "none.sr", "--a", "XA", "--b", "XB"), "none.sr: no such file"),
        (("measure", FAST, "--a", "XA", "--b", "ZB"), 'no channel "ZB"; there are: SCLK, XA, XB'),
        ((*MEASURE, "--clock", "16MB"), "a number with Hz, kHz, MHz, GHz is needed, not '16MB'"),
        ((*MEASURE, "--clock", "0.5Hz"), "whole number of Hz"),
        ((*MEASURE, "--every", "0s"), "at least 16 ticks"),
        ((*MEASURE, "--every", "-1s"), "at least 16 ticks"),
        ((*MEASURE, "--window", "4..9"), "inside the capture, 0 s..5 s, not 4 s..9 s"),
        ((*MEASURE, "--filter", "70000"), "filter_ticks must be between 0 and 65535, not 70000"),
        ((*MEASURE, "--filter", "1400"), "at most 1335, not 1400"),
        ((*MEASURE, "--filter", "few"), "--filter"),
        ((*MEASURE, "--wheel-diameter", "0mm"), "wheel_diameter_m must be between"),
        ((*MEASURE, "--engine", "steam"), "leap, cxxrtl, pysim"),
        ((*MEASURE, "--estimator", "guess"), "period, pi, omega, feasible"),
        ((*MEASURE, "--crystal-ppm", "-1"), "crystal_ppm must be between 0 and 10000, not -1"),
        ((*MEASURE, "--overspeed-kmh", "nan"), "--overspeed-kmh must be a finite number, not nan"),
        ((*MEASURE, "--clock", "10kHz"), "at least 8 ticks of clock_hz, not 1"),
        (("simulate", "odometer", "--speed", "1e9"), "at most 10000000 pitches long"),
        ((*MEASURE, "--out", "/dev/null/x"), "cannot be written"),
        (("simulate", "odometer", "--profile", "fall"), "constant, ramp, run, shuttle or a file"),
        (("simulate", "odometer", "--seconds", "0"), "seconds must be above 0"),
        (("simulate", "odometer", "--duty", "2"), "duty must be between"),
        (("prove", "odometre"), 'no claim "odometre"; there are: odometer.'),
        (("prove", "odometer.inputs", "--solver", "guess"), 'yices, z3, not "guess"'),
        (("prove", "odometer.inputs", "--timeout", "0s"), "must be above 0 s, not 0"),
        (("prove", "odometer.inputs", "--replay", FAST), "--replay needs one claim, not 2"),
        (("prove", "odometer.inputs-reject", "--replay", FAST), 'no channel "pin"'),
    ],
)
def test_a_bad_call_is_one_clear_line_and_exit_code_2(railgate, arguments, says) -> None:
    code, out, err = railgate(*arguments)
    assert code == 2
    assert out == ""
    assert says in err
    assert err.startswith("railgate: ")
    assert err.count("\n") == 1
