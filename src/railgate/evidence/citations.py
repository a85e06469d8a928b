"""Which requirements gateware cites."""

from __future__ import annotations

import re
from collections.abc import Iterator

from railgate.evidence.digests import PACKAGE

__all__ = ["citations"]

GATEWARE = ("primitives/*.py", "*/gateware/*.py")
CITED = re.compile(r"\b([A-Z]{3})-(\d+)(?: … \1-(\d+))?\b")
"""One, or as "DRV-8 … DRV-12" all of them."""


def citations() -> dict[str, list[str]]:
    """File of gateware, as `odometer/gateware/period.py` -> the requirements that it cites."""
    files = sorted(path for pattern in GATEWARE for path in PACKAGE.glob(pattern))
    texts = {path.relative_to(PACKAGE).as_posix(): path.read_text("utf-8") for path in files}
    return {name: list(dict.fromkeys(_cited(text))) for name, text in texts.items()}


def _cited(text: str) -> Iterator[str]:
    for group, first, last in CITED.findall(text):
        yield from (f"{group}-{n}" for n in range(int(first), int(last or first) + 1))
