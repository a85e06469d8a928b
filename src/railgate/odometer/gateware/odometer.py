"""The odometer: sensors, the gate that they share, and their snapshots."""

from __future__ import annotations

from amaranth.hdl import Module, Signal
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out

from railgate.odometer.gateware.sensor import Sensor, shape
from railgate.odometer.gateware.stamps import STAMP_LAYOUT
from railgate.odometer.spec import Config

__all__ = ["Odometer"]


class Gate(wiring.Component):
    """Turns a strobe into one gate for all sensors, and tells when the fields may change.

    strobe: in, 1 bit. busy: out, 1 bit, a strobe now would join the gate under way.
    latch: out, 1 bit, in the tick after the strobe. publish: out, 1 bit, in the tick before the
    fields change. ticks: out, the tick, modulo its width. number, time: out, registers, the fields
    that all sensors share. Requirement ODO-7.
    """

    def __init__(self, config: Config) -> None:
        self._config = config
        ticks = max(config.time_bits, STAMP_LAYOUT["ticks"].width)
        super().__init__(
            {
                "strobe": In(1),
                "busy": Out(1),
                "latch": Out(1),
                "publish": Out(1),
                "ticks": Out(ticks if config.stamp_depth else config.time_bits),
            }
            | {field.name: Out(shape(field)) for field in config.common_fields}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        latency = self._config.snapshot_latency_ticks
        remaining = Signal(range(latency))
        opens = self.strobe & ~self.busy
        m.d.comb += [self.busy.eq(remaining != 0), self.publish.eq(remaining == 1)]
        m.d.sync += [self.ticks.eq(self.ticks + 1), self.latch.eq(opens)]

        strobe_time = Signal.like(self.time)
        with m.If(opens):
            m.d.sync += [remaining.eq(latency - 1), strobe_time.eq(self.ticks)]
        with m.Elif(self.busy):
            m.d.sync += remaining.eq(remaining - 1)
        with m.If(self.publish):
            m.d.sync += [self.number.eq(self.number + 1), self.time.eq(strobe_time)]
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
            m.d.comb += [sensor.a.eq(pins.a), sensor.b.eq(pins.b), sensor.latch.eq(gate.latch)]
            for field in self._config.sensor_fields:
                latched = Signal(shape(field), name=f"latched_{index}_{field.name}")
                with m.If(gate.latch):
                    m.d.sync += latched.eq(getattr(sensor, field.name))
                with m.If(gate.publish):
                    m.d.sync += getattr(pins, field.name).eq(latched)
            if self._config.stamp_depth:
                m.d.comb += sensor.ticks.eq(gate.ticks)
                wiring.connect(m, sensor.stamps, wiring.flipped(pins.stamps))
        return m
