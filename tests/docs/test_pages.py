"""The site as a whole: it is built without a warning, and says what the code says."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import fields
from html import escape, unescape
from pathlib import Path

import pytest

from docs.examples import DOCS
from railgate.evidence.claims import claims
from railgate.evidence.requirements import REQUIREMENTS
from railgate.unit.config import Unit
from railgate.unit.registers import registers
from railgate.unit.scenario_file import builtins
from sheets.directives import PARTS
from sheets.functions import FUNCTIONS
from sheets.timing import DIAGRAMS

FETCHED = re.compile(r'<(?:script|img|link|source|iframe)\b[^>]*?\b(?:src|href)="(?:https?:)?//')
"""What a browser would fetch of the network."""


def build(source: Path, out: Path) -> subprocess.CompletedProcess[str]:
    """As `make docs` does."""
    command = [sys.executable, "-m", "sphinx", "-qnW", "--keep-going", "-j", "auto"]
    return subprocess.run(
        [*command, "-d", out / "doctrees", source, out / "html"],
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.fixture(scope="module")
def site(tmp_path_factory) -> Path:
    """The site, built once."""
    out = tmp_path_factory.mktemp("docs")
    done = build(DOCS, out)
    assert done.returncode == 0, done.stderr
    return out / "html"


def text(page: Path) -> str:
    """What a person reads of a page."""
    return unescape(re.sub(r"<[^>]+>", "", page.read_text("utf-8")))


def pages(site: Path) -> Iterator[Path]:
    return (site / p.relative_to(DOCS).with_suffix(".html") for p in DOCS.rglob("*.md"))


def test_every_page_is_there_and_needs_no_network(site) -> None:
    for page in pages(site):
        assert not FETCHED.search(page.read_text("utf-8")), page.name


def test_links_between_pages_lead_somewhere(site) -> None:
    for page in pages(site):
        for link in re.findall(r'href="([^"#:]+)(?:#[^"]*)?"', page.read_text("utf-8")):
            assert (page.parent / link.partition("?")[0]).exists(), f"{page.name}: {link}"


@pytest.mark.shows("SYS-1")
@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_data_sheet_has_all_registers_and_numbers_of_its_function(site, name) -> None:
    told, of = text(site / "functions" / f"{name}.html"), FUNCTIONS[name]
    for register in of.registers(of.config).registers:
        assert register.name in told
    for field in fields(of.config):
        assert field.name in told
    for title in ("Timing", "Accuracy", "Ports", "Registers", "Configuration", "Resources"):
        assert title in told


def test_every_diagram_is_on_a_page_in_the_page_s_colours(site) -> None:
    shown = [page.read_text("utf-8") for page in pages(site)]
    for name, make in DIAGRAMS.items():
        assert any(f'aria-label="{escape(make().title)}"' in html for html in shown), name
    assert all("#01010" not in html and "#0202" not in html for html in shown)


def test_reference_pages_have_all_claims_requirements_and_scenarios(site) -> None:
    folder = site / "reference"
    told = text(folder / "claims.html")
    assert all(claim.name in told for claim in claims())
    told = text(folder / "requirements.html")
    assert all(f"{each.name}\n" in told and each.sentence in told for each in REQUIREMENTS)
    assert all(claim.name in told for claim in claims())
    told = text(folder / "scenarios.html")
    assert all(name in told for name in builtins())


def test_every_command_has_its_help(site) -> None:
    told = text(site / "reference" / "help.html")
    for name in re.findall(r"^## railgate (.*)$", (DOCS / "commands.md").read_text("utf-8"), re.M):
        assert f"Usage: railgate {name} " in told


def test_of_single_faults_only_a_welded_contact_stays_closed(site) -> None:
    told = (site / "safety.html").read_text("utf-8")
    rows = [
        text for text in re.findall(r"<tr.*?</tr>", told, re.S) if "stays closed</strong>" in text
    ]
    assert len(rows) == 1
    assert "welded" in rows[0]


@pytest.mark.shows("SYS-1")
def test_the_maps_are_there_for_other_tools(site) -> None:
    for fpga in (1, 2):
        rdl = (site / "maps" / f"fpga_{fpga}.rdl").read_text("utf-8")
        header = (site / "maps" / f"fpga_{fpga}.h").read_text("utf-8")
        for block in registers(Unit(), fpga).blocks.values():
            assert block.name in rdl
            assert block.name.upper() in header.upper()
    first, second = (registers(Unit(), fpga).blocks for fpga in (1, 2))
    assert second.items() <= first.items(), "the pages of FPGA 1 tell of FPGA 2 too"
    assert (site / "maps" / "fpga_1" / "index.html").exists()


@pytest.mark.parametrize(
    ("part", "argument", "says"),
    [
        ("ports", "odometre", "a function must be one of odometer, position_link, vital_output"),
        ("timing", "none", "a diagram must be one of odometer-periods"),
        ("layers", "none", 'no contract of layers is called "none"'),
        ("scenarios", "none", "a scenario must be a file or one of"),
        ("map", "3", "fpga must be 1 or 2, not 3"),
    ],
)
def test_a_part_of_something_that_is_not_there_is_an_error(part, argument, says) -> None:
    with pytest.raises(ValueError, match=says):
        PARTS[part](argument)


def test_an_error_of_a_part_ends_the_build(tmp_path) -> None:
    source = tmp_path / "docs"
    source.mkdir()
    (source / "index.md").write_text("# X\n\n```{ports} odometre\n```\n", "utf-8")
    conf = f'import sys\nsys.path.insert(0, "{DOCS}")\nextensions = ["myst_parser", "sheets"]\n'
    (source / "conf.py").write_text(conf, "utf-8")
    done = build(source, tmp_path)
    assert done.returncode != 0
    assert "a function must be one of" in done.stderr
