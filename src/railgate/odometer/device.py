"""An odometer on a bus, as the CPU reads it."""

from __future__ import annotations

from railgate.odometer.host import Snapshot
from railgate.odometer.registers import registers
from railgate.odometer.spec import Config
from railgate.registers.host import Bus, Registers

__all__ = ["OdometerDevice"]


class OdometerDevice:
    """The odometer at a base address. All may raise BusError."""

    def __init__(self, bus: Bus, config: Config, base: int = 0) -> None:
        self.config = config
        self.registers = Registers(bus, registers(config), base)

    def snapshots(self, *, again: bool = False) -> tuple[Snapshot, ...]:
        """One of each sensor, in one burst: of a strobe that the read itself is, or, to read again,
        of the last one there was, whatever it was (ODO-6, ODO-7, ODO-8)."""
        told = self.registers.read("snapshot", again=again)
        common = {field.name: told[field.name] for field in self.config.common_fields}
        return tuple(
            Snapshot(
                **common,
                **{f.name: told[f"sensor_{sensor}_{f.name}"] for f in self.config.sensor_fields},
            )
            for sensor in range(self.config.sensors)
        )

    def strobe(self) -> None:
        """Latch all sensors now; `snapshots(again=True)` reads them."""
        self.registers.write("control", strobe=1)
