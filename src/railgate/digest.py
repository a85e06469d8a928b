"""The digest of a configuration, by which unequal ones are told apart."""

from __future__ import annotations

from dataclasses import fields
from hashlib import sha256
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

__all__ = ["digest"]


def digest(configuration: DataclassInstance) -> int:
    """32 bits of a SHA-256 over all fields of a frozen dataclass (SYS-5)."""
    told = ";".join(
        f"{each.name}={getattr(configuration, each.name)}" for each in fields(configuration)
    )
    return int.from_bytes(sha256(told.encode()).digest()[:4], "big")
