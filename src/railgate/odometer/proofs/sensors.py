"""Sensors: each is what it would be alone, so that what is claimed of one holds of all."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import replace

from amaranth.hdl import Cat, Module, Value

from railgate.odometer.spec import Config
from railgate.proving import Claim, Induction, Internals, Monitor, Mutant, Search

__all__ = ["CLAIMS"]

READ = Search(24)
"""Ticks from reset within which an edge can be counted, read, and told."""


class _Sensors(Monitor):
    """An odometer and, for each of its sensors, one with that sensor alone at the same pins."""

    def __init__(self) -> None:
        self.config = Config()
        pins = {f"{pin}{index}": 1 for pin in "ab" for index in range(self.config.sensors)}
        super().__init__({"strobe": 1, **pins}, lemmas=("inside",))

    def elaborate(self, _platform: object) -> Module:
        from railgate.odometer.gateware import Odometer

        m = Module()
        m.submodules.dut = inner = Internals(dut := Odometer(self.config))
        m.d.comb += dut.strobe.eq(self.strobe)

        told: list[Value] = []
        inside: list[Value] = []
        moved: list[Value] = []
        for index, pins in enumerate(dut.sensor):
            single = Odometer(replace(self.config, sensors=1))
            m.submodules[f"alone_{index}"] = alone = Internals(single)
            m.d.comb += single.strobe.eq(self.strobe)
            for to in (pins, single.sensor[0]):
                m.d.comb += [
                    to.a.eq(getattr(self, f"a{index}")),
                    to.b.eq(getattr(self, f"b{index}")),
                ]
            ports = [".".join(map(str, path)) for path, _, _ in single.signature.flatten(single)]
            told += _equal(inner, alone, ports, index)
            inside += _equal(inner, alone, alone.names, index)
            moved.append(inner[f"sensor.{index}.pulses"] != 0)
        m.d.comb += [
            self.lemma.inside.eq(Cat(*inside).all()),
            self.holds.eq(Cat(*told).all()),
            self.reached.eq(Cat(*moved).all()),
        ]
        return m


def _equal(inner: Internals, alone: Internals, paths: Iterable[str], index: int) -> Iterator[Value]:
    """That those signals of the odometer with one sensor are as that sensor's of all."""
    for path in paths:
        yield inner[re.sub(r"^(sensor[._]|latched_)0", rf"\g<1>{index}", path)] == alone[path]


def _mutant(name: str, old: str, new: str) -> Mutant:
    return Mutant(name, "railgate.odometer.gateware.odometer", old, new, READ)


CLAIMS = (
    Claim(
        name="odometer.sensors",
        claim=(
            "Whatever the pins of the others, each sensor's fields, with busy, number and time, "
            "are in every tick those of an odometer with that sensor alone, so that what is "
            "claimed of sensor 0 holds of each (default configuration, of two sensors)."
        ),
        requirements=("ODO-7", "ODO-8"),
        monitor=_Sensors,
        method=Induction(),
        cover=READ,
        mutants=(
            _mutant("hears-its-neighbour", "sensor.a.eq(pins.a)", "sensor.a.eq(self.sensor[-1].a)"),
            _mutant(
                "second-reads-later",
                "with m.If(gate.latches[late]):",
                "with m.If(gate.latches[late] if index == 0 else gate.latches[late:LAST].any()):",
            ),
        ),
        fast=False,
    ),
)
