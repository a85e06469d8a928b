"""One channel from event to event: the same outputs as the gateware's, tick for tick (SYS-2)."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from railgate.engines import Clock
from railgate.vital_output.model.engine import Leap, Wire, channel_inputs, channel_outputs
from railgate.vital_output.spec import Config

__all__ = ["ChannelModel"]


class ChannelModel(Leap):
    """One channel as an engine by itself, in ticks of its clock.

    Inputs: `command.payload`, `command.valid`, `time.index`, `time.phase`, `time.valid`, `boot`,
    `test`, `link_rx`, `pulse_feedback`, `contact`, `rst`. Outputs: `command.ready`, `link_tx`,
    `pulses`, the fields of the configuration by their names.

    Its cost goes with bytes, updates, messages, cycles and edges of the pins; bits that go out and
    pulses cost nothing unless asked for.
    """

    def __init__(self, config: Config, board: int) -> None:
        """board: index into config.boards."""
        widths = channel_inputs(config) | {"link_rx": 1, "rst": 1}
        widths |= dict.fromkeys(("pulse_feedback", "contact"), config.outputs)
        wires = [Wire(name, width, name) for name, width in widths.items()]
        clock = Clock(frequency_hz=Fraction(config.clock_hz))
        signals = wires, channel_outputs(config, "", 0)
        self._board = board
        super().__init__("vital output", config, [clock], clock.period, signals)

    def _start(self) -> Any:
        record = super()._start()
        record["channels"]["board"][0, 0] = self._board
        return record

    def _key(self) -> tuple[Any, ...]:
        return (*super()._key(), self._board)
