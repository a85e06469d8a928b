"""Reading VCD and FST, through pywellen.

pywellen reads in a process of its own: on damaged files it panics, prints, or asks for so much
memory that the process is aborted, and none of this may reach the caller. What it passes over in
silence (times that fall, negative times, the last time stamp) is looked up in the file here.
"""

from __future__ import annotations

import json
import os
import re
import signal
import struct
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from fractions import Fraction
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from railgate.waves.limits import Limits
from railgate.waves.parquet import read_parquet, write_parquet
from railgate.waves.trace import Trace, absent, rescale
from railgate.waves.vcd import SCOPE, TICK_NOTE
from railgate.waves.waveform import MAX_WIDTH, Ticks, Waveform

__all__ = ["decode", "read_wellen"]

BLOCK = 1 << 16
BLOCK_BYTES = 1 << 22
CHILD = "from railgate.waves.wellen import _child; _child()"
TIME = re.compile(
    rb"""(?: \s++
        | [bBrRsS]\S*+ \s++ \S++ (?=\s)         # its identifier may look like a time stamp
        | \$comment\s (?s:.*?) \$end (?=\s)
        | \#(?!-?[0-9]++\s) \S*+ (?=\s)
        | (?!\$comment\s) [^\s\#bBrRsS]\S*+ (?=\s)
    )* (?: \#(-?[0-9]++) (?=\s) )?""",
    re.VERBOSE,
)
"""All whole items up to a time stamp, and it; without one, all there are.

It never tracks back, since its end is optional. Only single characters are possessive: with a
group that itself tracks back Python before 3.11.5 can miss a match (CPython issue 106052).
"""
NOTE = re.compile(TICK_NOTE.format(r"([0-9]{1,40}(?:/[0-9]{1,40})?)").encode())


def read_wellen(path: Path, channels: Sequence[str] | None, limits: Limits) -> Trace:
    """The signals of a VCD or FST file.

    Contract: railgate.waves.files.read. A tick is the file's timescale, or what `write_vcd` noted.
    Scopes and name are joined by dots; the bare name will do where only one signal has it.
    None of `channels` takes every signal of 1 to 64 bits. The trace begins at the first tick at
    which every signal taken has a value of zeros and ones; any x or z after that is an error. It
    ends one tick after the file's last time stamp; where `write_vcd` wrote the file, at it. A
    packed FST, which hides that stamp, is refused.
    """
    with tempfile.TemporaryDirectory() as folder:
        result = Path(folder) / "trace"
        order = json.dumps(
            {
                "path": str(path.resolve()),
                "result": str(result),
                "channels": channels,
                "limits": asdict(limits),
            }
        )
        try:
            done = subprocess.run(
                [sys.executable, "-P", "-c", CHILD],
                input=order,
                capture_output=True,
                text=True,
                errors="replace",
                env={**os.environ, "RUST_BACKTRACE": "0"},
                timeout=limits.seconds,
                check=False,
            )
        except subprocess.TimeoutExpired:
            raise _late(limits) from None
        if done.returncode == -getattr(signal, "SIGXCPU", 0) < 0:
            raise _late(limits)
        if done.returncode == 2:
            raise ValueError(done.stderr.strip().splitlines()[-1])
        if done.returncode:
            raise ValueError(
                f"the file is damaged, or needs more than {limits.memory_bytes} bytes of memory "
                f"(limit memory_bytes)"
            )
        return read_parquet(result, None, limits)


def _late(limits: Limits) -> ValueError:
    return ValueError(f"reading must take at most {limits.seconds} s (limit seconds)")


def _child() -> None:
    """What the process of its own does: reads, and writes the trace as Parquet."""
    order = json.load(sys.stdin)
    limits = Limits(**order["limits"])
    try:
        import resource

        for kind, most in (
            (resource.RLIMIT_AS, limits.memory_bytes),
            (resource.RLIMIT_CPU, limits.seconds),
            (resource.RLIMIT_CORE, 0),
        ):
            hard = resource.getrlimit(kind)[1]
            resource.setrlimit(kind, (most if hard < 0 else min(most, hard), hard))
    except ImportError:  # Windows has no such limits
        pass
    try:
        write_parquet(order["result"], decode(Path(order["path"]), order["channels"], limits))
    except MemoryError:
        sys.exit(3)
    except BaseException as error:  # a panic of pywellen is no Exception
        print("\n" + (" ".join(str(error).split()) or type(error).__name__), file=sys.stderr)
        sys.exit(2)


