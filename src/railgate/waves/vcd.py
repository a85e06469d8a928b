"""Writing VCD (IEEE 1364-2005, clause 18) and, beside it, a GTKWave save file."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from fractions import Fraction
from pathlib import Path
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray
from vcd import VCDWriter
from vcd.gtkw import GTKWSave

from railgate.waves.replacing import replacing
from railgate.waves.trace import Trace, rescale
from railgate.waves.waveform import Waveform

__all__ = ["SCOPE", "TICK_NOTE", "write_gtkw", "write_vcd"]

SCOPE = "top"
"""The outermost scope, since VCD wants one; `read` takes it off again."""
TICK_NOTE = "railgate tick {} s"
"""The comment in the header that keeps the tick's exact period."""
TIMESCALES = [
    (factor * Fraction(1, 1000**power), f"{factor} {unit}")
    for power, unit in enumerate(("s", "ms", "us", "ns", "ps", "fs"))
    for factor in (100, 10, 1)
]
BLOCK = 1 << 16

Format = Literal["bin", "dec", "hex", "oct", "signed"]


def write_vcd(path: str | Path, trace: Trace) -> None:
    """Writes the trace as VCD, so that `read` gives an equal one.

    Dots in a signal's name part its scopes; what VCD allows in no name becomes `_`. Signed signals
    become `integer`. The timescale is the coarsest of which a tick is a whole multiple. Where
    there is none (24 MHz), it is 1 fs and a change stands at the first femtosecond not before it;
    the exact tick is kept in a comment. A time stamp without changes marks the trace's end.
    Raises ValueError: a trace that begins before tick 0, ticks below 1 fs, times beyond 63 bits,
    two names that become one.
    """
    if trace.start < 0:
        raise ValueError(f"a VCD must not begin before tick 0, not at {trace.start}; shift it")
    scale, timescale = next(
        (each for each in TIMESCALES if (trace.period / each[0]).denominator == 1), TIMESCALES[-1]
    )
    ratio = trace.period / scale
    if ratio < 1:
        raise ValueError(f"a tick in a VCD must last at least 1 fs, not {trace.period} s")
    try:
        start, end = (int(t) for t in rescale(np.array([trace.start, trace.end]), ratio))
    except ValueError as error:
        raise ValueError(f"times in a VCD must fit 63 bits of {timescale}: {error}") from error
    names = _names(trace)
    note = TICK_NOTE.format(trace.period)
    with (
        replacing(path) as unfinished,
        unfinished.open("w", encoding="ascii", newline="\n") as file,
        VCDWriter(file, timescale, "", note, check_values=False, init_timestamp=start) as writer,
    ):
        variables = [
            writer.register_var(
                names[name][:-1],
                names[name][-1],
                "integer" if wave.signed else "wire",
                wave.width,
                int(_bits(wave)[0]),
            )
            for name, wave in trace.signals.items()
        ]
        for which, time, value in _changes(trace, ratio):
            writer.change(variables[which], time, value)
        writer.flush(end)


def _names(trace: Trace) -> dict[str, tuple[str, ...]]:
    """The path of each signal: scopes, then the name."""
    names: dict[str, tuple[str, ...]] = {}
    taken = set()
    for name in trace.signals:
        parts = (re.sub(r"[^A-Za-z0-9_]", "_", part) or "_" for part in name.split("."))
        path = (SCOPE, *parts)
        if path in taken:
            raise ValueError(f'names must differ in a VCD too, not be two of "{".".join(path)}"')
        names[name] = path
        taken.add(path)
    return names


def _bits(wave: Waveform) -> NDArray[np.uint64]:
    """The values as unsigned words of the signal's width."""
    words = wave.values.astype(np.int64).view(np.uint64)
    mask: NDArray[np.uint64] = words & np.uint64((1 << wave.width) - 1)
    return mask


def _changes(trace: Trace, ratio: Fraction) -> Iterator[tuple[int, int, int]]:
    """(signal, time, bits) of all changes after the start, in order of time."""
    waves = list(trace.signals.values())
    if not waves:
        return
    ticks = np.concatenate([wave.ticks[1:] for wave in waves])
    bits = np.concatenate([_bits(wave)[1:] for wave in waves])
    which = np.repeat(np.arange(len(waves)), [len(wave) - 1 for wave in waves])
    order = np.argsort(ticks, kind="stable")
    for first in range(0, order.size, BLOCK):
        part = order[first : first + BLOCK]
        times = rescale(ticks[part], ratio)
        yield from zip(which[part].tolist(), times.tolist(), bits[part].tolist(), strict=True)


def write_gtkw(
    path: str | Path,
    vcd_path: str | Path,
    trace: Trace,
    groups: Mapping[str, Iterable[str]] | None = None,
    formats: Mapping[str, Format] | None = None,
) -> None:
    """Writes the GTKWave save file that shows a VCD which `write_vcd` wrote.

    groups: title -> names of signals; None: one group for each scope. A name may be in several.
    formats: name -> how its values are shown; where none is given, one bit as bin, signed as
    signed, all else as dec.
    Raises ValueError for names that the trace does not have.
    """
    names = _names(trace)
    shown = dict(formats or {})
    for name, how in shown.items():
        trace[name]
        if how not in get_args(Format):
            raise ValueError(f'a format must be one of {", ".join(get_args(Format))}, not "{how}"')
    with replacing(path) as unfinished, unfinished.open("w", encoding="utf-8") as file:
        save = GTKWSave(file)
        save.dumpfile(str(vcd_path), abspath=False)
        for title, members in (_scopes(trace) if groups is None else groups).items():
            with save.group(title):
                for name in members:
                    wave = trace[name]
                    usual = "bin" if wave.width == 1 else "signed" if wave.signed else "dec"
                    suffix = f"[{wave.width - 1}:0]" if wave.width > 1 else ""
                    save.trace(".".join(names[name]) + suffix, datafmt=shown.get(name, usual))


def _scopes(trace: Trace) -> dict[str, list[str]]:
    scopes: dict[str, list[str]] = {}
    for name in trace.signals:
        scopes.setdefault(name.rpartition(".")[0] or SCOPE, []).append(name)
    return scopes
