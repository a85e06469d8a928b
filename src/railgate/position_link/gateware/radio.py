"""The radio line: each delivery as one frame."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Mux
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.position_link.spec import Config, Status
from railgate.primitives import SerialCheck, SerialTransmitter

__all__ = ["Radio"]

CHECK = "check"
"""The frame's field that the fields before it make."""


class Radio(wiring.Component):
    """Sends config.frame_fields, or with `bare` the word alone, the fault word unless it is fresh.

    launch: in, 1 bit, in the tick before CLK rises. start: in, 1 bit, in that of the frame's first
    bit. word, status, age, number: in, the fields of the delivery, read with it.
    valid, data: out, 1 bit each, registers, the line. Requirement LNK-6.
    """

    def __init__(self, config: Config) -> None:
        self._config = config
        widths = {field.name: field.width for field in config.fields}
        super().__init__(
            {"launch": In(1), "start": In(1), "valid": Out(1), "data": Out(1)}
            | {name: In(widths[name]) for name in ("word", "status", "age", "number")}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        config = self._config
        sent = [field for field in config.frame_fields if field.name != CHECK]
        frame = Cat(getattr(self, field.name)[: field.width] for field in reversed(sent))
        if config.bare:
            frame = Mux(self.status == Status.FRESH, self.word, config.invalid_word)

        m.submodules.line = line = SerialTransmitter(len(frame), config.frame_bits - len(frame))
        m.d.comb += [
            line.strobe.eq(self.launch),
            line.start.eq(self.start),
            line.frame.eq(frame),
            self.valid.eq(line.valid),
            self.data.eq(line.data),
        ]
        if not config.bare:
            crc = config.radio_check
            check = SerialCheck(crc.width, crc.polynomial, crc.initial, crc.final)
            m.submodules.check = check
            m.d.sync += [
                check.restart.eq(self.start),
                check.enable.eq(self.launch),
                check.bit.eq(line.bit),
            ]
            m.d.comb += line.tail.eq(check.field)
        return m