class _Frame(NamedTuple):
    """First and last time stamp of a file, and the tick's period where it is noted."""

    first: int
    last: int
    period: Fraction | None


def decode(path: Path, channels: Sequence[str] | None, limits: Limits) -> Trace:
    """`read_wellen` in this process; only for files known to be sound."""
    with path.open("rb") as file:
        head = file.read(25)
    frame = _fst_frame(head) if head[:1] in (b"\0", b"\xfe") else _vcd_frame(path, limits)
    import pywellen  # 30 MB that only the process of its own shall load

    waves = pywellen.Waveform(str(path))
    unit = _unit(waves.timescale)
    period = frame.period or unit
    chosen = _chosen(waves, channels, frame.period is not None, limits)
    loaded = {name: variable.signal for name, variable in chosen.items()}
    limits.check("transitions", sum(map(len, loaded.values())), "the number of transitions")
    signals = {}
    for name, variable in chosen.items():
        times, bits = _known(name, loaded.pop(name), unit)
        signals[name] = _waveform(variable, _ticks(times, period / unit), bits)
    stamps = _ticks(np.array([frame.first, frame.last]), period / unit)
    start = max(int(stamps[0]), *(int(wave.ticks[0]) for wave in signals.values()))
    closed = int(stamps[1]) + (frame.period is None)
    end = max(closed, *(int(wave.ticks[-1]) + 1 for wave in signals.values()))
    return Trace({n: wave.slice(start, end) for n, wave in signals.items()}, period, start, end)


def _fst_frame(head: bytes) -> _Frame:
    """From the header block."""
    if head[:1] == b"\xfe":
        raise ValueError("an FST must not be packed (block 254); fst2vcd makes a VCD of it")
    if len(head) < 25:
        raise ValueError("the file's header is cut short")
    first, last = struct.unpack(">QQ", head[9:25])
    return _Frame(first, last, None)


def _vcd_frame(path: Path, limits: Limits) -> _Frame:
    """From the header's comment and from the time stamps."""
    first, last = None, 0
    with path.open("rb") as file:
        header = file.read(limits.metadata_bytes)
        body = header.find(b"$enddefinitions")
        if body < 0:
            raise ValueError(
                f"a VCD's header must end with $enddefinitions within {limits.metadata_bytes} "
                f"bytes (limit metadata_bytes)"
            )
        note = NOTE.search(header, 0, body)
        file.seek(body)
        rest = b""
        while block := file.read(BLOCK_BYTES):
            stamps, rest = _stamps(rest + block)
            limits.check("metadata_bytes", len(rest), "the length of a value or comment")
            first, last = _rising(stamps, first, last)
    first, last = _rising(_stamps(rest + b"\n")[0], first, last)
    return _Frame(first or 0, last, Fraction(note[1].decode()) if note else None)


def _stamps(text: bytes) -> tuple[Ticks, bytes]:
    """The time stamps, and the item at the end that is not whole."""
    stamps = []
    at = 0
    while found := TIME.match(text, at):
        at = found.end()
        if found[1] is None:
            break
        stamps.append(int(found[1]))
    return np.array(stamps, np.int64), text[at:]


def _rising(stamps: Ticks, first: int | None, last: int) -> tuple[int | None, int]:
    """First and last time stamp with those of one more block."""
    if not stamps.size:
        return first, last
    falls = np.diff(stamps, prepend=last) < 0
    if falls.any():
        at = int(np.argmax(falls))
        before = stamps[at - 1] if at else last
        raise ValueError(f"times must not run backwards, from {before} to {stamps[at]}")
    return (int(stamps[0]) if first is None else first), int(stamps[-1])


