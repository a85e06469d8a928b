"""What tests show is read from their text, as pytest understands it."""

from pathlib import Path

import pytest

from railgate.evidence.digests import TESTS
from railgate.evidence.marks import Marks, marked, marks

pytestmark = pytest.mark.shows("SYS-4")

TEXT = """
import pytest

pytestmark = {module}

@pytest.mark.parametrize("n", [1])
{marks}
def test_one(n): ...

def test_other(): ...

def helper(): ...
"""


def read(module: str, marks_: str) -> dict[str, Marks]:
    return dict(marks(TEXT.format(module=module, marks=marks_), Path("test_a.py")))


@pytest.mark.parametrize(
    ("module", "own", "one", "other"),
    [
        ("1", "", ((), False), ((), False)),
        ("1", '@pytest.mark.shows("A-1", "A-2")', (("A-1", "A-2"), False), ((), False)),
        ('pytest.mark.shows("A-1")', "", (("A-1",), False), (("A-1",), False)),
        ("[pytest.mark.shows('A-1'), pytest.mark.slow]", "", (("A-1",), True), (("A-1",), True)),
        ("pytest.mark.slow", '@pytest.mark.shows("A-1")', (("A-1",), True), ((), True)),
        ("1", '@pytest.mark.shows("A-1", kind="sweep")', (("A-1",), True), ((), False)),
        (
            'pytest.mark.shows("A-1")',
            '@pytest.mark.slow\n@pytest.mark.shows("A-2", "A-1")',
            (("A-2", "A-1"), True),
            (("A-1",), False),
        ),
    ],
)
def test_marks_of_a_test_and_of_its_module_add_up(module, own, one, other) -> None:
    assert read(module, own) == {"test_one": Marks(*one), "test_other": Marks(*other)}


def test_a_marker_without_literal_texts_is_refused() -> None:
    with pytest.raises(ValueError, match=r"^test_a\.py:7: shows must be given texts, not ALL$"):
        read("1", "@pytest.mark.shows(ALL)")


def test_they_are_those_that_pytest_collects(request) -> None:
    """Of the files that this session has collected whole."""
    there = marked(TESTS)
    items = {item.nodeid.partition("[")[0]: item for item in request.session.items}
    assert items
    for name, item in items.items():
        found = there.get(name, Marks((), False))
        shown = {each for mark in item.iter_markers("shows") for each in mark.args}
        assert set(found.shows) == shown
        if shown:
            kinds = {mark.kwargs.get("kind") for mark in item.iter_markers("shows")}
            assert found.sweep == ("sweep" in kinds or item.get_closest_marker("slow") is not None)
