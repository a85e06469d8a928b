"""What must hold between the numbers of a configuration."""

from __future__ import annotations

from fractions import Fraction
from math import ceil, floor
from typing import TYPE_CHECKING

from railgate.bounds import require
from railgate.check import Check
from railgate.vital_output.spec.frame import CRC_BITS

if TYPE_CHECKING:
    from railgate.vital_output.spec.config import Config

__all__ = ["MILLI", "PPM", "validate"]

MILLI = Fraction(1, 1000)
PPM = Fraction(1, 1_000_000)


def validate(config: Config) -> None:
    """Raises ValueError at the first thing that does not hold."""
    require(
        config,
        ("clock_hz", 10_000, 10**9),
        ("tolerance_ppm", 0, 1_000),
        ("outputs", 1, 64),
        ("polynomial", 1, (1 << 32) - 1),
        ("link_polynomial", 1, (1 << 32) - 1),
        ("cycle_s", MILLI / 10, 10),
        ("margin_s", 0, config.cycle_s / 4),
        ("slew_ticks", 0, config.cycle_ticks // 8),
        ("holdover_cycles", 1, 60_000),
        ("delay_cycles", 1, 8),
        ("life_cycles", 1, 15),
        ("bit_ticks", 4, 1_000),
        ("link_filter_ticks", 0, config.bit_ticks // 4),
        ("line_ticks", 0, 100_000),
        ("spare_messages", 0, 2),
        ("lost_messages", config.spare_messages + 1, 3),
        ("window_messages", 16, 1 << 16),
        ("pulse_hz", 1, Fraction(config.clock_hz, 16)),
        ("pulse_tolerance", Fraction(1, 100), Fraction(1, 3)),
        ("feedback_filter_ticks", 0, config.period_ticks // 4),
        ("contact_filter_ticks", 0, 65_535),
        ("count_bits", 4, 48),
    )
    _require_identities(config)
    _require_time(config)
    _require_link(config)
    _require_drive(config)


def _require_identities(config: Config) -> None:
    for name in ("polynomial", "link_polynomial"):
        if not getattr(config, name) & 1:
            raise ValueError(f"{name} must be odd, not {getattr(config, name):#x}")
    if config.link_polynomial == config.polynomial:
        raise ValueError(
            f"link_polynomial must differ from polynomial, not be {config.polynomial:#x}"
        )
    if config.boards[0] == config.boards[1]:
        raise ValueError(f"boards must differ, not both be {config.boards[0]:#x}")
    for board in config.boards:
        if not 0 <= board < 1 << 32:
            raise ValueError(f"boards must be between 0 and {(1 << 32) - 1}, not {board}")
    for board, masks in zip(config.boards, config.masks, strict=True):
        if hit := set(config.boards) & set(masks):
            raise ValueError(
                f"boards must not be a mask of {board:#x}, not {min(hit):#x}: choose another ID"
            )
    # A frame for one board is none for the other at a time near by: that would need this
    # difference of their times, since a CRC is linear.
    linear = Check(width=CRC_BITS, polynomial=config.polynomial)
    apart = linear.of(config.boards[0] ^ config.boards[1], CRC_BITS)
    starts = [((1 << ones) - 1) << 4 | low for ones in range(29) for low in range(16)]
    if any(
        time ^ time + later == apart for time in starts for later in range(config.delay_cycles + 2)
    ):
        raise ValueError(
            f"boards must not be told apart by a time near by, not {config.boards[0]:#x} and "
            f"{config.boards[1]:#x}: choose others"
        )


def _require_time(config: Config) -> None:
    if config.cycle_s * config.clock_hz != config.cycle_ticks:
        raise ValueError(
            "cycle_s must be a whole number of ticks, "
            f"not {float(config.cycle_s * config.clock_hz)}"
        )
    drift = ceil(config.cycle_ticks * config.drift_ppm * PPM)
    if config.slew_ticks < drift:
        raise ValueError(
            f"slew_ticks must be at least the clocks' drift in a cycle, {drift}, "
            f"not {config.slew_ticks}"
        )
    astray = config.holdover_cycles * config.cycle_ticks * config.tolerance_ppm * PPM
    if 2 * astray > config.margin_ticks:
        most = floor(config.margin_ticks / (2 * config.cycle_ticks * config.tolerance_ppm * PPM))
        raise ValueError(
            f"holdover_cycles must keep the drift below half the margin, at most {most}, "
            f"not {config.holdover_cycles}"
        )
    if config.decision_ticks >= config.cycle_ticks - config.slew_ticks - config.margin_ticks:
        latest = config.cycle_ticks - config.slew_ticks - config.margin_ticks - 1
        raise ValueError(
            f"the decision instant, margin + tau0 + latency, must lie in its cycle, at tick "
            f"{latest} at the latest, not {config.decision_ticks}"
        )


def _require_link(config: Config) -> None:
    if config.tau0_ticks <= 2 * config.latency_ticks + config.drift_in(config.tau0_ticks):
        least = 2 * config.latency_ticks + config.drift_in(config.tau0_ticks) + 1
        raise ValueError(
            f"tau0_s must be above twice the link's latency, at least {least} ticks, "
            f"not {config.tau0_ticks}"
        )
    if not config.tau1_least_ticks <= config.tau1_ticks:
        raise ValueError(
            f"tau1_s must cover leaving and deciding, at least {config.tau1_least_ticks} ticks, "
            f"not {config.tau1_ticks}"
        )
    within = (
        ceil(
            (config.window_messages + config.lost_messages)
            * config.link_period_ticks
            * config.drift_ppm
            * PPM
        )
        + 4
    )
    if config.drift_limit_ticks < within:
        ppm = ceil(within / (config.window_messages * config.link_period_ticks * PPM))
        raise ValueError(
            f"drift_limit_ppm must lie above both clocks' tolerance over window_messages, "
            f"at least {ppm}, not {config.drift_limit_ppm}"
        )
    room = config.bit_ticks - config.bit_ticks // 2 - 1
    if 2 * config.message_ticks * config.drift_ppm * PPM > room:
        raise ValueError(
            f"a message of {config.layout.message_bits} bits must be read within half of the "
            f"{room} ticks around a sample at {config.drift_ppm} ppm, not with bit_ticks "
            f"{config.bit_ticks}"
        )


def _require_drive(config: Config) -> None:
    least = Fraction(2 * config.latency_ticks + config.contact_filter_ticks, config.clock_hz)
    if not least <= config.release_min_s <= config.release_s:
        raise ValueError(
            f"release_min_s must be between {float(least):g} s, so that the peer's stop is "
            f"known before the contact opens, and release_s, not {float(config.release_min_s):g}"
        )
    for name in ("pick_up_s", "release_s"):
        if not 0 < getattr(config, name) <= 10:
            raise ValueError(
                f"{name} must be above 0 and at most 10 s, not {float(getattr(config, name)):g}"
            )
    interval = config.error_interval_s
    if interval is not None and not config.cycle_s <= interval <= 86_400:
        raise ValueError(
            f"error_interval_s must be between one cycle and 86400 s, not {float(interval):g}"
        )
