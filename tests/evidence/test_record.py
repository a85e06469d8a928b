"""What a person reads of the matrix: the table, the page, and JSON."""

import json
import re
from html.parser import HTMLParser

import pytest
from rich.console import Console

from railgate.evidence.matrix import Evidence, Matrix, Row
from railgate.evidence.record import record
from railgate.evidence.requirements import Requirement
from railgate.evidence.table import age, show

pytestmark = pytest.mark.shows("SYS-4")

NOW = 1_800_000_000.0
PASSED = Evidence(
    "test", "tests/test_a.py::test_<b>", "<b> holds", "passed", "3 of 3 cases", NOW - 7200
)
MATRIX = Matrix(
    (
        Row(
            Requirement("ODO-1", "It & that."), (Evidence("gateware", "a.py", "", "cited"), PASSED)
        ),
        Row(
            Requirement("ODO-2", "Half."),
            (PASSED, Evidence("proof", "odometer.x", "It.", "not run")),
        ),
        Row(Requirement("ODO-3", "Nothing."), ()),
        Row(
            Requirement("ODO-4", "Wrong."),
            (Evidence("sweep", "test_c", "", "failed", "1 of 2", NOW),),
        ),
        Row(Requirement("NET-1", "Later.", planned=True), ()),
    ),
    NOW,
)


def test_the_table_tells_counts_age_and_why_it_is_red() -> None:
    console = Console(width=110, force_terminal=False)
    with console.capture() as captured:
        console.print(show(MATRIX))
    text = captured.get()
    assert re.search(r"ODO-1 +It & that\. +green +1 +1 +– +– +2 h", text)
    assert re.search(r"ODO-2 +Half\. +amber +– +1 +0 of 1 +– +2 h", text)
    assert re.search(r"ODO-4 +Wrong\. +red +– +– +– +0 of 1 +now", text)
    assert "ODO-3: nothing shows it\n" in text
    assert "ODO-4: test_c failed\n" in text
    assert "1 green, 1 amber, 2 red, 1 grey" in text


@pytest.mark.parametrize(
    ("seconds", "told"),
    [(0, "now"), (59, "now"), (60, "1 min"), (7199, "1 h"), (86400 * 3, "3 d")],
)
def test_an_age_is_told_in_its_largest_unit(seconds, told) -> None:
    assert age(NOW - seconds, NOW) == told
    assert age(None, NOW) == ""


def test_the_json_file_is_the_matrix(tmp_path) -> None:
    _, path = record(MATRIX, tmp_path / "new")
    told = json.loads(path.read_text(encoding="utf-8"))
    assert {name: row["status"] for name, row in told.items()} == {
        "ODO-1": "green",
        "ODO-2": "amber",
        "ODO-3": "red",
        "ODO-4": "red",
        "NET-1": "grey",
    }
    assert told["ODO-2"]["evidence"] == [
        {
            "kind": "test",
            "name": "tests/test_a.py::test_<b>",
            "says": "<b> holds",
            "result": "passed",
            "told": "3 of 3 cases",
            "age_s": 7200,
        },
        {
            "kind": "proof",
            "name": "odometer.x",
            "says": "It.",
            "result": "not run",
            "told": "",
            "age_s": None,
        },
    ]


class Page(HTMLParser):
    """Its texts, the elements left open, and what it would load."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.texts: list[str] = []
        self.open: list[str] = []
        self.loads: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag, attrs) -> None:
        self.loads += [value for name, value in attrs if name in ("src", "href", "srcset")]
        if tag not in ("meta", "link", "img"):
            self.open.append(tag)

    def handle_endtag(self, tag) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data) -> None:
        self.texts.append(data.strip())


def test_the_page_is_whole_and_by_itself(tmp_path) -> None:
    path, _ = record(MATRIX, tmp_path)
    text = path.read_text(encoding="utf-8")
    page = Page(text)
    assert page.open == []
    assert page.loads == []
    assert "url(" not in text
    assert "@import" not in text
    for row in MATRIX.rows:
        assert f'<details id="{row.requirement.name}" class="{row.status.value}">' in text
        assert row.requirement.sentence in page.texts
        for each in row.evidence:
            assert {each.name, each.says, each.result, each.told} - {""} <= set(page.texts)


def test_a_folder_that_cannot_be_written_is_told(tmp_path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(ValueError, match="cannot be written"):
        record(MATRIX, tmp_path / "file")
