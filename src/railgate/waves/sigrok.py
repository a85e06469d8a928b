"""sigrok session files (.sr, versions 1 and 2).

A zip archive: `version`, `metadata` (INI), and the samples of all logic channels side by side,
`unitsize` bytes a sample, in `logic-1` or in chunks `logic-1-1`, `logic-1-2`, …
Ref: the sigrok wiki's "File format:Sigrok/v1" and "…/v2".
"""

from __future__ import annotations

import io
import re
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from railgate.waves.limits import Limits
from railgate.waves.trace import Trace, absent
from railgate.waves.waveform import Ticks, Waveform

__all__ = ["read_sigrok"]

CHUNK_BYTES = 1 << 22
DIRECTORY_BYTES = 256
"""What an entry of the archive's directory may take on average."""
SAMPLERATE = re.compile(r"(\d{1,18}(?:\.\d{1,18})?)\s*([kmg]?)(?:hz)?", re.IGNORECASE)
FACTORS = {"": 1, "k": 10**3, "m": 10**6, "g": 10**9}


class _Bounded(io.BufferedReader):
    """A file of which no single read, as that of an archive's whole directory, is too large."""

    def __init__(self, path: Path, most: int) -> None:
        super().__init__(io.FileIO(path))
        self.most = max(most, CHUNK_BYTES)

    def read(self, size: int | None = -1, /) -> bytes:
        if size is not None and size > self.most:
            raise ValueError(f"the archive's directory must take at most {self.most} bytes")
        return super().read(size)


@dataclass(frozen=True)
class _Session:
    """What the metadata say: bytes a sample, seconds a sample, and the bit of each channel."""

    unitsize: int
    period: Fraction
    bits: dict[str, int]


def read_sigrok(path: Path, channels: Sequence[str] | None, limits: Limits) -> Trace:
    """The logic channels of a session; one tick is one sample, the first sample is tick 0.

    Contract: railgate.waves.files.read. Samples are streamed: memory grows with the transitions
    of the wanted channels, not with the samples.
    """
    with (
        _Bounded(path, limits.entries * DIRECTORY_BYTES) as file,
        zipfile.ZipFile(file) as archive,
    ):
        entries = archive.infolist()
        limits.check("entries", len(entries), "the number of archive entries")
        if len({entry.filename for entry in entries}) < len(entries):
            raise ValueError("the archive must hold each of its files once, not several times")
        session = _session(archive, limits)
        names = list(session.bits) if channels is None else channels
        for name in names:
            if name not in session.bits:
                raise absent(name, list(session.bits))
        changes = _Changes([session.bits[name] for name in names], limits)
        for samples in _samples(archive, _parts(archive), session.unitsize, limits):
            changes.add(samples)
    return changes.trace(names, session.period)


def _session(archive: zipfile.ZipFile, limits: Limits) -> _Session:
    version = _text(archive, "version", limits).strip()
    if version not in ("1", "2"):
        raise ValueError(f'version must be 1 or 2, not "{version[:20]}"')
    device = _device(_text(archive, "metadata", limits))
    unitsize = _whole(device, "unitsize", 8)
    bits: dict[str, int] = {}
    for key, name in device.items():
        if match := re.fullmatch(r"probe(\d{1,9})", key):
            if not 1 <= int(match[1]) <= 8 * unitsize:
                raise ValueError(f"probes must be numbered 1 to {8 * unitsize}, not {match[1]}")
            if name in bits:
                raise ValueError(f'each probe needs its own name, not twice "{name}"')
            bits[name] = int(match[1]) - 1
    if not bits:
        raise ValueError("metadata must name at least one probe")
    limits.check("signals", len(bits), "the number of probes")
    return _Session(unitsize, 1 / _samplerate(device.get("samplerate", "")), bits)


def _device(text: str) -> dict[str, str]:
    """The keys, in lower case, and values of the metadata's section "device 1"."""
    sections: dict[str, dict[str, str]] = {}
    keys: dict[str, str] | None = None
    for number, line in enumerate(map(str.strip, text.splitlines()), 1):
        if not line or line[0] in "#;":
            continue
        key, equals, value = (part.strip() for part in line.partition("="))
        key = key.lower()
        if line[0] == "[" and line[-1] == "]":
            keys = sections.setdefault(line[1:-1], {})
        elif not equals or keys is None:
            raise ValueError(
                f'metadata must be sections of key=value, not "{line[:40]}" in line {number}'
            )
        elif key in keys:
            raise ValueError(f'metadata must not repeat "{key[:40]}" in line {number}')
        else:
            keys[key] = value
    if "device 1" not in sections:
        raise ValueError('metadata must have a section "device 1"')
    return sections["device 1"]


def _whole(device: Mapping[str, str], key: str, most: int) -> int:
    text = device.get(key, "")
    if not re.fullmatch(r"[0-9]{1,9}", text) or not 1 <= int(text) <= most:
        raise ValueError(f'{key} must be between 1 and {most}, not "{text[:20]}"')
    return int(text)


def _samplerate(text: str) -> Fraction:
    match = SAMPLERATE.fullmatch(text.strip())
    rate = Fraction(match[1]) * FACTORS[match[2].lower()] if match else Fraction(0)
    if not rate:
        raise ValueError(f'samplerate must be a frequency such as 24 MHz, not "{text[:40]}"')
    return rate


