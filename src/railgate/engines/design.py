"""What an engine runs, and the protocol that every engine keeps."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any, Protocol

from railgate.waves import Trace

if TYPE_CHECKING:
    from amaranth.lib import wiring

__all__ = ["Clock", "Design", "Engine", "Model"]

FEMTOSECOND = Fraction(1, 10**15)


@dataclass(frozen=True, kw_only=True)
class Clock:
    """The clock of one domain: frequency in Hz, offset in ppm, phase as a part of its period.

    Its n-th active edge (n = 0, 1, …) is at time (n + 1 + phase) · period.
    """

    frequency_hz: Fraction
    domain: str = "sync"
    ppm: Fraction = Fraction(0)
    phase: Fraction = Fraction(0)

    def __post_init__(self) -> None:
        if self.frequency_hz <= 0:
            raise ValueError(f"frequency_hz must be above 0, not {self.frequency_hz}")
        if not abs(self.ppm) < 1_000_000:
            raise ValueError(f"ppm must be between -1000000 and 1000000, not {self.ppm}")
        if not 0 <= self.phase < 1:
            raise ValueError(f"phase must be at least 0 and below 1 period, not {self.phase}")

    @property
    def period(self) -> Fraction:
        """Seconds, exact."""
        return 1 / (self.frequency_hz * (1 + Fraction(self.ppm) / 1_000_000))


@dataclass(frozen=True, kw_only=True)
class Design:
    """A component, its clocks, and its model.

    component: makes the Amaranth component; the members of its signature are the signals of
    stimulus and result, path joined by dots, as `sensor.0.a`. A member `word` of 65 to 4096 bits is
    the signals `word.0`, `word.1`, … of 64 bits, least significant first, the last one of the bits
    that remain and, of a signed member, the only signed one (railgate.engines.signals.parts). The
    reset of each domain is an input too: `rst`, of a domain other than sync `<domain>_rst`; not
    driven, it is 0.
    model: makes the event-driven twin with the same signals, None where there is none.

    Time base: with one clock without phase a tick is its period. Otherwise a tick is one
    femtosecond and clock edge n is in the first tick not before its time.
    An active edge in tick k samples what the signals hold in tick k - 1; registers change in k.
    Ticks are int64: a run ends at tick 2⁶³ - 2⁵⁸ at the latest, in femtoseconds after 8 935 s.
    """

    name: str
    component: Callable[[], wiring.Component]
    clocks: tuple[Clock, ...]
    model: Callable[[], Model] | None = None

    def __post_init__(self) -> None:
        domains = [clock.domain for clock in self.clocks]
        if not domains or len(set(domains)) != len(domains):
            raise ValueError(f"a design needs one clock for each domain, not {domains}")

    @property
    def single(self) -> bool:
        """One clock without phase: every tick is an active edge."""
        return len(self.clocks) == 1 and not self.clocks[0].phase

    @property
    def period(self) -> Fraction:
        """Seconds per tick."""
        return self.clocks[0].period if self.single else FEMTOSECOND


class Engine(Protocol):
    """A design that runs. Opened at tick 0, all as after reset."""

    @property
    def now(self) -> int:
        """The tick up to which it has run."""

    @property
    def registers(self) -> tuple[str, ...]:
        """The names that `poke` takes: registers of up to 64 bits."""

    def advance(self, until: int, stimulus: Trace, outputs: Collection[str] | None = None) -> Trace:
        """Run the ticks now ≤ k < until; the result has the outputs over just these.

        outputs: their names, None for all; an output that is not asked for costs no memory, and
        a model no time. Raises ValueError where there is none of that name.

        The stimulus covers at least these ticks, in the design's time base. It may leave out
        inputs: they keep what they last held, 0 at first. Raises ValueError where it does not fit.
        """

    def poke(self, name: str, value: int) -> None:
        """Force a register, as `sensor_0.position`, to hold `value` in tick `now`; it goes on from
        there. Raises ValueError, naming those there are, and for a value that it cannot hold."""

    def checkpoint(self) -> Any:
        """All of the state; opaque, and good for any engine of the same kind and design."""

    def restore(self, checkpoint: Any) -> None:
        """Go back (or forth) to the state and tick of a checkpoint.

        Raises ValueError where it is of another design, or of other clocks.
        """


Model = Engine
"""A model is an engine by itself: it keeps the same protocol, leaping from event to event."""
