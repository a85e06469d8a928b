"""`simulate vital`: what it prints, what it writes, how it fails."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from inspect import Parameter, signature
from pathlib import Path

import pyarrow.parquet
import pytest
from typer.models import OptionInfo

from railgate.cli import vital_output
from railgate.vital_output.plant.faults import FAULTS
from railgate.vital_output.situations import SITUATIONS
from railgate.waves import read

Cli = Callable[..., tuple[int, str, str]]

DOCS = (Path(__file__).parents[2] / "docs" / "commands.md").read_text(encoding="utf-8")
PAGE = DOCS.split("## railgate simulate vital\n")[1].split("\n## ")[0]
VITAL = ("simulate", "vital")
SHORT = (*VITAL, "--seconds", "0.4s", "--command", "0x3@200ms", "--command", "0x0@300ms")
DEAD = (*VITAL, "--situation", "cpu-dead")


def test_the_course_of_events_is_printed_and_what_it_comes_to(railgate: Cli) -> None:
    code, out, _ = railgate(*SHORT, "--fault", "repetition-2@350ms")
    assert code == 0
    rows = [re.sub(" +", " ", line).strip() for line in out.splitlines()]
    course = [
        "0.200 000 CPUs command image 0x0003",
        "0.202 012 FPGA 1 frame 2, image 0x0003, accepted",
        "FPGA 1 stored: image 0x0003, life 3",
        "FPGA 1 outputs 0–1: idle → pre-drive",
        "FPGA 1 outputs 0–1: pre-drive → drive, pulses on",
        "relay outputs 0–1: contact closes",
        "0.300 000 CPUs command image 0x0000",
        "FPGA 1 outputs 0–1: drive → wait, pulses off",
        "relay outputs 0–1: contact opens, 70.",
        "FPGA 2 frame 5, image 0x0000, rejected: repetition",
        "no contact was closed longer than declared",
    ]
    at = [next(i for i, row in enumerate(rows) if what in row) for what in course]
    assert at == sorted(at)
    assert "causes: 1 repetition" in out
    assert "declared 258." in out


def test_a_failure_opens_in_less_than_the_declared_time(railgate: Cli) -> None:
    code, out, _ = railgate(*DEAD)
    assert code == 0
    assert re.search(r"\d cycles? alike …", out)
    assert re.search(r"by a failure at most 22\d\.\d{3} ms; by command not seen", out)


def test_a_contact_that_stays_closed_too_long_ends_with_1(railgate: Cli) -> None:
    code, out, _ = railgate(*VITAL, "--situation", "welded-contact")
    assert code == 1
    assert "output 0: contact closed longer than declared" in out
    assert re.search(r"verdict +output 0: closed for \d+\.\d+ ms without a live 1", out)


def test_the_json_object_is_as_documented(railgate: Cli) -> None:
    code, out, _ = railgate(*DEAD, "--json")
    result = json.loads(out)
    assert code == 0
    documented = set(re.findall(r"`(\w+)`", " ".join(re.findall(r"^\| (`.*?) \|", PAGE, re.M))))
    told = result.keys() | result["closings"][0].keys() | result["fpga_1"].keys()
    assert told <= documented
    assert set(result["events"][0]) == {"t_s", "source", "what"}
    assert (result["engine"], result["outputs"], result["safe"]) == ("leap", 16, True)
    assert 0.2 < result["worst_reaction_s"] < result["declared_reaction_s"]
    assert result["fpga_1"]["life_out"] == result["fpga_2"]["life_out"] == 1


def test_situation_and_options_go_together(railgate: Cli) -> None:
    """The situation's commands and faults stay where none are given, faults come on top."""
    options = ("--fault", "deletion-2@250ms", "--ppm-1", "-50", "--ppm-2", "99.5", "--json")
    _, out, _ = railgate(*DEAD, *options)
    result = json.loads(out)
    told = [event["what"] for event in result["events"] if event["source"] == "fault"]
    assert told == [
        "deletion-2: a frame of CPU 2 does not come",
        "cpu-1-dead: CPU 1 sends nothing",
    ]
    assert result["fpga_2"]["lost"] == 1
    _, out, _ = railgate(*DEAD, "--command", "0@0.2s", "--json")
    assert json.loads(out)["closings"] == []