def _text(archive: zipfile.ZipFile, name: str, limits: Limits) -> str:
    if name not in archive.NameToInfo:
        raise ValueError(f'the archive must hold a file "{name}"')
    entry = archive.getinfo(name)
    limits.check("metadata_bytes", entry.file_size, f'the size of "{name}" in bytes')
    return b"".join(_inflate(archive, entry, limits)).decode()


def _parts(archive: zipfile.ZipFile) -> list[zipfile.ZipInfo]:
    """The entries that hold the samples, in their order."""
    if "logic-1" in archive.NameToInfo:
        return [archive.getinfo("logic-1")]
    chunks = {}
    for entry in archive.infolist():
        if match := re.fullmatch(r"logic-1-([1-9]\d{0,8})", entry.filename):
            chunks[int(match[1])] = entry
    if not chunks:
        raise ValueError('the archive must hold logic data, "logic-1" or "logic-1-1" and on')
    for number in range(1, max(chunks) + 1):
        if number not in chunks:
            raise ValueError(f'chunk "logic-1-{number}" of {max(chunks)} is missing')
    return [chunks[number] for number in sorted(chunks)]


def _samples(
    archive: zipfile.ZipFile, parts: list[zipfile.ZipInfo], unitsize: int, limits: Limits
) -> Iterator[NDArray[Any]]:
    """The samples, piece by piece, as unsigned integers."""
    inflated = 0
    for part in parts:
        if part.file_size % unitsize:
            raise ValueError(
                f'the size of "{part.filename}" must be a multiple of unitsize, {unitsize}, '
                f"not {part.file_size}"
            )
        inflated += part.file_size
        limits.check("inflated_bytes", inflated, "the size of the logic data in bytes")
        rest = b""
        for piece in _inflate(archive, part, limits):
            piece = rest + piece if rest else piece
            whole = len(piece) - len(piece) % unitsize
            rest = piece[whole:]
            if whole:
                yield _words(np.frombuffer(piece, np.uint8, whole), unitsize)


def _words(data: NDArray[np.uint8], unitsize: int) -> NDArray[Any]:
    size = next(size for size in (1, 2, 4, 8) if unitsize <= size)
    if size > unitsize:
        padded = np.zeros((data.size // unitsize, size), np.uint8)
        padded[:, :unitsize] = data.reshape(-1, unitsize)
        data = padded.reshape(-1)
    return data.view(f"<u{size}")


def _inflate(archive: zipfile.ZipFile, entry: zipfile.ZipInfo, limits: Limits) -> Iterator[bytes]:
    """An entry's content, piece by piece, as long as the directory says and not a byte longer."""
    if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        raise ValueError(
            f'"{entry.filename}" must be stored or deflated, not packed by method '
            f"{entry.compress_type}"
        )
    if entry.file_size > limits.ratio * max(entry.compress_size, 1):
        raise ValueError(
            f'"{entry.filename}" must inflate at most {limits.ratio} times (limit ratio), '
            f"not {entry.compress_size} to {entry.file_size} bytes"
        )
    left = entry.file_size
    with archive.open(entry) as stream:
        while piece := stream.read(CHUNK_BYTES):
            left -= len(piece)
            yield piece
    if left:
        raise ValueError(
            f'"{entry.filename}" must inflate to {entry.file_size} bytes, '
            f"not {entry.file_size - left}"
        )


class _Changes:
    """Collects the ticks at which the bits wanted change."""

    def __init__(self, bits: Sequence[int], limits: Limits) -> None:
        self.bits = bits
        self.limits = limits
        self.ticks: list[list[Ticks]] = [[] for _ in bits]
        self.first: int | None = None
        self.last: NDArray[Any] = np.empty(0, np.uint8)
        self.end = 0
        self.kept = 0

    def add(self, samples: NDArray[Any]) -> None:
        if self.first is None:
            self.first, self.last = int(samples[0]), samples[:1]
        at = np.flatnonzero(samples[1:] != samples[:-1]) + 1
        if samples[0] != self.last[0]:
            at = np.concatenate([[0], at])
        toggled = samples[at] ^ np.concatenate([self.last, samples[at[:-1]]])[: at.size]
        for bit, ticks in zip(self.bits, self.ticks, strict=True):
            mine = at[(toggled >> samples.dtype.type(bit)) & samples.dtype.type(1) != 0]
            if mine.size:
                ticks.append(mine + self.end)
                self.kept += mine.size
        self.limits.check("transitions", self.kept, "the number of transitions")
        self.last = samples[-1:].copy()
        self.end += samples.size

    def trace(self, names: Sequence[str], period: Fraction) -> Trace:
        if self.first is None:
            raise ValueError("the session must hold at least one sample, not none")
        signals = {}
        for name, bit, ticks in zip(names, self.bits, self.ticks, strict=True):
            at = np.concatenate([np.zeros(1, np.int64), *ticks])
            ticks.clear()
            values = np.empty(at.size, np.uint8)
            values[0::2] = self.first >> bit & 1
            values[1::2] = values[0] ^ 1
            signals[name] = Waveform(at, values)
        return Trace(signals, period, 0, self.end)
