"""A whole channel of which some blocks are cut out: what they tell is free, or a monitor's own."""

from __future__ import annotations

from collections.abc import Mapping
from unittest.mock import patch

from amaranth.hdl import Module, Value
from amaranth.lib import wiring

from railgate.proving import Internals
from railgate.vital_output.spec import Config

__all__ = ["Told", "cut_channel"]

Told = Mapping[str, Mapping[str, Value]]
"""Of blocks that are cut out, by the names of their classes, what their outputs tell; those not
named tell what they start with."""


def cut_channel(config: Config, board: int, told: Told) -> Internals:
    """The channel with its own wiring and all blocks but those, its inner signals to be read."""
    from railgate.vital_output.gateware import channel

    cut = {name: _cut(getattr(channel, name), outputs) for name, outputs in told.items()}
    with patch.multiple(channel, **cut):
        return Internals(channel.Channel(config, board))


def _cut(block: type[wiring.Component], told: Mapping[str, Value]) -> type[wiring.Component]:
    class Cut(block):
        def elaborate(self, _platform: object) -> Module:
            m = Module()
            m.d.comb += [getattr(self, name).eq(value) for name, value in told.items()]
            return m

    return Cut