def _unit(timescale: Any) -> Fraction:
    exponent = timescale.unit.to_exponent() if timescale is not None else None
    if exponent is None or not timescale.factor:
        raise ValueError(f"the timescale must be stated in s, ms … zs, not {timescale}")
    return Fraction(timescale.factor) * Fraction(10) ** int(exponent)


def _chosen(
    waves: Any, channels: Sequence[str] | None, ours: bool, limits: Limits
) -> Mapping[str, Any]:
    """The variables wanted, by the names they are wanted under."""
    found: dict[str, dict[Any, Any]] = {}
    for count, variable in enumerate(waves.all_vars(), 1):
        name = variable.full_name
        if ours:
            name = name.removeprefix(f"{SCOPE}.")
        found.setdefault(name, {})[str(variable.signal_id)] = variable
        limits.check("signals", count, "the number of signals")
    if channels is None:
        channels = [n for n, of in found.items() if all(map(_fits, of.values()))]
        if not channels:
            raise ValueError(f"the file must hold a signal of 1 to {MAX_WIDTH} bits, not none")
    bare: dict[str, list[str]] = {}
    for name in found:
        bare.setdefault(name.rpartition(".")[2], []).append(name)
    return {name: _one(name, found, bare) for name in channels}


def _one(name: str, found: Mapping[str, dict[Any, Any]], bare: Mapping[str, list[str]]) -> Any:
    full = [name] if name in found else bare.get(name, [])
    if not full:
        raise absent(name, list(found))
    if len(full) > 1:
        raise ValueError(f'"{name}" must name one signal, not {", ".join(full[:40])}')
    if len(found[full[0]]) > 1:
        raise ValueError(f'"{name}" must name one signal, not {len(found[full[0]])} of that name')
    variable = next(iter(found[full[0]].values()))
    if not _fits(variable):
        what = f"{variable.bitwidth} bits" if variable.is_bit_vector else str(variable.var_type)
        raise ValueError(f'"{name}" must be a signal of 1 to {MAX_WIDTH} bits, not {what}')
    return variable


def _fits(variable: Any) -> bool:
    return bool(variable.is_bit_vector) and 1 <= (variable.bitwidth or 0) <= MAX_WIDTH


def _known(name: str, signal: Any, unit: Fraction) -> tuple[Ticks, NDArray[np.uint64]]:
    """Times and bits from the first known value on; of one time only the last value counts."""
    times = np.empty(len(signal), np.int64)
    bits = np.empty(len(signal), np.uint64)
    known = np.empty(len(signal), np.bool_)
    for first in range(0, len(signal), BLOCK):
        pairs = [signal[index] for index in range(first, min(first + BLOCK, len(signal)))]
        part = slice(first, first + len(pairs))
        times[part] = [time for time, _ in pairs]
        known[part] = [isinstance(value, int) for _, value in pairs]
        bits[part] = [value if isinstance(value, int) else 0 for _, value in pairs]
    settled = np.append(times[1:] != times[:-1], True)[: times.size]
    times, bits, known = times[settled], bits[settled], known[settled]
    if not known.any():
        raise ValueError(f'"{name}" must have a value of zeros and ones, it has none')
    begin = int(np.argmax(known))
    if not known[begin:].all():
        time = times[begin + int(np.argmin(known[begin:]))] * unit
        raise ValueError(f'"{name}" must stay known, not become x or z at {float(time):g} s')
    return times[begin:], bits[begin:]


def _ticks(times: Ticks, ratio: Fraction) -> Ticks:
    """The ticks, each `ratio` long, whose first unit not before it `times` are."""
    ticks = -rescale(-times, 1 / ratio)
    if not np.array_equal(rescale(ticks, ratio), times):
        raise ValueError(f"times must be those of ticks that last {ratio} units, as noted")
    return ticks


def _waveform(variable: Any, ticks: Ticks, bits: NDArray[np.uint64]) -> Waveform:
    """Values of a variable; VCD's and FST's `integer` are signed."""
    width, signed = variable.bitwidth, str(variable.var_type) == "Integer"
    if signed:
        spare = np.uint64(MAX_WIDTH - width)
        return Waveform.of(ticks, (bits << spare).view(np.int64) >> np.int64(spare), width, True)
    return Waveform.of(ticks, bits, width)
