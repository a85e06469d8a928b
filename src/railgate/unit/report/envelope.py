"""Columns of a long run made short enough to draw, so that nothing that stood out is lost."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Envelope"]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Envelope:
    """Rows taken together `each` at a time, two points for each such group.

    each: 1 leaves every row as it is. Arguments of the methods have the same shape (n,), what they
    return 2 · ceil(n / each), or n.
    """

    each: int

    @classmethod
    def of(cls, rows: int, most: int) -> Envelope:
        """The finest one with at most so many points, for so many rows."""
        return cls(1 if rows <= most else -(-2 * rows // most))

    def times(self, values: Floats) -> Floats:
        """The first and the last time of each group; values: rising."""
        groups = self._groups(values)
        return values if self.each == 1 else groups[:, [0, -1]].ravel()

    def least(self, values: Floats) -> Floats:
        """Of each group the smallest value: of an interval's lower end."""
        return values if self.each == 1 else np.repeat(self._groups(values).min(axis=1), 2)

    def greatest(self, values: Floats) -> Floats:
        """Of each group the greatest value: of an interval's upper end."""
        return values if self.each == 1 else np.repeat(self._groups(values).max(axis=1), 2)

    def line(self, values: Floats) -> Floats:
        """The smallest and the greatest value of each group, the one that comes first first."""
        if self.each == 1:
            return values
        groups = self._groups(values)
        falls = groups.argmax(axis=1) < groups.argmin(axis=1)
        ends = np.column_stack([groups.min(axis=1), groups.max(axis=1)])
        ends[falls] = ends[falls, ::-1]
        return ends.ravel()

    def _groups(self, values: Floats) -> Floats:
        """Shape (groups, each); the last row fills the last group up."""
        return np.pad(values, (0, -values.size % self.each), "edge").reshape(-1, self.each)
