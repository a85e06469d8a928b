"""One channel of a vital output on a bus, as a CPU reads it."""

from __future__ import annotations

from railgate.registers.host import Bus, Registers
from railgate.vital_output.host import Status
from railgate.vital_output.registers import registers
from railgate.vital_output.spec import CAUSES, Cause, Config

__all__ = ["ChannelDevice"]


class ChannelDevice:
    """The channel at a base address. All may raise BusError."""

    def __init__(self, bus: Bus, config: Config, base: int = 0) -> None:
        self.config = config
        self.registers = Registers(bus, registers(config), base)

    def status(self, *, again: bool = False) -> Status:
        """Of one tick: of now, or what was read last again. Raises ValueError where a number has no
        meaning."""
        return Status.of(self.config, self.registers.read("status", again=again))

    def seen(self, *, clear: bool = False) -> tuple[Cause, ...]:
        """The causes that came up since they were cleared; to clear, just these are cleared, so
        that none is lost."""
        told = self.registers.read("seen")
        raised = {name: bit for name, bit in told.items() if bit}
        if clear and raised:
            self.registers.write("seen", **raised)
        return tuple(cause for cause in CAUSES if told[f"{cause.name.lower()}_seen"])

    def test(self) -> None:
        """Ask for a test of the shut-off paths (DRV-18)."""
        self.registers.write("control", test=1)
