"""Which tests show what, read from their text: no test is imported and none is run.

A test says what it shows by a marker with literal arguments, on itself or, as `pytestmark`, on
its whole module: `@pytest.mark.shows("ODO-6", "ODO-7")`. With `kind="sweep"`, or marked `slow`,
it is a sweep: it goes through very many situations, or all there are.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

__all__ = ["Marks", "marked", "marks"]

SHOWS, SLOW = "pytest.mark.shows", "pytest.mark.slow"


@dataclass(frozen=True)
class Marks:
    """What a test's markers say. shows: requirements, by their names."""

    shows: tuple[str, ...]
    sweep: bool


def marked(tests: Path) -> dict[str, Marks]:
    """The tests in a checkout's folder `tests` that show something, each by a name as
    `tests/odometer/test_spec.py::test_fields`. Raises ValueError where a marker is none."""
    return {
        f"{path.relative_to(tests.parent).as_posix()}::{name}": found
        for path in sorted(tests.rglob("test_*.py"))
        for name, found in marks(path.read_text(encoding="utf-8"), path)
        if found.shows
    }


def marks(text: str, path: Path) -> Iterator[tuple[str, Marks]]:
    """Of each test function in the text of a module. Raises ValueError, with path and line."""
    body = ast.parse(text, path).body
    of_all = [mark for node in body if isinstance(node, ast.Assign) for mark in _of_module(node)]
    for node in body:
        if isinstance(node, ast.FunctionDef) and node.name.startswith("test_"):
            yield node.name, _read([*node.decorator_list, *of_all], path)


def _of_module(node: ast.Assign) -> list[ast.expr]:
    if ast.unparse(node.targets[0]) != "pytestmark":
        return []
    return node.value.elts if isinstance(node.value, ast.List) else [node.value]


def _read(found: list[ast.expr], path: Path) -> Marks:
    shows: list[str] = []
    sweep = False
    for mark in found:
        name = ast.unparse(mark.func if isinstance(mark, ast.Call) else mark)
        sweep |= name == SLOW
        if isinstance(mark, ast.Call) and name == SHOWS:
            shows += [_text(argument, path) for argument in mark.args]
            sweep |= "sweep" in [_text(keyword.value, path) for keyword in mark.keywords]
    return Marks(tuple(dict.fromkeys(shows)), sweep)


def _text(argument: ast.expr, path: Path) -> str:
    if isinstance(argument, ast.Constant) and isinstance(argument.value, str):
        return argument.value
    where = f"{path}:{argument.lineno}"
    raise ValueError(f"{where}: shows must be given texts, not {ast.unparse(argument)}")
