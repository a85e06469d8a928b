"""The evidence as it is gathered, told, drawn and written."""

from __future__ import annotations

import json
import re
from io import StringIO
from pathlib import Path

import pyarrow.parquet
import pytest
import typer
from matplotlib.image import imread
from rich.console import Console
from typer.testing import CliRunner

from railgate.cli.residual import residual_
from railgate.vital_output import residual
from railgate.vital_output.residual import ETHERNET, Comparison, compare, evidence, show
from railgate.vital_output.residual.evidence import RATES
from railgate.vital_output.residual.record import record
from railgate.vital_output.spec import Config

CONFIGS = [Config(), Config(polynomial=ETHERNET)]


def _quick(syndromes, _told=None) -> tuple[int, ...]:
    """In place of a weight distribution, which takes seconds: one of 8 bits passes, of 96."""
    return (1, *(0 for _ in range(7)), 1, *(0 for _ in range(len(syndromes) - 8)))


@pytest.fixture(scope="module")
def quick() -> Comparison:
    """All but the weight distributions."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(evidence, "spectrum", _quick)
        return compare(CONFIGS)


def test_distances_are_told_as_far_as_they_are_counted(quick: Comparison) -> None:
    default, ethernet = quick.codes
    assert [default.distance_at(n) for n in (48, 64, 128, 274, 275)] == ["≥ 8", "8", "8", "8", "6"]
    assert [ethernet.distance_at(n) for n in (91, 128, 274)] == ["8", "7", "5"]
    assert (default.reach, ethernet.reach) == ("274", "91")
    assert (default.sent_bits, default.word_bits) == (96, 160)


def test_what_lines_add_to_the_crc(quick: Comparison) -> None:
    told = [[(c.rank, c.bursts, c.generators[0]) for c in e.carried] for e in quick.codes]
    assert told == [
        [(64, (28, 55), 0), (64, (32, 64), 0), (63, (32, 63), 0)],
        [(64, (30, 63), 0), (32, (32, 32), 64), (64, (32, 64), 0)],
    ]


def test_passing_in_an_hour_is_the_probability_times_the_frames(quick: Comparison) -> None:
    code = quick.codes[0]
    assert code.probability(0.01) == pytest.approx(0.01**8 * 0.99**88, abs=0)
    assert code.per_hour(0.01) == pytest.approx(72_000 * 0.01**8 * 0.99**88, abs=0)
    assert code.greatest[1] == pytest.approx(8 / 96, rel=0.03)
    assert code.greatest[0] == max(map(code.probability, RATES))


def test_the_bound_is_the_crcs_probability_times_what_is_around_passes(quick: Comparison) -> None:
    around = 0.9**448 + 0.1**8 * 0.9**440
    assert quick.bound(quick.codes[0], 0.1) == pytest.approx(0.1**8 * 0.9**88 * around, abs=0)


def test_a_code_that_is_too_large_is_not_counted_and_what_adds_nothing_not_again() -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(evidence, "spectrum", _quick)
        patch.setattr(evidence, "few", lambda *_: None)
        (code,) = compare([Config(outputs=17, polynomial=ETHERNET)]).codes
    assert [carried.spectrum is None for carried in code.carried] == [True, False, True]
    assert code.carried[1].spectrum is code.sent


def test_the_table_says_what_is_exact_and_what_is_bounded(quick: Comparison) -> None:
    printed = StringIO()
    Console(width=110, file=printed).print(show(quick))
    rows = dict(re.findall(r"^ +(\S.*?\S) {3,}(\S.*?) *$", printed.getvalue(), re.M))
    told = {name: re.split(r" {3,}", cells) for name, cells in rows.items()}
    assert told["distance of 274 data bits"] == ["8", "5", "exact, all of ≤ 7 bits"]
    assert told["errors of 1, 2, 3 bits that pass"] == ["0, 0, 0", "0, 0, 0", "exact, all errors"]
    bound = f"≤ {quick.bound(quick.codes[0], 0.01):.2e}"
    assert told["probability at 0.01"] == [bound, bound, "bound"]


def test_the_files_have_the_curves(quick: Comparison, tmp_path: Path) -> None:
    paths = record(quick, tmp_path)
    assert [path.name for path in paths] == ["residual.parquet", "residual.csv", "residual.png"]
    columns = pyarrow.parquet.read_table(paths[0]).to_pydict()
    assert columns["error_rate"] == list(RATES)
    assert columns["0xf4acfb13"] == [quick.codes[0].probability(rate) for rate in RATES]
    assert columns["0x04c11db7 bound"][-1] == quick.bound(quick.codes[1], 0.5)
    picture = imread(paths[2])[..., :3]
    assert picture[5, 5].min() > 0.95  # light
    for colour in ((0x2A, 0x6F, 0xBB), (0xC2, 0x3B, 0x3B)):
        assert (abs(picture * 255 - colour).max(axis=2) < 1).sum() > 1000


def test_the_command_compares_with_ethernets_polynomial(quick, monkeypatch) -> None:
    asked = []
    monkeypatch.setattr(residual, "compare", lambda configs, _: asked.append(configs) or quick)
    app = typer.Typer()
    app.command()(residual_)
    result = CliRunner().invoke(app, ["--outputs", "8", "--polynomial", "0x741b8cd7", "--json"])
    assert result.exit_code == 0
    assert [(c.outputs, c.polynomial) for c in asked[0]] == [(8, 0x741B8CD7), (8, ETHERNET)]
    told = json.loads(result.stdout)
    assert [code["polynomial"] for code in told["codes"]] == ["0xf4acfb13", "0x04c11db7"]
    CliRunner().invoke(app, ["--polynomial", "0x04c11db7"])
    assert len(asked[1]) == 1


def test_a_polynomial_that_is_no_number_is_refused() -> None:
    with pytest.raises(ValueError, match="--polynomial must be a number as 0xf4acfb13, not 'x'"):
        residual_(polynomial="x")


@pytest.mark.slow
def test_the_evidence_of_the_default_frame() -> None:
    told: list[float] = []
    compared = compare(CONFIGS, told.append)
    assert told == sorted(told)
    assert told[-1] <= 1
    default, ethernet = compared.codes
    assert (default.distance, ethernet.distance) == (8, 8)
    # The default's greatest probability lies above 2^-32, Ethernet's does not.
    assert default.greatest[0] * 2**32 == pytest.approx(1.111, abs=1e-3)
    assert ethernet.greatest[0] * 2**32 == pytest.approx(1, abs=1e-9)
    # With the FCS around it, errors in the frame.
    assert [carried.distance for carried in default.carried] == [18, 20, 20]
    assert [carried.distance for carried in ethernet.carried] == [13, 8, 18]
    greatest = [code.carried[0].greatest * 2.0**64 for code in compared.codes]
    assert greatest == pytest.approx([1, 2529], rel=1e-3)
    for code in compared.codes:
        assert code.probability(0.5) * 2**32 == pytest.approx(1)
        assert compared.bound(code, 0.5) * 2.0**64 == pytest.approx(1)
        for rate in RATES:
            assert compared.bound(code, rate) <= code.probability(rate)
