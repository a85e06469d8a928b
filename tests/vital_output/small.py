"""A configuration scaled down for tests: every window keeps its order, a cycle has 12 000 ticks."""

from __future__ import annotations

from fractions import Fraction

from railgate.vital_output.spec import Config

__all__ = ["SMALL"]

TICK = Fraction(1, 1_000_000)

SMALL = Config(
    clock_hz=1_000_000,
    outputs=2,
    cycle_s=12_000 * TICK,
    margin_s=300 * TICK,
    slew_ticks=20,
    holdover_cycles=20,
    delay_cycles=2,
    tolerance_ppm=100,
    tau0_s=9_000 * TICK - 3_000 * TICK,
    tau1_s=6_500 * TICK,
    bit_ticks=4,
    link_filter_ticks=0,
    line_ticks=4,
    spare_messages=0,
    lost_messages=2,
    window_messages=32,
    drift_limit_ppm=400,
    pulse_hz=5_000,
    pulse_tolerance=Fraction(1, 10),
    feedback_filter_ticks=2,
    contact_filter_ticks=5,
    pick_up_s=1_000 * TICK,
    release_s=9_000 * TICK,
    release_min_s=6_000 * TICK,
    count_bits=8,
)
