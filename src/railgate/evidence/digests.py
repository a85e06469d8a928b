"""What a result was obtained on: digests of the sources."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from pathlib import Path

import railgate

__all__ = ["PACKAGE", "TESTS", "digests"]

PACKAGE = Path(railgate.__file__).parent
TESTS = PACKAGE.parents[1] / "tests"
"""There in a checkout only."""

ABOVE_PROOFS = ("cli", "doctor.py", "evidence", "fpga")
"""What nothing that is proven imports, as the layers in pyproject.toml have it."""


def digests(package: Path = PACKAGE, tests: Path = TESTS) -> dict[str, str]:
    """`railgate`, of all sources; `proven`, of those that claims can depend on; `tests`, if there.

    Each is that of names and contents; what Python or an editor has put beside the sources does
    not count.
    """
    files = _files(package)
    proven = (file for file in files if file.relative_to(package).parts[0] not in ABOVE_PROOFS)
    found = {"railgate": _digest(package, files), "proven": _digest(package, proven)}
    return found | ({"tests": _digest(tests, _files(tests))} if tests.is_dir() else {})


def _files(folder: Path) -> list[Path]:
    return sorted(
        path
        for path in folder.rglob("*")
        if path.is_file()
        and not any(p.startswith(("__pycache__", ".")) for p in path.relative_to(folder).parts)
    )


def _digest(folder: Path, files: Iterable[Path]) -> str:
    whole = hashlib.sha256()
    for file in files:
        whole.update(file.relative_to(folder).as_posix().encode() + b"\0")
        whole.update(hashlib.sha256(file.read_bytes()).digest())
    return whole.hexdigest()[:16]
