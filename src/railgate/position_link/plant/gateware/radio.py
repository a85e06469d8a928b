"""The radio unit: the link's frame, received by an outsider."""

from __future__ import annotations

from amaranth.hdl import Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.position_link.plant.radio import outputs
from railgate.position_link.spec import Check, Config

__all__ = ["RadioUnit"]


class RadioUnit(wiring.Component):
    """Receives frames. clk, valid, data: in, 1 bit, the link's.

    received: its fields, all out, see radio.outputs. Requirement LNK-6.
    """

    def __init__(self, config: Config) -> None:
        self._config = config
        fields = {name: Out(width) for name, width in outputs(config).items()}
        super().__init__(
            {
                "clk": In(1),
                "valid": In(1),
                "data": In(1),
                "received": Out(wiring.Signature(fields)),
            }
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        size = self._config.frame_bits
        before, right = Signal(), Signal()
        frame, length = Signal(size), Signal(range(size + 2))
        m.d.sync += before.eq(self.clk)
        fall = before & ~self.clk
        bit = fall & self.valid
        last = fall & ~self.valid & (length != 0)
        m.d.comb += right.eq(1 if self._config.bare else self._remainder_is_none(m, bit, last))
        with m.If(bit):
            m.d.sync += frame.eq(frame << 1 | self.data)
            with m.If(length <= size):
                m.d.sync += length.eq(length + 1)
        with m.If(last):
            m.d.sync += length.eq(0)
            self._end(m, frame, (length == size), right)
        return m

    def _end(self, m: Module, frame: Signal, whole: Value, right: Signal) -> None:
        """At the end of a frame: its fields and its count."""
        out = self.received
        at = self._config.frame_bits
        with m.If(whole):
            for field in self._config.frame_fields:
                at -= field.width
                m.d.sync += getattr(out, field.name).eq(frame[at : at + field.width])
            m.d.sync += out.right.eq(right)
        with m.If(whole & right):
            m.d.sync += out.frames.eq(out.frames + 1)
        with m.Else():
            m.d.sync += out.faults.eq(out.faults + 1)

    def _remainder_is_none(self, m: Module, bit: Value, last: Value) -> Value:
        """The division of all bits, check included, leaves what it leaves of a right frame."""
        check: Check = self._config.radio_check
        rest = Signal(check.width, init=check.initial)
        added = Mux(rest[-1] ^ self.data, check.polynomial, 0)
        with m.If(bit):
            m.d.sync += rest.eq((rest << 1) ^ added)
        with m.If(last):
            m.d.sync += rest.eq(check.initial)
        # A right frame's check leaves zero, but for `final` that was added to it.
        plain = Check(width=check.width, polynomial=check.polynomial)
        return rest == plain.of(check.final, check.width)
