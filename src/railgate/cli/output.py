"""What commands print: results, and progress while they are made."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rich.console import Console, RenderableType
from rich.progress import Progress

__all__ = ["counted", "present", "running"]

WIDTH = 110
"""Columns of a table that is not printed to a terminal."""


def present(result: RenderableType | dict[str, Any] | list[Any], paths: Sequence[Path]) -> None:
    """A table and the files that were written; or, of a dict or list, JSON and nothing else."""
    if isinstance(result, dict | list):
        print(json.dumps(result, ensure_ascii=False, allow_nan=False, indent=1))
        return
    console = Console()
    if not console.is_terminal:
        console = Console(width=max(console.width, WIDTH))
    console.print(result)
    for path in paths:
        console.print(f"wrote {path}", soft_wrap=True)


@contextmanager
def running(engine: str) -> Iterator[Callable[[float], None] | None]:
    """A bar on the terminal for the engines that take long; it is told the part done."""
    console = Console(stderr=True)
    if engine == "leap" or not console.is_terminal:
        yield None
        return
    with Progress(console=console, transient=True) as bar:
        task = bar.add_task(f"{engine} runs", total=1.0)
        yield lambda done: bar.update(task, completed=done)


@contextmanager
def counted(what: str, total: int) -> Iterator[Callable[[], None]]:
    """A bar on the terminal that moves on with each call."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield lambda: None
        return
    with Progress(console=console, transient=True) as bar:
        task = bar.add_task(what, total=total)
        yield lambda: bar.advance(task)
