"""A folder for what is under way, in the one where it is to be."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

__all__ = ["scratch"]


@contextmanager
def scratch(folder: Path, what: str) -> Iterator[Path]:
    """A hidden folder in `folder`, made where missing, for as long as the block lasts.

    what: is under way, as a part of its name. Raises ValueError for what the block cannot write.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=f".{what}-", dir=folder) as name:
            yield Path(name)
    except OSError as error:
        raise ValueError(f"{folder} cannot be written: {error.strerror}") from None
