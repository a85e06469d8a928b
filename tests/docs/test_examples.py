"""What the pages show is what happens."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from sybil.example import SybilFailure

from docs.examples import DOCS, ROOT, document, is_slow, outside

PAGES = sorted(DOCS.rglob("*.md"))
WITH_EXAMPLES = [
    page for page in PAGES if re.search(r"```(python|console)\n", page.read_text("utf-8"))
]
WITH_SLOW = [page for page in WITH_EXAMPLES if "% slow\n" in page.read_text("utf-8")]
COMMANDS = (DOCS / "commands.md").read_text("utf-8")
PLACEHOLDER = re.compile(r"\b(CAPTURE|CH|NAME|KIND|PATH|DIR|SCENARIO|PORT|T0)\b|…|\[|/dev/")
"""Not to be called as it stands."""
ENDLESS = re.compile(r"railgate attach (?!.*--once)")
SLOW = re.compile(
    r"railgate (residual|prove|evidence|fpga|build (?!--list))|--engine (cxxrtl|pysim)|--window"
)
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


@pytest.mark.parametrize("call", [call for call in CALLS if not SLOW.search(call)])
def test_calls_in_the_commands_page_work(call) -> None:
    code, printed = outside(f"{call} --once" if ENDLESS.match(call) else call)
    assert code in (0, 1), printed  # 1 is a result: it was not safe, something is missing


@pytest.mark.slow
@pytest.mark.parametrize("call", [call for call in CALLS if SLOW.search(call)])
def test_slow_calls_in_the_commands_page_work(call) -> None:
    code, printed = outside(call)
    assert code in (0, 1), printed


@pytest.mark.parametrize(
    ("block", "says"),
    [
        ("```console\n$ echo one\ntwo\n```\n", "must print\ntwo\nnot\none"),
        ("```console\n$ false\n```\n", "exit code 1"),
        ("```console\n$ true\n[exit code 1]\n```\n", "exit code 0"),
        ("```console\necho one\n```\n", "a block must begin with $, not 'echo one'"),
        ("```console\n$ true\n$ echo one\ntwo\n```\n", "echo one"),
        ("```python\n>>> 1 + 1\n3\n```\n", "Expected:\n    3\nGot:\n    2"),
    ],
)
def test_an_example_that_does_otherwise_is_found(tmp_path, block, says) -> None:
    page = tmp_path / "page.md"
    page.write_text(f"# Page\n\n{block}", "utf-8")
    (example,) = document(page).examples()
    with pytest.raises(SybilFailure, match=re.escape(says)):
        example.evaluate()


def test_an_example_that_does_so_passes(tmp_path) -> None:
    page = tmp_path / "page.md"
    page.write_text(
        "```console\n$ cat <<END\n> one\n>\n> two\n> END\n...\ntwo\n$ exit 3\n[exit code 3]\n```\n"
    )
    (example,) = document(page).examples()
    example.evaluate()
    assert not is_slow(example)


def test_only_the_example_below_the_line_slow_is_slow(tmp_path) -> None:
    page = tmp_path / "page.md"
    fence = "```console\n$ true\n```\n"
    page.write_text(
        f"{fence}\n% slow\n{fence}\n% slow\n\n```python\n>>> 1\n1\n```\n{fence}", "utf-8"
    )
    assert [is_slow(each) for each in document(page).examples()] == [False, True, True, False]


def test_every_command_on_a_page_is_an_example() -> None:
    """But setting up, which these tests run in the result of."""
    for page in PAGES:
        blocks = re.findall(r"^```(\w+)\n(.*?)^```", page.read_text("utf-8"), re.M | re.S)
        assert {language for language, _ in blocks} <= {"python", "console", "sh", "toml"}
        assert all(text == "make setup\n" for language, text in blocks if language == "sh")
