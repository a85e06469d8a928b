"""What a file of signals may cost its reader."""

from __future__ import annotations

from dataclasses import dataclass, fields

__all__ = ["Limits"]


@dataclass(frozen=True, kw_only=True)
class Limits:
    """Bounds that every reader keeps, so that a damaged or hostile file ends in one clear error.

    file_bytes: of the file itself. metadata_bytes: of headers, names and schemas.
    inflated_bytes: of everything unpacked from it. ratio: inflated to packed bytes of one archive
    entry; 1032 is the most that deflate can reach, an all-zero capture reaches 1000, the idle
    captures of sigrok-dumps 187. entries: of one archive. signals: declared in one file.
    transitions: values kept, of all wanted signals together; one takes about 17 bytes at the peak.
    memory_bytes: address space of the process that reads VCD and FST; Windows has no such bound,
    there a hostile file may take what memory there is. seconds: time that process may take, of
    the processor (not on Windows) and by the clock.
    """

    file_bytes: int = 1 << 34
    metadata_bytes: int = 1 << 24
    inflated_bytes: int = 1 << 38
    ratio: int = 1032
    entries: int = 1 << 14
    signals: int = 100_000
    transitions: int = 50_000_000
    memory_bytes: int = 1 << 33
    seconds: int = 600

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if value < 1:
                raise ValueError(f"{field.name} must be at least 1, not {value}")

    def check(self, name: str, value: int, what: str) -> None:
        """Raises ValueError where `value` of `what` is above the bound called `name`."""
        most = getattr(self, name)
        if value > most:
            raise ValueError(f"{what} must be at most {most} (limit {name}), not {value}")
