"""Both channels, the cross-link, the relays and their feedback, from event to event (SYS-2)."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import ceil, floor
from typing import Any, Protocol

from railgate.engines import Clock
from railgate.engines.design import FEMTOSECOND
from railgate.vital_output.model.engine import (
    Leap,
    Output,
    Wire,
    channel_inputs,
    channel_outputs,
)
from railgate.vital_output.model.records import SENT, SIGNALS
from railgate.vital_output.spec import Config

__all__ = ["PairModel", "Relays"]

DOMAINS = ("fpga_1", "fpga_2", "relay")
MARGIN = Fraction(1, 100)
"""Of a tick, for what edges are rounded by."""


class Relays(Protocol):
    """The relays' clock, and how long they take to close and to open, in its ticks."""

    @property
    def clock_hz(self) -> int: ...
    @property
    def pick_up_ticks(self) -> int: ...
    @property
    def release_ticks(self) -> int: ...


class PairModel(Leap):
    """The closed loop of railgate.vital_output.loop as an engine by itself, in femtoseconds.

    Inputs, of x = 1, 2: `fpga_x.` and command.payload, command.valid, time.index, time.phase,
    time.valid, boot, test, stopped; `line_x.` and flip, low, high; `relay.` and welded, broken,
    rogue_x, open_x, stuck_x, contact_open, contact_stuck; `fpga_x_rst`, `relay_rst`. Outputs:
    `fpga_x.` and command.ready, link_tx, pulses, the fields of the configuration; `contact`.

    Its cost goes with bytes, updates, cycles, messages that tell something new, and what disturbs
    a line or a pulse train; other messages, bits of messages and edges of trains cost nothing
    unless link_tx or pulses are asked for, or something disturbs them.
    """

    def __init__(
        self, config: Config, relay: Relays, clocks: Sequence[Clock], delay_ticks: int = 0
    ) -> None:
        """clocks: of the domains fpga_1, fpga_2 and relay. delay_ticks: of the lines. Raises
        ValueError where more messages would be on a line than the model remembers."""
        most = (SENT - 2) * config.link_period_ticks
        if not 0 <= delay_ticks <= most:
            raise ValueError(f"delay_ticks must be between 0 and {most}, not {delay_ticks}")
        of = {clock.domain: clock for clock in clocks}
        self._timing = [of[domain] for domain in DOMAINS]
        self._relay, self._delay = relay, delay_ticks
        outputs = [
            *channel_outputs(config, "fpga_1.", 0),
            *channel_outputs(config, "fpga_2.", len(SIGNALS)),
            Output("contact", config.outputs, 2 * len(SIGNALS)),
        ]
        signals = _wires(config), outputs
        name = "vital output loop"
        super().__init__(name, config, self._timing, FEMTOSECOND, signals)

    def _key(self) -> tuple[Any, ...]:
        relay = self._relay.clock_hz, self._relay.pick_up_ticks, self._relay.release_ticks
        return (*super()._key(), *relay, tuple(self._timing), self._delay)

    def _start(self) -> Any:
        config, relay = self._config, self._relay
        record = super()._start()
        record["channels"]["senders"]["delay"] = (0, self._delay)
        record["loop"] = record["channels"]["looped"] = record["channels"]["line"] = 1
        period = round(Fraction(config.period_ticks * relay.clock_hz, config.clock_hz))
        low = ceil(period * (1 - config.pulse_tolerance))
        high = floor(period * (1 + config.pulse_tolerance))
        relays = record["relays"]
        relays["period"], relays["low"], relays["high"] = period, low, high
        relays["pick_up"], relays["release"] = relay.pick_up_ticks, relay.release_ticks
        periods = [clock.period for clock in self._timing]
        for c in range(2):
            channel = record["channels"][0, c]
            ratio = periods[c] / periods[2]
            within = low + 2 <= config.period_ticks * ratio <= high - 2
            channel["leapable"] = within and config.half_period_ticks * ratio >= 2
            channel["readable"] = _readable(config, periods[c] / periods[1 - c])
        return record


def _readable(config: Config, ratio: Fraction) -> bool:
    """Whether each sample of a message is within its bit; ratio: of the sender's period to the
    receiver's. One tick is for the synchroniser."""
    drift, half = (ratio - 1) * config.message_ticks, config.bit_ticks // 2
    early, late = half - 1 - MARGIN, config.bit_ticks - half - 1 - MARGIN
    held = ratio * config.bit_ticks - 1 - MARGIN
    return -late <= drift <= early and held > config.link_filter_ticks


def _wires(config: Config) -> list[Wire]:
    outputs, found = config.outputs, []
    of_channel = channel_inputs(config) | {"stopped": 1}
    for c in range(2):
        fpga = f"fpga_{c + 1}"
        found += [Wire(f"{fpga}.{name}", width, name, (c,)) for name, width in of_channel.items()]
        found += [Wire(f"line_{c + 1}.{name}", 1, name, (1 - c,)) for name in LINE]
        found += [Wire(f"relay.{n}_{c + 1}", outputs, n, (c,)) for n in ("open", "stuck")]
        found += [Wire(f"relay.rogue_{c + 1}", outputs, f"rogue_{c + 1}", (2,))]
        found += [Wire(f"{fpga}_rst", 1, "rst", (c,))]
    found += [Wire(f"relay.{name}", outputs, name, (2,)) for name in ("welded", "broken")]
    both = ("contact_open", "contact_stuck")
    found += [Wire(f"relay.{name}", outputs, name, (0, 1)) for name in both]
    return [*found, Wire("relay_rst", 1, "rst", (2,))]


LINE = ("flip", "low", "high")