def test_what_is_configured_counts(railgate: Cli) -> None:
    """A shorter life reacts earlier, and less is declared."""
    reactions = []
    for life in ("1", "3"):
        _, out, _ = railgate(*DEAD, "--life", life, "--relay-release", "10ms", "--json")
        result = json.loads(out)
        reactions.append((result["worst_reaction_s"], result["declared_reaction_s"]))
    (short, less), (long, more) = reactions
    assert long - short == pytest.approx(0.1, abs=2e-3)
    assert more - less == pytest.approx(0.1, abs=2e-3)
    assert less - short > 0.04, "the relay opens faster than its --release allows"


def test_a_test_on_demand_and_an_acknowledgement_are_asked_for(railgate: Cli) -> None:
    options = ("--command", "0x1:0x4@200ms", "--test", "250ms", "--seconds", "0.5", "--json")
    _, out, _ = railgate(*VITAL, *options)
    told = [event["what"] for event in json.loads(out)["events"]]
    assert "command image 0x0001, acknowledge 0x0004" in told
    assert "test of the shut-off paths demanded" in told
    assert told.count("test of the shut-off paths: done → requested") == 2
    assert "output 2 acknowledged" in told


def test_out_writes_tables_waves_and_pictures(railgate: Cli, tmp_path: Path) -> None:
    folder = tmp_path / "new" / "out"
    code, out, _ = railgate(*SHORT, "--waves", "190ms..260ms", "--out", str(folder))
    assert code == 0
    names = {"events.parquet", "events.csv", "closings.parquet", "closings.csv"}
    names |= {"vital.vcd", "vital.gtkw", "vital.png", "states.png"}
    assert {path.name for path in folder.iterdir()} == names
    assert all(str(folder / name) in out for name in names)
    events = pyarrow.parquet.read_table(folder / "events.parquet")
    assert events.column_names == ["t_s", "source", "what"]
    assert len((folder / "events.csv").read_text(encoding="utf-8").splitlines()) == (
        1 + events.num_rows
    )
    closings = pyarrow.parquet.read_table(folder / "closings.parquet").to_pylist()
    assert [(each["output"], each["opened_by"]) for each in closings] == (
        [(0, "command"), (1, "command")]
    )
    waves = read(folder / "vital.vcd", ["fpga_1.pulses", "fpga_1.link_tx", "contact"])
    assert waves["fpga_1.pulses"].rising().size == pytest.approx(57, abs=1)
    assert waves["fpga_1.link_tx"].rising().size > 9_000
    assert waves["contact"].values.tolist() == [0, 3]
    for name in ("vital.png", "states.png"):
        assert (folder / name).read_bytes().startswith(b"\x89PNG")


def test_without_waves_the_vcd_has_the_whole_run(railgate: Cli, tmp_path: Path) -> None:
    railgate(*SHORT, "--out", str(tmp_path))
    waves = read(tmp_path / "vital.vcd", ["contact", "fpga_2.states", "line_1.low"])
    assert waves["contact"].values.tolist() == [0, 3, 0]
    text = (tmp_path / "vital.vcd").read_text(encoding="ascii")
    assert "states" in text
    assert "pulses" not in text


def test_the_situations_are_listed(railgate: Cli) -> None:
    code, out, _ = railgate(*VITAL, "--situation", "list")
    assert code == 0
    for name, situation in SITUATIONS.items():
        assert re.search(rf"{name} +{re.escape(situation.does)}", out)
        assert f"| `{name}` | {situation.does} |" in PAGE
    _, out, _ = railgate(*VITAL, "--situation", "list", "--json")
    assert json.loads(out) == {name: each.does for name, each in SITUATIONS.items()}


