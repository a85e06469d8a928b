"""FPGA 1 of an on-board unit in a scenario, with its registers, as a bus."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

from railgate.odometer.design import design as odometer
from railgate.position_link.design import design as position_link
from railgate.registers.host import AccessError, ModelledBus, Running, addresses
from railgate.unit.registers import registers
from railgate.unit.run import run
from railgate.unit.scenario import Scenario
from railgate.vital_output.loop import loop

__all__ = ["SimulatedFpga"]

FPGA = 1
RESERVE = Fraction(1, 1000)
"""Seconds that accesses may take after the last wait."""


class SimulatedFpga:
    """Its three functions in an engine each, as in `unit.run`, at the addresses of unit.registers.

    To begin with, the whole scenario is run once by the models: the commands of both CPUs follow
    from all of it. Raises ValueError.
    """

    def __init__(self, scenario: Scenario, engine: str = "leap") -> None:
        unit, made = scenario.config, run(scenario)
        clocks = made.vital.scenario.clocks(unit.vital)
        pair = loop(unit.vital, scenario.relay, clocks)
        running = {
            "odometer": Running(odometer(unit.odometer), engine, made.odometers[0].stimulus),
            "position_link": Running(position_link(unit.link), engine, made.link.stimulus),
            "vital_output": Running(pair, engine, made.vital.stimulus, f"fpga_{FPGA}"),
        }
        self._blocks: list[tuple[int, int, ModelledBus]] = []
        self._running: list[tuple[Running, ModelledBus]] = []
        for base, block in registers(unit, FPGA).blocks.items():
            prefix = f"fpga_{FPGA}." if block.name == "vital_output" else ""
            bus = ModelledBus(block, running[block.name], prefix)
            self._blocks.append((base, base + block.size, bus))
            self._running.append((running[block.name], bus))

    def read(self, address: int, count: int = 1) -> list[int]:
        """See Bus."""
        return [bus.read(at)[0] for at, bus in self._at(address, count)]

    def write(self, address: int, words: Sequence[int]) -> None:
        """See Bus."""
        for (at, bus), word in zip(self._at(address, len(words)), words, strict=True):
            bus.write(at, [word])

    def run(self, seconds: Fraction) -> bool:
        """Let all go on for so long; False where the scenario ends before."""
        if any(running.left_s < seconds + RESERVE for running, _ in self._running):
            return False
        for running, bus in self._running:
            bus.run(running.steps(seconds))
        return True

    def _at(self, address: int, count: int) -> Iterator[tuple[int, ModelledBus]]:
        """Of each word the address in its block, and the block's bus."""
        for at in addresses(address, count):
            for base, end, bus in self._blocks:
                if base <= at < end:
                    yield at - base, bus
                    break
            else:
                raise AccessError(at, "there is no block")
