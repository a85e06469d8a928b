"""A component of which some blocks are cut out: what they tell is free, or a monitor's own."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any
from unittest.mock import patch

from amaranth.hdl import Module, Value
from amaranth.lib import wiring

from railgate.proving import Internals

__all__ = ["Told", "cut"]

Told = Mapping[str, Mapping[str, Value]]
"""Of blocks that are cut out, by the names of their classes, what their outputs tell; those not
named tell what they start with."""


def cut(file: Any, name: str, arguments: tuple[Any, ...], told: Told) -> Internals:
    """The component of that name in a file of the gateware, made with these arguments, with its own
    wiring and all blocks but those; its inner signals, those blocks' ports too, are to be read."""
    blocks = {block: _cut(getattr(file, block), outputs) for block, outputs in told.items()}
    with patch.multiple(file, **blocks):  # type: ignore[call-overload]
        return Internals(getattr(file, name)(*arguments))


def _cut(block: type[wiring.Component], told: Mapping[str, Value]) -> type[wiring.Component]:
    class Cut(block):
        def elaborate(self, _platform: object) -> Module:
            m = Module()
            m.d.comb += [getattr(self, name).eq(value) for name, value in told.items()]
            return m

    return Cut