def test_the_command_has_help_and_a_page_with_its_options(railgate: Cli) -> None:
    code, out, _ = railgate(*VITAL, "--help")
    assert code == 0
    assert "Usage" in out
    parameters = signature(vital_output.simulate_vital, eval_str=True).parameters
    for name, parameter in parameters.items():
        option = next(m for m in parameter.annotation.__metadata__ if isinstance(m, OptionInfo))
        bare = parameter.default in (None, Parameter.empty) or parameter.default is False
        default = "" if bare else f"`{parameter.default}`"
        assert f"| `--{name.replace('_', '-')}` | {default} | {option.help} |" in PAGE


def test_every_kind_of_fault_is_told() -> None:
    for name, kind in FAULTS.items():
        if re.search(r"-2\b", name):
            assert FAULTS[name.replace("-2", "-1")].value == kind.value
        else:
            assert f"| `{name}` | {kind.does} | {kind.value} | {kind.default} |" in PAGE


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--fault", "gone@1s"), "a fault must be one of disagree, skew, switch-over"),
        (("--fault", "welded"), "a fault must be KIND@TIME"),
        (("--fault", "welded@9s"), "must begin before the run's end at 1 s, not at 9 s"),
        (("--fault", "welded:16@0.1s"), "the value of welded must be between 0 and 15, not 16"),
        (("--fault", "cpu-1-dead:3@0.1s"), "cpu-1-dead takes no value, not 3"),
        (("--situation", "fire"), "a situation must be one of good, cpu-dead"),
        (("--command", "0x1"), "--command must be IMAGE[:ACKNOWLEDGE]@TIME, as 0x1@300ms"),
        (("--command", "0x1@soon"), "a number with s, ms, us"),
        (("--command", "0x10000@1s"), "at most 0xffff with 16 outputs, not '0x10000@1s'"),
        (("--command", "1@1s", "--command", "0@1s"), "commands must be in order of time"),
        (("--seconds", "0s"), "seconds must be between"),
        (("--ppm-1", "1e9"), "ppm_1 must be between -100000 and 100000"),
        (("--ppm-2", "nan"), "--ppm-2 must be a finite number, not nan"),
        (("--seed", "-1"), "seed must be between 0"),
        (("--waves", "1s"), "a span T0..T1 is needed, not '1s'"),
        (("--waves", "5s..6s"), "waves must begin inside the run of 1 s, not at 5 s"),
        (("--engine", "steam"), "leap, cxxrtl, pysim"),
        (("--outputs", "65"), "outputs must be between 1 and 64, not 65"),
        (("--clock", "0.5Hz"), "--clock must be a whole number of Hz, not 0.5Hz"),
        (("--clock", "2MHz"), "tau0_s must be above twice the link's latency"),
        (("--cycle", "50.00001ms"), "cycle_s must be a whole number of ticks"),
        (("--cycle", "200ms"), "slew_ticks must be at least the clocks' drift in a cycle, 640"),
        (("--tau1", "1ms"), "tau1_s must cover leaving and deciding"),
        (("--relay-release", "0s"), "release_s must be above 0 and at most 10 s"),
        (("--error-interval", "1ms"), "error_interval_s must be between one cycle and 86400 s"),
        (("--life", "16"), "life_cycles must be between 1 and 15, not 16"),
        (("--out", "/dev/null/x"), "cannot be written"),
    ],
)
def test_a_bad_simulation_is_one_clear_line_and_exit_code_2(
    railgate: Cli, arguments: tuple[str, ...], says: str
) -> None:
    code, out, err = railgate(*VITAL, *arguments)
    assert code == 2
    assert out == ""
    assert says in err
    assert err.startswith("railgate: ")
    assert err.count("\n") == 1
