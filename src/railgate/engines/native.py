"""A design as machine code: the C interface of loop.cc with numpy arrays in and out."""

from __future__ import annotations

import ctypes
import weakref
from collections.abc import Collection, Mapping, Sequence
from fractions import Fraction
from hashlib import sha256
from math import lcm
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from railgate.engines.design import Clock, Design
from railgate.engines.signals import Port, Register, check, chosen, poked
from railgate.waves import Trace, Waveform
from railgate.waves.waveform import Values, storage

__all__ = ["Native"]

_POINTER, _TICK = ctypes.c_void_p, ctypes.c_int64


class _Wave(ctypes.Structure):
    _fields_ = (("ticks", _POINTER), ("values", _POINTER), ("size", _TICK))


class Native:
    """Runs a design from a shared object. See railgate.engines.Engine for the protocol.

    library: what was compiled from loop.cc. signals: the design's ports, inputs and outputs in
    the order in which they were compiled. registers: by the path that each has in the library;
    one that was optimised away cannot be poked. Raises ValueError where the library cannot be
    loaded.
    """

    def __init__(
        self,
        design: Design,
        signals: Sequence[Port],
        registers: Mapping[str, Register],
        library: Path,
    ) -> None:
        self._design = design
        self._inputs = tuple(port for port in signals if not port.output)
        self._outputs = tuple(port for port in signals if port.output)
        clocks = b"".join(map(_edges, design.clocks))
        self._build = sha256(library.stem.encode() + clocks).digest()
        self._now = 0
        self._c = _interface(library)
        self._handle = self._c.railgate_open(clocks)
        weakref.finalize(self, self._c.railgate_close, self._handle)
        lines = self._c.railgate_registers(self._handle).decode().splitlines()
        names = [line.rsplit(" ", 1)[0].replace(" ", ".") for line in lines]
        there = {path: index for index, path in enumerate(names)}
        kept = {path: found for path, found in registers.items() if path in there}
        self._registers = {found.name: found for found in kept.values()}
        self._places = {found.name: there[path] for path, found in kept.items()}

    @property
    def now(self) -> int:
        """The tick up to which it has run."""
        return self._now

    @property
    def registers(self) -> tuple[str, ...]:
        """The names that `poke` takes."""
        return tuple(self._registers)

    def advance(self, until: int, stimulus: Trace, outputs: Collection[str] | None = None) -> Trace:
        """Run the ticks now ≤ k < until; see Engine.advance."""
        start = self._now
        design = self._design
        check(stimulus, design.name, design.period, start, until, self._inputs)
        told = set(chosen(outputs, [port.name for port in self._outputs], design.name))
        wanted = np.array([port.name in told for port in self._outputs], np.uint8)
        held = [_part(stimulus.signals.get(port.name), start, until) for port in self._inputs]
        waves = (_Wave * len(held))(
            *(_Wave(ticks.ctypes.data, values.ctypes.data, ticks.size) for ticks, values in held)
        )
        counts = np.zeros(len(self._outputs), np.int64)
        total = self._c.railgate_run(
            self._handle,
            until,
            ctypes.addressof(waves),
            wanted.ctypes.data,
            counts.ctypes.data,
        )
        ticks, values = np.empty(total, np.int64), np.empty(total, np.uint64)
        self._c.railgate_take(self._handle, ticks.ctypes.data, values.ctypes.data)
        self._now = until
        signals, at = {}, 0
        for port, count in zip(self._outputs, counts.tolist(), strict=True):
            if port.name not in told:
                continue
            part = slice(at, at := at + count)
            narrow = _typed(values[part], port)
            signals[port.name] = Waveform(ticks[part].copy(), narrow, port.width, port.signed)
        return Trace(signals, design.period, start, until)

    def poke(self, name: str, value: int) -> None:
        """Force a register to hold `value` in tick `now`; it goes on from there.

        Raises ValueError where there is no such register, or where it cannot hold the value.
        """
        register = poked(self._registers, self._design.name, name, value)
        bits = value & (1 << register.width) - 1
        self._c.railgate_poke(self._handle, self._places[name], bits)

    def checkpoint(self) -> bytes:
        """All of the state, and the digest of the build and the clocks that it belongs to."""
        state = ctypes.create_string_buffer(self._c.railgate_size(self._handle))
        self._c.railgate_save(self._handle, ctypes.addressof(state))
        return self._build + state.raw

    def restore(self, checkpoint: bytes) -> None:
        """Go back (or forth) to a checkpoint; ValueError where it is of other build or clocks."""
        build, state = checkpoint[: len(self._build)], checkpoint[len(self._build) :]
        if build != self._build or len(state) != self._c.railgate_size(self._handle):
            raise ValueError(
                f"a checkpoint must be of {self._design.name} as it is compiled and clocked here, "
                "not of another design"
            )
        self._c.railgate_load(self._handle, state)
        self._now = int.from_bytes(state[:8], "little")


def _interface(library: Path) -> ctypes.CDLL:
    try:
        shared = ctypes.CDLL(str(library))
    except OSError as error:
        raise ValueError(f"the compiled design cannot be loaded: {error}") from error
    for name, result, *arguments in (
        ("open", _POINTER, ctypes.c_char_p),
        ("close", None, _POINTER),
        ("run", _TICK, _POINTER, _TICK, _POINTER, _POINTER, _POINTER),
        ("take", None, _POINTER, _POINTER, _POINTER),
        ("size", _TICK, _POINTER),
        ("save", None, _POINTER, _POINTER),
        ("load", None, _POINTER, _POINTER),
        ("registers", ctypes.c_char_p, _POINTER),
        ("poke", None, _POINTER, ctypes.c_int64, ctypes.c_uint64),
    ):
        function = getattr(shared, f"railgate_{name}")
        function.restype, function.argtypes = result, arguments
    return shared


def _edges(clock: Clock) -> bytes:
    """The first edge and the step, as tick + rest / divisor femtoseconds, of 64 and 128 bits.

    Raises ValueError where the divisor leaves 126 bits, or where the edge after LAST_TICK may leave
    64 bits.
    """
    step = clock.period * 10**15
    first = step * (1 + Fraction(clock.phase))
    divisor = lcm(step.denominator, first.denominator)
    if divisor >= 1 << 126 or max(step, first) >= 1 << 57:
        raise ValueError(
            f"the period of {clock.domain} must be below 72 s, as a fraction of at most 126 bits, "
            f"not {step} fs"
        )
    (tick, rest), (whole, part) = divmod(first * divisor, divisor), divmod(step * divisor, divisor)
    narrow = (int(tick), int(whole))
    wide = (int(rest), int(part), divisor)
    return b"".join(n.to_bytes(8, "little") for n in narrow) + b"".join(
        n.to_bytes(16, "little") for n in wide
    )


def _part(
    wave: Waveform | None, start: int, until: int
) -> tuple[NDArray[np.int64], NDArray[np.uint64]]:
    """What the signal holds at `start` and its changes before `until`, as bits; nothing without
    one."""
    if wave is None or until == start:
        return np.empty(0, np.int64), np.empty(0, np.uint64)
    part = wave.slice(start, until)
    return part.ticks, part.values.astype(np.uint64) & np.uint64((1 << wave.width) - 1)


def _typed(bits: NDArray[np.uint64], port: Port) -> Values:
    """The bits of a port as numbers of its type."""
    if not port.signed:
        return bits.astype(storage(port.width))
    spare = np.uint64(64 - port.width)
    return ((bits << spare).view(np.int64) >> spare.astype(np.int64)).astype(
        storage(port.width, signed=True)
    )
