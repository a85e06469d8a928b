"""The cache of compiled designs, and what goes wrong with its folder and its tools."""

from __future__ import annotations

import os
import time
from pathlib import Path

import platformdirs
import pytest

from railgate.engines import Clock, Design
from railgate.engines.compiler import cached, compile_shared
from railgate.engines.native import Native


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(platformdirs, "user_cache_dir", lambda _name: str(tmp_path))
    return tmp_path / "compiled"


def build(made: Path) -> None:
    made.write_bytes(b"no library")


@pytest.mark.usefixtures("folder")
def test_a_build_is_kept_for_its_sources_and_its_compiler(monkeypatch: pytest.MonkeyPatch) -> None:
    entry = cached("one", "sources", build)
    assert cached("one", "sources", build) == entry
    assert cached("one", "other sources", build) != entry
    monkeypatch.setenv("CXX", "c++ -DOTHER")
    assert cached("one", "sources", build) != entry


def test_a_build_drops_what_was_not_used_for_90_days(folder: Path) -> None:
    used, unused = cached("used", "", build), cached("unused", "", build)
    for entry in (used, unused):
        os.utime(entry, (time.time() - 91 * 86400,) * 2)
    assert cached("used", "", build) == used
    new = cached("new", "", build)
    assert set(folder.iterdir()) == {used, new}


def test_an_entry_that_another_process_removes_is_built_anew(folder: Path) -> None:
    entry = cached("one", "", build)
    entry.unlink()
    entry.symlink_to(folder / "gone")  # listed, and not there when it is read
    assert cached("one", "", build).read_bytes() == b"no library"


def test_a_cache_that_cannot_be_made_is_an_error_that_names_it(folder: Path) -> None:
    folder.write_bytes(b"")
    with pytest.raises(ValueError, match=rf"folder to write to, not {folder}: File exists$"):
        cached("one", "", build)


def test_a_compiler_that_is_not_there_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CXX", "nonexistent-c++")
    with pytest.raises(ValueError, match=r"^nonexistent-c\+\+ cannot be run: No such file"):
        compile_shared([], [], tmp_path / "made.so")


def test_what_cannot_be_loaded_is_an_error_in_one_line(folder: Path) -> None:
    design = Design(name="one", component=lambda: None, clocks=(Clock(frequency_hz=1),))
    with pytest.raises(ValueError, match=rf"design cannot be loaded: {folder}.*") as error:
        Native(design, (), {}, cached("one", "", build))
    assert "\n" not in str(error.value)
