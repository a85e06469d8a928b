"""The buses that a core's registers can be on."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from amaranth.lib import wiring

from railgate.registers.gateware import AxiLite, LocalBus, Uart, Wishbone
from railgate.registers.gateware.uart import BAUD

__all__ = ["BUSES", "NONE", "Bus"]

NONE = "none"
"""A core without registers."""


@dataclass(frozen=True)
class Bus:
    """kind: of its bridge. bridge: made for so many address bits, with a clock of so many Hz.
    still: its inputs without a synchroniser, which stand still while they are read, whatever clock
    they come from."""

    kind: type[wiring.Component]
    bridge: Callable[[int, int], wiring.Component]
    still: tuple[str, ...] = ()


BUSES: Mapping[str, Bus] = {
    "axi4-lite": Bus(AxiLite, lambda bits, _: AxiLite(bits)),
    "wishbone": Bus(Wishbone, lambda bits, _: Wishbone(bits)),
    "local": Bus(LocalBus, lambda bits, _: LocalBus(bits), still=("address", "data_in")),
    "uart": Bus(Uart, lambda bits, clock_hz: Uart(bits, round(clock_hz / BAUD))),
}
