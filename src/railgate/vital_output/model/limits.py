"""The constants of a configuration that the kernels need, as one record."""

from __future__ import annotations

from typing import Any

import numpy as np

from railgate.check import Check
from railgate.engines.signals import parts
from railgate.vital_output.model.records import NONE, REGISTERS, SIGNALS, record
from railgate.vital_output.spec import Config

__all__ = ["LIMITS", "limits"]

OWN = (
    "outputs check_ticks cycle_ticks margin_ticks slew_ticks holdover_cycles delay_cycles "
    "life_cycles tau0_ticks tau1_ticks bit_ticks link_filter_ticks feedback_filter_ticks "
    "contact_filter_ticks input_stages link_period_ticks lost_ticks window_messages "
    "drift_limit_ticks decision_ticks period_ticks half_period_ticks period_low_ticks "
    "period_high_ticks zero_ticks pulse_grace_ticks pick_up_ticks release_ticks test_ticks "
    "skew_ticks not_yet_driving_ticks error_interval_cycles zero_at_once digest link_polynomial"
)
LIMITS = record(
    f"{OWN} frame_bytes image_bytes message_bits late_ticks count_max all_outputs",
    ("boards", np.int64, 2),
    ("begun", np.int64, 2),
    ("widths", np.int64, len(Config().layout.message)),
    ("table", np.int64, 256),
    ("inverse", np.int64, 256),
    ("starts", np.int64, len(SIGNALS)),
    ("blank", REGISTERS),
)
"""Numbers of the configuration by their names, and what is made of them.

late_ticks: the margin of a forwarded frame. all_outputs: a bit for each. begun: the CRC's register
behind each board's ID. widths: of a message's fields. table: what a byte at the register's top adds
to it; inverse: which byte that was, by the lowest byte of what it has added. starts: what is shown
at start; blank: the registers that are then.
"""


def limits(config: Config) -> Any:
    """Shape (1,), LIMITS."""
    made = np.zeros(1, LIMITS)
    for name in OWN.split():
        made[name] = int(getattr(config, name))
    layout = config.layout
    made["frame_bytes"] = layout.frame_bytes
    made["image_bytes"] = next(f.width for f in layout.frame if f.name == "image") // 8
    made["message_bits"] = layout.message_bits
    made["late_ticks"] = config.margin_ticks + config.latency_ticks
    made["count_max"] = (1 << config.count_bits) - 1
    made["all_outputs"] = signed((1 << config.outputs) - 1)
    made["widths"] = [field.width for field in layout.message]
    made["boards"] = config.boards
    made["begun"] = [layout.check.of(board, 32) for board in config.boards]
    plain = Check(width=32, polynomial=config.polynomial)
    made["table"] = table = [plain.of(byte, 8) for byte in range(256)]
    made["inverse"][0][[entry & 255 for entry in table]] = range(256)
    made["starts"] = starts(config)
    blank = made["blank"]
    blank["acknowledge"] = blank["blocked"] = made["all_outputs"]
    blank["verdict_tick"] = blank["forward_tick"] = blank["expires"] = NONE
    return made


def starts(config: Config) -> list[int]:
    """What each of SIGNALS is at start."""
    of = {"command.ready": 1, "link_tx": 1}
    for field in config.fields:
        for name, width, offset in parts(field.name, field.width):
            of[name] = signed(field.start >> offset & (1 << width) - 1)
    return [of.get(name, 0) for name in SIGNALS]


def signed(bits: int) -> int:
    """64 bits as int64 holds them."""
    return bits - (bits >> 63 << 64)
