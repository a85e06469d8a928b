"""The position link: its lines, one answer a cycle, one delivery a cycle."""

from __future__ import annotations

from amaranth.hdl import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.position_link.gateware.radio import Radio
from railgate.position_link.gateware.reader import Reader
from railgate.position_link.gateware.supervision import Supervision
from railgate.position_link.gateware.timing import Timing
from railgate.position_link.gateware.verdict import Verdict
from railgate.position_link.spec import Config
from railgate.primitives import FilteredInput

__all__ = ["PositionLink"]


class PositionLink(wiring.Component):
    """Asks for the position and delivers it, by the contract in spec.

    In domain sync, whose clock is the reference clock and whose reset makes a new tick 0:
    uef, data: in, 1 bit, the pins, asynchronous. clk, anf: out, 1 bit, the lines to the position
    system. delivery: out, 1 bit, in the tick in which the fields change. One out of each of
    config.fields: width and unit are told there. radio_valid, radio_data: out, 1 bit, the line to
    the radio unit. All outputs come straight from flip-flops.
    """

    def __init__(self, config: Config) -> None:
        self._config = config
        super().__init__(
            {name: In(1) for name in ("uef", "data")}
            | {name: Out(1) for name in ("clk", "anf", "delivery")}
            | {field.name: Out(field.width, init=field.start) for field in config.fields}
            | {name: Out(1) for name in ("radio_valid", "radio_data")}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        config = self._config
        m.submodules.input_uef = uef = FilteredInput(config.filter_ticks)
        m.submodules.input_data = data = FilteredInput(config.filter_ticks)
        m.submodules.timing = timing = Timing(config)
        m.submodules.reader = reader = Reader(config)
        m.submodules.verdict = verdict = Verdict(config)
        m.submodules.supervision = supervision = Supervision(config)
        m.submodules.radio = radio = Radio(config)

        m.d.comb += [
            uef.pin.eq(self.uef),
            data.pin.eq(self.data),
            self.clk.eq(timing.clk),
            self.anf.eq(timing.anf),
            self.delivery.eq(timing.delivery),
            reader.uef.eq(uef.level),
            reader.uef_rise.eq(uef.rise),
            reader.uef_fall.eq(uef.fall),
            reader.data.eq(data.level),
            reader.data_edge.eq(data.rise | data.fall),
            reader.starts.eq(timing.starts),
            reader.early.eq(timing.early),
            reader.open.eq(timing.open),
            reader.closes.eq(timing.closes),
            reader.sample.eq(timing.sample),
            reader.decided.eq(timing.decided),
            verdict.decided.eq(timing.decided),
            verdict.seen.eq(reader.causes),
            verdict.complete.eq(reader.complete),
            verdict.word.eq(reader.word),
            supervision.settled.eq(timing.settled),
            supervision.publish.eq(timing.publish),
            supervision.good.eq(verdict.good),
            supervision.found.eq(verdict.causes),
            supervision.read.eq(reader.word),
            supervision.since_rise.eq(reader.since_rise),
            supervision.uef_glitch.eq(uef.glitch),
            supervision.data_glitch.eq(data.glitch),
            radio.launch.eq(timing.launch),
            radio.start.eq(timing.frame_starts),
            radio.word.eq(supervision.word),
            radio.status.eq(supervision.status),
            radio.age.eq(supervision.age),
            radio.number.eq(supervision.number),
            self.radio_valid.eq(radio.valid),
            self.radio_data.eq(radio.data),
        ]
        if config.check:
            m.d.comb += verdict.check.eq(reader.check)
        for field in config.fields:
            m.d.comb += getattr(self, field.name).eq(getattr(supervision, field.name))
        return m
