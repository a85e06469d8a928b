"""The last results of tests and proofs, kept from run to run."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from railgate.waves import replacing

if TYPE_CHECKING:
    from railgate.proving.result import Result

__all__ = [
    "RESULTS",
    "Case",
    "Proved",
    "Ran",
    "keep_proof",
    "keep_tests",
    "read_proofs",
    "read_tests",
]

T = TypeVar("T")

RESULTS = Path("build/evidence")
"""Where they are kept, in the working folder."""
KEPT_TESTS, KEPT_PROOFS = "tests.json", "proofs.json"


@dataclass(frozen=True)
class Case:
    """One case of a test, run. outcome: passed, failed or skipped. at: its end, Unix time."""

    outcome: str
    seconds: float
    at: float


@dataclass(frozen=True)
class Ran:
    """A test function's last results.

    on: digests of what it was run on. shows: requirements. sweep: it is one. of: how many cases it
    has, 0 while that is not known. cases: those run on just these sources, by their parameters.
    """

    on: Mapping[str, str]
    shows: tuple[str, ...] = ()
    sweep: bool = False
    of: int = 0
    cases: Mapping[str, Case] = field(default_factory=dict)

    def after(self, old: Ran | None) -> Ran:
        """With what was run on the same sources before; what was run on others is void."""
        if old is None or old.on != self.on:
            return self
        return replace(self, of=max(self.of, old.of), cases={**old.cases, **self.cases})


@dataclass(frozen=True)
class Proved:
    """A claim's last result.

    on: digests of what was proven. status: proven, bounded or failed. rejected: how many of its
    mutants were, None where none was tried. at: its end, Unix time.
    """

    on: Mapping[str, str]
    status: str
    seconds: float
    rejected: int | None
    at: float

    def after(self, old: Proved | None) -> Proved:
        """With the mutants that were tried on the same sources before, where none was now."""
        if old is None or old.on != self.on or self.rejected is not None or self.status == "failed":
            return self
        return replace(self, rejected=old.rejected)


def keep_tests(results: Mapping[str, Ran], folder: Path = RESULTS) -> None:
    """Put results of tests, by their names as `tests/odometer/test_spec.py::test_fields`, to those
    in `folder`. Raises ValueError."""
    kept = read_tests(folder)
    now = {name: result.after(kept.get(name)) for name, result in results.items()}
    _write(folder / KEPT_TESTS, {**kept, **now})


def keep_proof(result: Result, on: Mapping[str, str], folder: Path = RESULTS) -> None:
    """Put what a claim's proof came to just now to those in `folder`.

    on: the digests of the sources when it began. Raises ValueError.
    """
    tried = [mutant.rejected for mutant in result.mutants if mutant.rejected is not None]
    rejected = sum(tried) if tried else None
    seconds = round(result.seconds, 2)
    new = Proved({"proven": on["proven"]}, result.status, seconds, rejected, time.time())
    kept, name = read_proofs(folder), result.claim.name
    _write(folder / KEPT_PROOFS, {**kept, name: new.after(kept.get(name))})


def read_tests(folder: Path = RESULTS) -> dict[str, Ran]:
    """What was kept; none where no test has been run. Raises ValueError."""

    def made(given: dict[str, Any]) -> Ran:
        cases = {name: Case(**case) for name, case in given["cases"].items()}
        return Ran(**{**given, "shows": tuple(given["shows"]), "cases": cases})

    return _read(folder / KEPT_TESTS, made)


def read_proofs(folder: Path = RESULTS) -> dict[str, Proved]:
    """What was kept; none where nothing has been proven. Raises ValueError."""
    return _read(folder / KEPT_PROOFS, lambda given: Proved(**given))


def _write(path: Path, results: Mapping[str, Ran | Proved]) -> None:
    told = {name: asdict(results[name]) for name in sorted(results)}
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ValueError(f"{path.parent} cannot be written: {error.strerror}") from None
    with replacing(path) as new:
        new.write_text(json.dumps(told, ensure_ascii=False), encoding="utf-8")


def _read(path: Path, made: Callable[[dict[str, Any]], T]) -> dict[str, T]:
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
        return {name: made(given) for name, given in found.items()}
    except (FileNotFoundError, NotADirectoryError):
        return {}
    except (OSError, ValueError, TypeError, KeyError, AttributeError) as error:
        raise ValueError(f"{path} must hold results as railgate keeps them; remove it") from error
