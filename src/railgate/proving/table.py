"""Results of proofs, as a table and as files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from railgate.proving.counterexample import waves
from railgate.proving.result import Result
from railgate.waves import write_vcd

__all__ = ["record", "show"]

STYLES = {"proven": "green", "bounded": "yellow", "failed": "red"}


def show(results: Sequence[Result]) -> RenderableType:
    """A line for each claim, then what is to be said of those that are not proven."""
    table = Table(header_style="bold")
    for name in ("claim", "requirements", "method", "status"):
        table.add_column(name, overflow="fold")
    for name in ("seconds", "mutants rejected"):
        table.add_column(name, justify="right")
    for result in results:
        claim = result.claim
        table.add_row(
            claim.name,
            ", ".join(claim.requirements),
            str(claim.method),
            Text(result.status, STYLES[result.status]),
            f"{result.seconds:.1f}",
            _rejected(result),
        )
    return Group(table, *(Text(line) for result in results for line in _remarks(result)))


def _rejected(result: Result) -> str:
    tried = [mutant for mutant in result.mutants if mutant.rejected is not None]
    of = len(result.mutants)
    return f"{sum(m.rejected is True for m in tried)} of {of}" if tried else f"{of} not tried"


def _remarks(result: Result) -> list[str]:
    name = result.claim.name
    lines = [f"{name}: {result.status}: {result.reason}"] if result.reason else []
    missed = [mutant for mutant in result.mutants if mutant.rejected is False]
    return lines + [f"{name}: not rejected: {m.name}: {m.reason}" for m in missed]


def record(result: Result, folder: Path) -> list[Path]:
    """Write a failed claim's counterexample.vcd, or step.vcd, to <folder>/<claim>, if it has one.

    What an earlier run left there goes. Raises ValueError.
    """
    place = folder / result.claim.name
    counterexample, step = place / "counterexample.vcd", place / "step.vcd"
    try:
        for old in (counterexample, step):
            old.unlink(missing_ok=True)
        if result.counterexample is not None:
            place.mkdir(parents=True, exist_ok=True)
            write_vcd(counterexample, waves(result.claim, result.counterexample))
            return [counterexample]
        if result.step is not None:
            place.mkdir(parents=True, exist_ok=True)
            step.write_text(result.step, encoding="utf-8")
            return [step]
    except OSError as error:
        raise ValueError(f"{place} must be a folder to write to: {error.strerror}") from error
    return []
