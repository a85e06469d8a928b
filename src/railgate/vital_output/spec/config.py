"""The configuration of the vital output, what follows from it, and the declared reaction time."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import ceil, floor

from railgate.digest import digest
from railgate.field import Field
from railgate.vital_output.spec.frame import Layout, mask
from railgate.vital_output.spec.states import status_fields
from railgate.vital_output.spec.validation import MILLI, PPM, validate

__all__ = ["Config"]


@dataclass(frozen=True, kw_only=True)
class Config:
    """What both channels are built for. Raises ValueError at the first thing that does not hold.

    clock_hz, tolerance_ppm: of each reference clock. outputs: 1 … 64. boards: the IDs of FPGA 1 and
    FPGA 2. polynomial: of a frame's CRC, without its leading term (DRV-4). link_polynomial: of the
    cross-link's messages, another one, so that an error in a forwarded frame has two checks to
    pass. cycle_s: the system cycle. margin_s: so far from a cycle's boundary the neighbouring index
    is tried too, and so far may the network's time be off the own. slew_ticks: by so much at most a
    cycle is longer or shorter. holdover_cycles: time is trusted for so long without an update.
    delay_cycles: so many cycles back a late frame is still told from a corrupted one. life_cycles,
    tau0_s, tau1_s: DRV-6, DRV-7, DRV-9. bit_ticks: of the cross-link. link_filter_ticks: of its
    receiver. line_ticks: the line's delay at most. spare_messages: so many in a row may be lost
    without any effect, and lost_messages are a lost link. window_messages, drift_limit_ppm: the
    peer's clock is measured over so many, and found off tolerance beyond this. pulse_hz,
    pulse_tolerance: of the pulse trains, the tolerance as a part of the period.
    feedback_filter_ticks, contact_filter_ticks: levels of at most so many ticks vanish. pick_up_s,
    release_s: of the relay at most; release_min_s at least. error_interval_s: None, or DRV-15's.
    zero_at_once: a valid 0 of either CPU is obeyed at once (DRV-7). count_bits: width of the
    counters.
    """

    clock_hz: int = 16_000_000
    tolerance_ppm: int = 100
    outputs: int = 16
    boards: tuple[int, int] = (0x5641_0001, 0x5641_0002)
    polynomial: int = 0xF4AC_FB13
    link_polynomial: int = 0x1EDC_6F41
    cycle_s: Fraction = 50 * MILLI
    margin_s: Fraction = 1 * MILLI
    slew_ticks: int = 400
    holdover_cycles: int = 100
    delay_cycles: int = 3
    life_cycles: int = 3
    tau0_s: Fraction = 5 * MILLI
    tau1_s: Fraction = 5 * MILLI
    bit_ticks: int = 8
    link_filter_ticks: int = 1
    line_ticks: int = 16
    spare_messages: int = 1
    lost_messages: int = 3
    window_messages: int = 1024
    drift_limit_ppm: int = 250
    pulse_hz: int = 1000
    pulse_tolerance: Fraction = Fraction(1, 10)
    feedback_filter_ticks: int = 16
    contact_filter_ticks: int = 1600
    pick_up_s: Fraction = 50 * MILLI
    release_s: Fraction = 50 * MILLI
    release_min_s: Fraction = 3 * MILLI
    error_interval_s: Fraction | None = None
    zero_at_once: bool = False
    count_bits: int = 16

    input_stages = 3
    """Ticks from a pin to its filtered level, less the filter's."""
    check_overhead_ticks = 8
    """Room around the runs of a frame's check."""

    def __post_init__(self) -> None:
        validate(self)

    def ticks(self, seconds: Fraction) -> int:
        """The least whole number of ticks that last so long."""
        return ceil(seconds * self.clock_hz)

    @property
    def drift_ppm(self) -> int:
        """Of one clock against the other, at most."""
        return 2 * self.tolerance_ppm

    def drift_in(self, ticks: int) -> int:
        """δ: by so many ticks at most the clocks drift apart in so many ticks."""
        return ceil(ticks * self.drift_ppm * PPM)

    @cached_property
    def layout(self) -> Layout:
        return Layout(self)

    @cached_property
    def masks(self) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """The 32 that replace each board's ID; number time mod 32 is used (DRV-2)."""
        first, second = (
            tuple(mask(self.layout, board, number) for number in range(32)) for board in self.boards
        )
        return first, second

    @cached_property
    def digest(self) -> int:
        """Of all of the configuration (SYS-5)."""
        return digest(self)

    @property
    def cycle_ticks(self) -> int:
        return floor(self.cycle_s * self.clock_hz)

    @property
    def margin_ticks(self) -> int:
        return self.ticks(self.margin_s)

    @property
    def tau0_ticks(self) -> int:
        return self.ticks(self.tau0_s)

    @property
    def tau1_ticks(self) -> int:
        return self.ticks(self.tau1_s)

    @property
    def tau1_least_ticks(self) -> int:
        """The FPGAs store within L of each other, and a state is told within another L (DRV-9)."""
        return 2 * self.latency_ticks + self.drift_in(2 * self.latency_ticks) + 8

    @property
    def check_ticks(self) -> int:
        """From a frame's last byte to its verdict: a run over the frame for each board and cycle
        that is tried, one with the mask, a byte a tick."""
        covered = self.layout.implicit_bytes + self.layout.frame_bytes - 4
        return (2 * (self.delay_cycles + 2) + 1) * covered + self.check_overhead_ticks

    @property
    def message_ticks(self) -> int:
        """A message on the line."""
        return self.layout.message_bits * self.bit_ticks

    @property
    def link_period_ticks(self) -> int:
        """From message to message. The line is quiet for longer than a message lasts, so that a
        receiver that has begun in the middle of one finds the next one's start. (A frame's check
        takes less time than a message.)"""
        return 2 * self.message_ticks + 4 * self.bit_ticks

    @property
    def latency_ticks(self) -> int:
        """L: from a register's change in one FPGA to what it makes in the other: the wait for the
        next message, spare_messages lost, the message, line and receiver, the check of its frame;
        with the drift of the clocks."""
        whole = (
            (1 + self.spare_messages) * self.link_period_ticks
            + self.line_ticks
            + self.input_stages
            + self.link_filter_ticks
            + self.message_ticks
            + self.check_ticks
            + 8
        )
        return whole + self.drift_in(whole)

    @property
    def lost_ticks(self) -> int:
        """Without a message for so long the link is lost."""
        return self.lost_messages * self.link_period_ticks + self.link_period_ticks // 2

    @property
    def drift_limit_ticks(self) -> int:
        """So far off the peer's clock may be in window_messages."""
        span = self.window_messages * self.link_period_ticks
        return floor(span * self.drift_limit_ppm * PPM)

    @property
    def drift_detection_ticks(self) -> int:
        """A clock beyond drift_limit_ppm by the resolution of 4 ticks in a window is found within
        two windows; one that stops, within lost_ticks (DRV-17)."""
        return 2 * (self.window_messages + self.lost_messages) * self.link_period_ticks

    @property
    def skew_ticks(self) -> int:
        """Skew of decisions: after one FPGA's command has changed, the other's does within it; by
        a vote within L, by a life's end as far as their times differ (DRV-10)."""
        most = max(self.latency_ticks, 2 * self.margin_ticks + 2 * self.slew_ticks)
        return most + self.drift_in(most) + 8

    @property
    def not_yet_driving_ticks(self) -> int:
        """In drive a peer that is not yet driving is tolerated for 2L + δ (DRV-10)."""
        return 2 * self.latency_ticks + self.drift_in(2 * self.latency_ticks)

    @property
    def decision_ticks(self) -> int:
        """The phase in which the cycle before is decided on: margin + τ0 + L (DRV-7)."""
        return self.margin_ticks + self.tau0_ticks + self.latency_ticks

    @property
    def period_ticks(self) -> int:
        """Of the pulse train."""
        return round(Fraction(self.clock_hz, self.pulse_hz))

    @property
    def half_period_ticks(self) -> int:
        return self.period_ticks // 2

    @property
    def period_low_ticks(self) -> int:
        """The shortest period that is the right frequency."""
        return ceil(self.period_ticks * (1 - self.pulse_tolerance))

    @property
    def period_high_ticks(self) -> int:
        """The longest period that is the right frequency."""
        return floor(self.period_ticks * (1 + self.pulse_tolerance))

    @property
    def zero_ticks(self) -> int:
        """Without a rise for so long it is 0 Hz."""
        return 2 * self.period_ticks

    @property
    def pulse_grace_ticks(self) -> int:
        """From the entry of drive until the feedback's frequency must be right."""
        return 3 * self.period_ticks + self.input_stages + self.feedback_filter_ticks

    @property
    def pick_up_ticks(self) -> int:
        """From the entry of drive until the contact must be closed: the stages need two periods,
        the relay its time, the peer starts up to L later."""
        return (
            self.ticks(self.pick_up_s)
            + 3 * self.period_ticks
            + self.latency_ticks
            + self.input_stages
            + self.contact_filter_ticks
        )

    @property
    def release_ticks(self) -> int:
        """From the entry of wait until all feedback must be gone: the peer stops up to the skew of
        decisions later, the stages hold for two periods, then the relay releases."""
        return (
            self.ticks(self.release_s)
            + 3 * self.period_ticks
            + self.skew_ticks
            + self.latency_ticks
            + self.input_stages
            + self.contact_filter_ticks
        )

    @property
    def test_ticks(self) -> int:
        """A channel pulses alone for so long: the relay would have moved (DRV-18)."""
        return self.pick_up_ticks + self.period_ticks

    @property
    def error_interval_cycles(self) -> int:
        """0 where there is none."""
        if self.error_interval_s is None:
            return 0
        return ceil(self.error_interval_s / self.cycle_s)

    @property
    def life_bound_ticks(self) -> int:
        """From the last byte of a channel's frame that is the last to pass, to the first tick in
        which its image is 0.

        The frame of cycle n is accepted from phase cycle_ticks - margin of cycle n - 1 on. Until
        phase 0 of cycle n it is then margin + slew ticks at most, since a cycle may be longer by
        slew. Cycles n … n + life follow whole, cycle_ticks + slew each at most; in the one after,
        n + life + 1, the life of n comes to 0 at its decision: in the next tick the image is 0.
        """
        before = self.margin_ticks + self.slew_ticks
        whole = (self.life_cycles + 1) * (self.cycle_ticks + self.slew_ticks)
        return before + whole + self.decision_ticks + 1

    @property
    def reaction_s(self) -> Fraction:
        """The declared reaction time, s: the relay's contact is open so long, at the latest, after
        the last byte of the last frame with an agreed 1, whatever fails in one channel (DRV-16).

        life_bound_ticks until the good channel's image is 0; one tick later its state is no more
        DRIVE, and one more its pulse is 0. All that by its clock, slow by tolerance_ppm at most.
        Its dynamic stage then takes the train for alive until no rise has come for the longest
        period that is right, counted from the last rise, which was before the stop; from there on
        the relay takes its release time.
        """
        slowest = self.clock_hz * (1 - self.tolerance_ppm * PPM)
        hold = Fraction(self.period_ticks, self.clock_hz) * (1 + self.pulse_tolerance)
        return (self.life_bound_ticks + 2) / slowest + hold + self.release_s

    @property
    def fields(self) -> tuple[Field, ...]:
        """The fields of a channel's status, each an output of that name."""
        return status_fields(self)
