"""Cores that several tests look at, each exported once."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import pytest

from fpga.export.judges import Core
from railgate.fpga.export import core, export
from vital_output.small import SMALL

SMALL_CHANNEL = "\n".join(
    (
        "clock_hz = 1_000_000",
        "outputs = 2",
        'cycle_s = "12/1000"',
        'margin_s = "3/10000"',
        "slew_ticks = 20",
        "holdover_cycles = 20",
        "delay_cycles = 2",
        'tau0_s = "6/1000"',
        'tau1_s = "65/10000"',
        "bit_ticks = 4",
        "link_filter_ticks = 0",
        "line_ticks = 4",
        "spare_messages = 0",
        "lost_messages = 2",
        "window_messages = 32",
        "drift_limit_ppm = 400",
        "pulse_hz = 5_000",
        "feedback_filter_ticks = 2",
        "contact_filter_ticks = 5",
        "pick_up_s = 0.001",
        "release_s = 0.009",
        "release_min_s = 0.006",
        "count_bits = 8",
    )
)
"""A channel that is scaled down, vital_output.small."""

Exported = Callable[..., Core]


@pytest.fixture(scope="session")
def exported(tmp_path_factory: pytest.TempPathFactory) -> Exported:
    """`core(target, …)` as files; a channel is scaled down if it is `small`."""

    @cache
    def make(target: str, bus: str = "none", small: bool = False) -> Core:
        folder = tmp_path_factory.mktemp(target)
        config = None
        if small:
            config = folder / "small.toml"
            config.write_text(SMALL_CHANNEL, encoding="utf-8")
        made = core(target, bus=bus, config=config and str(config))
        assert not small or made.configurations["vital_output"] == SMALL
        export(made, "core", folder)
        return Core(folder)

    return make
