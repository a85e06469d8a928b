"""What the pages show is what happens."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from docs.examples import DOCS, ROOT, document, is_slow, outside

PAGES = sorted(DOCS.rglob("*.md"))
WITH_EXAMPLES = [
    page for page in PAGES if re.search(r"```(python|console)\n", page.read_text("utf-8"))
]
WITH_SLOW = [page for page in WITH_EXAMPLES if "% slow\n" in page.read_text("utf-8")]
COMMANDS = (DOCS / "commands.md").read_text("utf-8")
PLACEHOLDER = re.compile(r"\b(CAPTURE|CH|NAME|KIND|PATH|DIR|SCENARIO|PORT|T0)\b|…|\[")
SLOW = re.compile(r"railgate (residual|prove|evidence)|--engine (cxxrtl|pysim)")
CALLS = [
    call
    for call in re.findall(r"^ {4}(railgate .*)$", COMMANDS, re.M)
    if not PLACEHOLDER.search(call)
]


def name(page: Path) -> str:
    return page.relative_to(DOCS).with_suffix("").as_posix()


@pytest.fixture(autouse=True)
def checkout(tmp_path, monkeypatch) -> None:
    """A folder like the repository's, in which files can be written."""
    for folder in ("src", "tests"):
        (tmp_path / folder).symlink_to(ROOT / folder)
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("page", WITH_EXAMPLES, ids=name)
def test_the_examples_of_a_page_do_as_it_says(page) -> None:
    for example in document(page).examples():
        if not is_slow(example):
            example.evaluate()


@pytest.mark.slow
@pytest.mark.parametrize("page", WITH_SLOW, ids=name)
def test_its_slow_examples_do_too(page) -> None:
    for example in document(page).examples():
        example.evaluate()


@pytest.mark.parametrize("call", [call for call in CALLS if not SLOW.match(call)])
def test_calls_in_the_commands_page_work(call) -> None:
    code, printed = outside(call)
    assert code in (0, 1), printed  # 1 is a result: it was not safe, something is missing


@pytest.mark.slow
@pytest.mark.parametrize("call", [call for call in CALLS if SLOW.match(call)])
def test_slow_calls_in_the_commands_page_work(call) -> None:
    code, printed = outside(call)
    assert code in (0, 1), printed
