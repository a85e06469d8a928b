"""`run` and `scenarios`: what they print, what they write, how they fail."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from inspect import Parameter, signature
from pathlib import Path

import pytest
from typer.models import ArgumentInfo, OptionInfo

from railgate.cli import unit
from railgate.unit.scenario_file import builtins
from railgate.vital_output.verdict import Verdict

Cli = Callable[..., tuple[int, str, str]]

DOCS = (Path(__file__).parents[2] / "docs" / "commands.md").read_text(encoding="utf-8")
SHORT = """
name = "from one platform to the next"
seed = 5

[train]
speed_kmh = 40

[[stop]]
at_m = 0
side = "left"
dwell_s = 8

[[stop]]
at_m = 30
side = "right"
dwell_s = 8
"""


def page(command: str) -> str:
    return DOCS.split(f"## railgate {command}\n")[1].split("\n## ")[0]


@pytest.fixture
def short(tmp_path: Path) -> Path:
    path = tmp_path / "short.toml"
    path.write_text(SHORT, "utf-8")
    return path


def test_a_run_tells_what_happened_and_where_the_report_is(
    railgate: Cli, short: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    code, told, error = railgate("run", str(short), "--out", str(out))
    assert (code, error) == (0, "")
    for words in (
        "output 0: contact closes",
        "leaves the platform at 0 m",
        "output 1: contact closes",
        "from one platform to the next (short), seed 5",
        "outside the interval in 0 of",
        "declared 258.",
        "× real time",
        "safe: no door contact was closed",
        f"wrote {out / 'report.html'}",
    ):
        assert words in re.sub(r"\s*\n\s*", " ", told)
    assert "<!doctype html>" in (out / "report.html").read_text("utf-8")
    assert (out / "waves" / "001.vcd").is_file()
    code, again, _ = railgate("run", str(out / "scenario.toml"), "--out", str(out))
    assert code == 0
    assert re.sub(r"(engine|scenario) .*|wrote .*", "", again) == re.sub(
        r"(engine|scenario) .*|wrote .*", "", told
    )


def test_the_json_object_is_as_documented_and_the_same_again(
    railgate: Cli, short: Path, tmp_path: Path
) -> None:
    results = []
    for folder in ("one", "other"):
        code, told, _ = railgate("run", str(short), "--out", str(tmp_path / folder), "--json")
        assert code == 0
        results.append(json.loads(told))
    rows = " ".join(re.findall(r"^\| (`.*?) \|", page("run"), re.M))
    one, other = results
    assert one.keys() | one["events"][0].keys() <= set(re.findall(r"`(\w+)`", rows))
    assert (one["scenario"], one["engine"], one["seed"], one["safe"]) == ("short", "leap", 5, True)
    assert one["speed_interval_violations"] == 0
    assert abs(one["distance_error_m"]) < 0.1
    factor = one["seconds"] / sum(one["spent_s"].values())
    assert one["real_time_factor"] == pytest.approx(factor)
    timing = ("real_time_factor", "spent_s")
    assert {k: v for k, v in one.items() if k not in timing} == {
        k: v for k, v in other.items() if k not in timing
    }


def test_a_run_that_was_not_safe_ends_with_1(
    railgate: Cli, short: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With a reaction time that no relay keeps: each release is then too long at its end."""
    late = property(lambda told: told.closings)
    monkeypatch.setattr(Verdict, "violations", late)
    code, told, _ = railgate("run", str(short), "--out", str(tmp_path / "out"))
    assert code == 1
    assert "not safe: left doors: the contact stayed closed" in told
    page_told = (tmp_path / "out" / "report.html").read_text("utf-8")
    assert "<strong>Not safe.</strong>" in page_told


def test_scenarios_are_listed(railgate: Cli) -> None:
    code, told, _ = railgate("scenarios")
    assert code == 0
    for name in builtins():
        assert name in told
    code, told, _ = railgate("scenarios", "--json")
    listed = json.loads(told)
    assert [each["scenario"] for each in listed] == list(builtins())
    text = page("scenarios")
    assert listed[0].keys() <= set(re.findall(r"`(\w+)`", text))


@pytest.mark.parametrize(
    ("arguments", "error"),
    [
        (("nowhere",), 'a scenario must be a file or one of .*, not "nowhere"'),
        (("{short}", "--engine", "abacus"), "abacus"),
        (("{short}", "--out", "{short}/out"), "cannot be written"),
        (("{wrong}",), r"wrong\.toml:\d+: .*speed_kmh"),
        (("{binary}",), "a scenario must be text in UTF-8"),
        (("{folder}",), "Is a directory"),
    ],
)
def test_a_wrong_input_is_one_line_and_exit_code_2(
    railgate: Cli, short: Path, tmp_path: Path, arguments: tuple[str, ...], error: str
) -> None:
    wrong, binary = tmp_path / "wrong.toml", tmp_path / "binary.toml"
    wrong.write_text(SHORT.replace("= 40", "= 4000"), "utf-8")
    binary.write_bytes(b"\xff\xfe\x00")
    names = {"short": short, "wrong": wrong, "binary": binary, "folder": tmp_path}
    given = [argument.format(**names) for argument in arguments]
    out = [] if "--out" in given else ["--out", str(tmp_path / "out")]
    code, told, line = railgate("run", *given, *out)
    assert (code, told) == (2, "")
    assert re.fullmatch(f"railgate: .*{error}.*\n", line)


def test_every_option_is_documented() -> None:
    for command, run in (("run", unit.run_), ("scenarios", unit.scenarios_)):
        for name, parameter in signature(run, eval_str=True).parameters.items():
            told = next(
                each
                for each in getattr(parameter.annotation, "__metadata__", ())
                if isinstance(each, OptionInfo | ArgumentInfo)
            )
            default = parameter.default
            assert default is not Parameter.empty
            option = "SCENARIO" if isinstance(told, ArgumentInfo) else f"--{name}"
            shown = "" if default in (None, False) else f"`{default}`"
            row = f"| `{option}` | {shown} | {told.help} |".replace("|  |", "|  |")
            assert row in page(command), row
