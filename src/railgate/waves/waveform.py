"""One signal as a step function."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["MAX_WIDTH", "Ticks", "Values", "Waveform", "storage"]

Ticks = NDArray[np.int64]
Values = NDArray[Any]

MAX_WIDTH = 64


def storage(width: int, signed: bool = False) -> np.dtype[Any]:
    """The smallest integer type that holds `width` bits."""
    if not 1 <= width <= MAX_WIDTH:
        raise ValueError(f"a signal's width must be between 1 and {MAX_WIDTH} bits, not {width}")
    size = next(bits for bits in (8, 16, 32, 64) if width <= bits)
    return np.dtype(f"{'int' if signed else 'uint'}{size}")


def _stored(values: ArrayLike, width: int, signed: bool) -> Values:
    """The values in their storage type. Raises ValueError where one does not fit into `width`."""
    kind = storage(width, signed)
    found = np.asarray(values)
    if found.dtype.kind not in "biu":  # numpy makes floats of lists that hold 2⁶³ and more
        found = np.asarray(values, dtype=object)
        if not all(isinstance(value, (int, np.integer)) for value in found.flat):
            raise ValueError(f"a signal's values must be integers, not {np.asarray(values).dtype}")
    if found.size and found.dtype != np.bool_:
        low, high = (-(1 << width - 1), (1 << width - 1) - 1) if signed else (0, (1 << width) - 1)
        for extreme in (int(found.min()), int(found.max())):
            if not low <= extreme <= high:
                raise ValueError(f"a value must be between {low} and {high}, not {extreme}")
    return np.ascontiguousarray(found, dtype=kind)


def _ticks(ticks: ArrayLike) -> Ticks:
    """The ticks as int64. Raises ValueError where one is no integer or does not fit."""
    found = np.asarray(ticks)
    if found.dtype != np.int64 and found.size:
        if found.dtype.kind not in "iu":
            raise ValueError(f"ticks must be integers of 64 bits, not {found.dtype}")
        if int(found.max()) >> 63 > 0:
            raise ValueError(f"ticks must be at most {(1 << 63) - 1}, not {found.max()}")
    return np.ascontiguousarray(found, dtype=np.int64)


@dataclass(frozen=True, eq=False)
class Waveform:
    """A signal that holds `values[i]` from tick `ticks[i]` until `ticks[i + 1]`.

    ticks: shape (n,), int64, strictly rising, n ≥ 1; ticks[0] is where the signal begins.
    values: shape (n,), the smallest integer type of `width` bits, successive ones different, each
    one that `width` bits hold.
    Raises ValueError where any of this does not hold.
    """

    ticks: Ticks
    values: Values
    width: int = 1
    signed: bool = False

    def __post_init__(self) -> None:
        ticks = _ticks(self.ticks)
        values = _stored(self.values, self.width, self.signed)
        if ticks.ndim != 1 or ticks.shape != values.shape or not ticks.size:
            raise ValueError(
                "a waveform needs as many values as ticks and at least one, "
                f"not {ticks.shape} ticks and {values.shape} values"
            )
        if not (ticks[1:] > ticks[:-1]).all():
            at = int(np.argmin(ticks[1:] > ticks[:-1]))
            raise ValueError(
                f"ticks must rise strictly, not go from {ticks[at]} to {ticks[at + 1]}"
            )
        if (values[1:] == values[:-1]).any():
            at = int(np.argmax(values[1:] == values[:-1]))
            raise ValueError(f"successive values must differ, not repeat at tick {ticks[at + 1]}")
        object.__setattr__(self, "ticks", ticks)
        object.__setattr__(self, "values", values)

    @classmethod
    def of(
        cls, ticks: ArrayLike, values: ArrayLike, width: int = 1, signed: bool = False
    ) -> Waveform:
        """From samples in order of time: of equal ticks the last counts, repeats are dropped."""
        at = _ticks(ticks)
        what = _stored(values, width, signed)
        if at.size > 1:
            last = np.append(at[1:] != at[:-1], True)
            if not last.all():
                at, what = at[last], what[last]
            new = np.append(True, what[1:] != what[:-1])
            if not new.all():
                at, what = at[new], what[new]
        return cls(at, what, width, signed)

    @classmethod
    def known(cls, ticks: Ticks, values: Values, width: int = 1, signed: bool = False) -> Waveform:
        """Of arrays that hold all of this by construction, types too: nothing is checked."""
        wave = cls.__new__(cls)
        wave.__dict__.update(ticks=ticks, values=values, width=width, signed=signed)
        return wave

    def __len__(self) -> int:
        return self.ticks.size

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Waveform):
            return NotImplemented
        return (
            (self.width, self.signed) == (other.width, other.signed)
            and np.array_equal(self.ticks, other.ticks)
            and np.array_equal(self.values, other.values)
        )

    __hash__ = None  # type: ignore[assignment]

    def at(self, ticks: ArrayLike) -> Values:
        """The values at `ticks`, none of which may lie before the signal begins."""
        index = np.searchsorted(self.ticks, np.asarray(ticks, dtype=np.int64), side="right") - 1
        if (index < 0).any():
            raise ValueError(f"the signal begins at tick {self.ticks[0]}, not before")
        return self.values[index]

    def rising(self) -> Ticks:
        """The ticks at which the signal leaves zero. Shape (edges,)."""
        high = self.values != 0
        edges: Ticks = self.ticks[1:][high[1:] & ~high[:-1]]
        return edges

    def falling(self) -> Ticks:
        """The ticks at which the signal returns to zero. Shape (edges,)."""
        high = self.values != 0
        edges: Ticks = self.ticks[1:][~high[1:] & high[:-1]]
        return edges

    def slice(self, start: int, end: int) -> Waveform:
        """The part in start ≤ tick < end, beginning with the value held at `start`.

        Where the signal begins later, the part does too; beyond `end` it raises ValueError.
        """
        if self.ticks[0] >= max(end, start + 1):
            raise ValueError(f"the signal begins at tick {self.ticks[0]}, not before {end}")
        first = max(int(np.searchsorted(self.ticks, start, side="right")) - 1, 0)
        last = max(int(np.searchsorted(self.ticks, end, side="left")), first + 1)
        ticks = self.ticks[first:last].copy()
        ticks[0] = max(ticks[0], start)
        return Waveform(ticks, self.values[first:last], self.width, self.signed)

    def shift(self, ticks: int) -> Waveform:
        """The same signal, `ticks` later."""
        return Waveform(self.ticks + ticks, self.values, self.width, self.signed)

    def first_difference(self, other: Waveform) -> int | None:
        """The first tick at which the two hold different values, None where there is none.

        Values alone are compared; `==` and Trace.first_difference count width and sign too.
        Where one begins later than the other, the later beginning is a difference of the earlier.
        """
        if self.ticks[0] != other.ticks[0]:
            return int(min(self.ticks[0], other.ticks[0]))
        n = min(len(self), len(other))
        unequal = (self.ticks[:n] != other.ticks[:n]) | (self.values[:n] != other.values[:n])
        if unequal.any():
            at = int(np.argmax(unequal))
            return int(min(self.ticks[at], other.ticks[at]))
        longer = self if len(self) > n else other
        return int(longer.ticks[n]) if len(longer) > n else None
