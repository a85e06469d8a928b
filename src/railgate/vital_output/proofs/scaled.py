"""The vital output scaled down: times of some ticks, in the order and about the ratios that they
have, so that a solver sees whole transactions from reset on."""

from __future__ import annotations

from railgate.vital_output.spec import Config

__all__ = ["SCALED", "Scaled"]


class Scaled(Config):
    """One output and these times, in ticks, in place of those that follow from a configuration.

    They keep what a configuration is held to: τ0 > 2L, τ1 ≥ 2L and some, the skew of decisions at
    least L and twice margin and slew, the decision inside its cycle.
    """

    cycle_ticks = 22
    margin_ticks = 2
    latency_ticks = 3
    tau0_ticks = 8
    tau1_ticks = 9
    decision_ticks = margin_ticks + tau0_ticks + latency_ticks
    skew_ticks = 7
    not_yet_driving_ticks = 6
    period_ticks = 4
    half_period_ticks = 2
    period_low_ticks = 3
    period_high_ticks = 5
    zero_ticks = 8
    pulse_grace_ticks = 14
    pick_up_ticks = 17
    release_ticks = 19
    test_ticks = 21

    def __post_init__(self) -> None:
        """None of them follows from the fields: what holds between those does not matter."""


SCALED = Scaled(outputs=1, slew_ticks=1, count_bits=4)
