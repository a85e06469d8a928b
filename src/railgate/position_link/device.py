"""A position link on a bus, as the CPU reads it."""

from __future__ import annotations

import numpy as np

from railgate.position_link.host import Deliveries, Delivery, Layout
from railgate.position_link.host.words import pack, parted
from railgate.position_link.registers import registers
from railgate.position_link.spec import Config, cause_names
from railgate.registers.host import Bus, Registers

__all__ = ["LinkDevice"]


FIRST = 1
"""The tick in which the first cycle after reset begins."""


class LinkDevice:
    """The position link at a base address. All may raise BusError. layout: of its very words, None:
    words stay words."""

    def __init__(
        self, bus: Bus, config: Config, base: int = 0, layout: Layout | None = None
    ) -> None:
        self.config = config
        self._layout = layout
        self.registers = Registers(bus, registers(config), base)

    def delivery(self, *, again: bool = False) -> Delivery | None:
        """The last one, whole, or the one that was read last again; None before the first. Its
        tick is told by its number, which has not come round since the link's reset."""
        told = self.registers.read("delivery", again=again)
        number = told["number"]
        if not number:
            return None
        tick = FIRST + (number - 1) * self.config.cycle_ticks + self.config.delivery_ticks
        words = pack([told.pop("word")], self.config.word_bits)
        fields = {name: np.array([value], np.int64) for name, value in told.items()}
        ticks = np.array([tick], np.int64)
        words = parted(words, self.config.word_bits)
        return Deliveries(self.config, self._layout, ticks, words, fields)[0]

    def seen(self, *, clear: bool = False) -> tuple[str, ...]:
        """The causes that came up since they were cleared, in lower case; to clear, just these are
        cleared, so that none is lost."""
        told = self.registers.read("seen")
        raised = {name: bit for name, bit in told.items() if bit}
        if clear and raised:
            self.registers.write("seen", **raised)
        return tuple(name for name in cause_names() if told[f"{name}_seen"])
