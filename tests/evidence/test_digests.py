"""A result is tied to what it was obtained on."""

import pytest

from railgate.evidence.digests import digests

pytestmark = pytest.mark.shows("SYS-4")


@pytest.fixture
def sources(tmp_path):
    """A package and its tests."""
    for name in ("railgate/odometer/spec.py", "railgate/cli/main.py", "tests/test_spec.py"):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("A = 1\n")
    return tmp_path


@pytest.mark.parametrize(
    ("file", "changed"),
    [
        ("railgate/odometer/spec.py", {"railgate", "proven"}),
        ("railgate/odometer/new.py", {"railgate", "proven"}),
        ("railgate/cli/main.py", {"railgate"}),
        ("tests/test_spec.py", {"tests"}),
        ("tests/__pycache__/test_spec.pyc", set()),
        ("tests/.test_spec.py.swp", set()),
    ],
)
def test_a_change_shows_in_just_the_digests_of_what_depends_on_it(sources, file, changed) -> None:
    before = digests(sources / "railgate", sources / "tests")
    path = sources / file
    path.parent.mkdir(exist_ok=True)
    path.write_text("A = 2\n")
    now = digests(sources / "railgate", sources / "tests")
    assert {name for name in before if before[name] != now[name]} == changed


def test_a_file_by_another_name_is_a_change(sources) -> None:
    before = digests(sources / "railgate", sources / "tests")
    (sources / "tests/test_spec.py").rename(sources / "tests/test_other.py")
    assert digests(sources / "railgate", sources / "tests")["tests"] != before["tests"]


def test_without_tests_they_have_no_digest(sources) -> None:
    assert set(digests(sources / "railgate", sources / "none")) == {"railgate", "proven"}
