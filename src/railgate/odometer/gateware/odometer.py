"""The odometer: sensors, the gate that they share, and their snapshots."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Signal
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out

from railgate.odometer.gateware.sensor import Sensor, settled, shape
from railgate.odometer.gateware.stamps import STAMP_LAYOUT
from railgate.odometer.spec import Config
from railgate.primitives.chunked import count, delayed

__all__ = ["Odometer"]


LAST = Config.snapshot_latency_ticks - 2
"""Ticks after the latch in which the fields change with the next one: what is only then there is
told at once."""


class Gate(wiring.Component):
    """Turns a strobe into one gate for all sensors, and tells when the fields may change.

    strobe: in, 1 bit. busy: out, 1 bit, register, a strobe now would join the gate under way.
    latches: out, register, bit n is 1 n + 1 ticks after a strobe that opened the gate; the last
    one in the tick before the fields change. ticks: out, register, the tick before, modulo its
    width. number, time: out, registers, the fields that all sensors share. Requirement ODO-7.
    """

    def __init__(self, config: Config) -> None:
        self._config = config
        ticks = max(config.time_bits, STAMP_LAYOUT["ticks"].width)
        super().__init__(
            {
                "strobe": In(1),
                "busy": Out(1),
                "latches": Out(config.snapshot_latency_ticks - 1),
                "ticks": Out(ticks if config.stamp_depth else config.time_bits),
            }
            | {field.name: Out(shape(field)) for field in config.common_fields}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        opens = self.strobe & ~self.busy
        publish = self.latches[-1]
        m.d.sync += [
            self.latches.eq(Cat(opens, self.latches)),
            self.busy.eq(opens | (self.busy & ~publish)),
        ]
        count(m, self.ticks, delayed(m, 1, 1, name="started"))
        next_number = Signal.like(self.number)
        next_time = Signal.like(self.time, reset_less=True)
        count(m, next_number, self.latches[0])
        with m.If(self.latches[0]):
            m.d.sync += next_time.eq(self.ticks)
        with m.If(publish):
            m.d.sync += [self.number.eq(next_number), self.time.eq(next_time)]
        return m


class Odometer(wiring.Component):
    """Counts and measures what `config.sensors` two-channel sensors tell, by the contract in spec.

    In domain sync, whose clock is the reference clock and whose reset makes a new tick 0:
    strobe: in, 1 bit, latches all sensors. busy: out, 1 bit, the gate is under way.
    number, time: out, the fields that all sensors of a snapshot share, see config.common_fields.
    sensor: one interface each, of
    - a, b: in, 1 bit, the pins, asynchronous.
    - one out of each of config.sensor_fields: width, sign and unit are told there.
    - stamps: out, stream of STAMP_LAYOUT, only where stamp_depth > 0.
    """

    def __init__(self, config: Config) -> None:
        self._config = config
        fields = {field.name: Out(shape(field)) for field in config.sensor_fields}
        stamps = {"stamps": Out(stream.Signature(STAMP_LAYOUT))} if config.stamp_depth else {}
        sensor = wiring.Signature({"a": In(1), "b": In(1)} | fields | stamps)
        super().__init__(
            {"strobe": In(1), "busy": Out(1)}
            | {field.name: Out(shape(field)) for field in config.common_fields}
            | {"sensor": Out(sensor).array(config.sensors)}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        m.submodules.gate = gate = Gate(self._config)
        m.d.comb += [
            gate.strobe.eq(self.strobe),
            self.busy.eq(gate.busy),
            self.number.eq(gate.number),
            self.time.eq(gate.time),
        ]
        for index, pins in enumerate(self.sensor):
            m.submodules[f"sensor_{index}"] = sensor = Sensor(self._config)
            m.d.comb += [sensor.a.eq(pins.a), sensor.b.eq(pins.b), sensor.latches.eq(gate.latches)]
            for field in self._config.sensor_fields:
                name = f"latched_{index}_{field.name}"
                latched = Signal(shape(field), reset_less=True, name=name)
                live, told = getattr(sensor, field.name), getattr(pins, field.name)
                for part, late in settled(self._config, field):
                    with m.If(gate.latches[late]):
                        m.d.sync += latched[part].eq(live[part])
                    with m.If(gate.latches[LAST]):
                        m.d.sync += told[part].eq((live if late == LAST else latched)[part])
            if self._config.stamp_depth:
                m.d.comb += sensor.ticks.eq(gate.ticks)
                wiring.connect(m, sensor.stamps, wiring.flipped(pins.stamps))
        return m
