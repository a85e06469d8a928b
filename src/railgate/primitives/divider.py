"""A fractional divider: a rate that is no whole part of the clock's, exact in the mean."""

from __future__ import annotations

from amaranth.hdl import Module, Mux, Signal, signed
from amaranth.lib import wiring
from amaranth.lib.wiring import Out

__all__ = ["FractionalDivider"]


class FractionalDivider(wiring.Component):
    """Strobes `numerator` times in `denominator` ticks, 1 ≤ numerator ≤ denominator.

    strobe: out, 1 bit, register; number n = 0, 1, … is in tick
    delay_ticks + ⌈n · denominator / numerator⌉, delay_ticks > -denominator / numerator: where it is
    negative, number 0 is over before tick 0.

    Its register `remainder` is, after t ticks with n strobes,
    numerator · (t - delay_ticks) - denominator · n: with a strobe it is not negative, else it is.
    """

    def __init__(self, numerator: int, denominator: int, delay_ticks: int = 0) -> None:
        self._numerator = numerator
        self._denominator = denominator
        over = delay_ticks < 0
        self._start = -numerator * delay_ticks - over * denominator
        super().__init__({"strobe": Out(1, init=self._start >= 0)})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        after_strobe = self._numerator - self._denominator
        lowest = min(self._start, after_strobe)
        width = 1 + max(self._numerator - 1, -lowest - 1).bit_length()
        remainder = Signal(signed(width), init=self._start)
        # It is negative, but not with a numerator more. The bits below the numerator's last 1 do
        # not tell, and where there is but one 1, the bits above are all ones.
        low = (self._numerator & -self._numerator).bit_length() - 1
        above, odd = remainder[low:], self._numerator >> low
        soon = above.all() if odd == 1 else above >= (1 << len(above)) - odd
        again = self.strobe & (remainder >= -after_strobe)
        slow = self._numerator <= -after_strobe  # the remainder is below the numerator
        m.d.sync += [
            remainder.eq(remainder + Mux(self.strobe, after_strobe, self._numerator)),
            self.strobe.eq(soon if slow else soon | again),
        ]
        return m
