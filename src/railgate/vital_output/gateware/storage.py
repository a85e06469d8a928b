"""What is stored: the image that drives, its life, the acknowledgement, and what forces a 0."""

from __future__ import annotations

from amaranth.hdl import Const, Module, Mux, Signal, Value, signed
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.primitives import Twin
from railgate.vital_output.gateware.vote import slot_layout
from railgate.vital_output.spec import Config

__all__ = ["ErrorInterval", "Storage"]

LIFE_BITS = 4


class Storage(wiring.Component):
    """Holds the image for its life of cycles.

    own: in, a slot_layout, the frame that is stored in a tick with stored: in, 1 bit, event.
    decides: in, 1 bit, event: decided: in, 32 bits, is the cycle that is decided. accepted,
    peer_accepted: in, 1 bit each, events: accepted_image, forwarded_image: in, one bit an output
    each, is of a frame of the own CPU, of the peer's. rejected: in, 1 bit, event, a frame was.
    booted: in, 1 bit, event, the peer has started anew. upset: in, 1 bit, something that all
    outputs share is.
    life: out, 4 bits, cycles; image, acknowledge, blocked: out, one bit an output each; latched:
    out, 1 bit, registers, see Config.fields. Events: acknowledged: out, one bit an output, it is.
    life_out: out, 1 bit, the life has come to its end (LIFE_OUT). life_ends: out, 1 bit, from the
    next tick on there is none. latches: out, 1 bit (LATCHED). error: out, 1 bit, see Twin.
    Requirements DRV-5, DRV-7, DRV-12, DRV-15.
    """

    def __init__(self, config: Config) -> None:
        self._config = config
        n = config.outputs
        events = ("stored", "decides", "accepted", "peer_accepted", "rejected", "booted", "upset")
        super().__init__(
            {name: In(1) for name in events}
            | {"own": In(slot_layout(config)), "decided": In(32)}
            | {"accepted_image": In(n), "forwarded_image": In(n)}
            | {"life": Out(LIFE_BITS), "image": Out(n), "acknowledged": Out(n)}
            | {name: Out(n, init=(1 << n) - 1) for name in ("acknowledge", "blocked")}
            | {name: Out(1) for name in ("latched", "life_out", "life_ends", "latches", "error")}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        m.submodules.held_life = life = Twin(LIFE_BITS)
        m.submodules.held_image = image = Twin(self._config.outputs)
        m.d.comb += [self.life.eq(life.value), self.image.eq(image.value)]

        stored_index = Signal(32)
        ahead = Signal(signed(32))
        falls = Signal()
        m.d.comb += [
            ahead.eq(stored_index - self.decided),
            falls.eq(self.decides & ~self.stored & (ahead < 0) & (life.value != 0)),
            self.life_out.eq(falls & (life.value == 1)),
            self.life_ends.eq(self.life_out | self.upset),
        ]
        with m.If(self.stored):
            m.d.comb += self.acknowledged.eq(self.own.acknowledge & ~self.acknowledge)
            m.d.sync += [
                stored_index.eq(self.own.index),
                self.acknowledge.eq(self.own.acknowledge),
            ]
        with m.If(self.upset):
            m.d.comb += life.next.eq(0)
        with m.Elif(self.stored):
            m.d.comb += life.next.eq(self._config.life_cycles)
        with m.Else():
            m.d.comb += life.next.eq(life.value - falls)

        error, latched_next = self._errors(m)
        with m.If(~(self.life_out | self.upset | latched_next)):
            kept = Mux(self.stored, self.own.image, image.value)
            m.d.comb += image.next.eq(kept & ~self._zeros())
        m.d.comb += self.error.eq(life.error | image.error | error)

        with m.If(self.booted):
            m.d.sync += self.blocked.eq(self.blocked.init)
        with m.Elif((life.value != 0) & ~self.upset):
            m.d.sync += self.blocked.eq(self.blocked & image.value)
        return m

    def _errors(self, m: Module) -> tuple[Signal, Signal]:
        """The error interval's error, and whether it is latched in the next tick."""
        error = Signal(name="errors_error")
        latched_next = Signal()
        if self._config.error_interval_cycles:
            m.submodules.errors = errors = ErrorInterval(self._config)
            m.d.comb += [
                errors.rejected.eq(self.rejected),
                errors.decides.eq(self.decides),
                errors.acknowledged.eq(self.acknowledged.any()),
                self.latched.eq(errors.latched),
                self.latches.eq(errors.latches),
                latched_next.eq(errors.latched_next),
                error.eq(errors.error),
            ]
        return error, latched_next

    def _zeros(self) -> Value:
        """The bits that a frame of this tick has 0, which with zero_at_once are obeyed."""
        if not self._config.zero_at_once:
            return Const(0, self._config.outputs)
        own = Mux(self.accepted, ~self.accepted_image, 0)
        return own | Mux(self.peer_accepted, ~self.forwarded_image, 0)


class ErrorInterval(wiring.Component):
    """Latches at a second rejection inside error_interval_cycles.

    rejected, decides: in, 1 bit each, events. acknowledged: in, 1 bit, event, an output is.
    latched: out, 1 bit, register. latched_next: out, 1 bit, it is 1 in the next tick. latches: out,
    1 bit, event (LATCHED). error: out, 1 bit, see Twin. Requirement DRV-15.
    """

    def __init__(self, config: Config) -> None:
        self._config = config
        inputs = ("rejected", "decides", "acknowledged")
        outputs = ("latched", "latched_next", "latches", "error")
        super().__init__(
            {name: In(1) for name in inputs} | {name: Out(1) for name in outputs},
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        cycles = self._config.error_interval_cycles
        m.submodules.held_remaining = remaining = Twin(cycles.bit_length())
        still = self.latched & ~self.acknowledged
        within = self.rejected & ((remaining.value != 0) | remaining.error)
        m.d.comb += [
            self.latched_next.eq(still | within),
            self.latches.eq(within & ~still),
            self.error.eq(remaining.error),
        ]
        m.d.sync += self.latched.eq(self.latched_next)
        # An upset begins the interval anew: so it is never shorter than it should be.
        with m.If(self.rejected | remaining.error):
            m.d.comb += remaining.next.eq(cycles)
        with m.Else():
            falls = self.decides & (remaining.value != 0)
            m.d.comb += remaining.next.eq(remaining.value - falls)
        return m
