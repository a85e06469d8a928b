"""The vote: the two CPUs' frames, held against each other inside τ0."""

from __future__ import annotations

from amaranth.hdl import Module, Mux, Signal, signed
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from railgate.primitives import Twin
from railgate.vital_output.spec import Config

__all__ = ["Vote", "slot_layout"]


def slot_layout(config: Config) -> data.StructLayout:
    """What is voted of a frame: the cycle in which it was sent, and its fields."""
    return data.StructLayout(
        {"index": 32, "sequence": 32, "image": config.outputs, "acknowledge": config.outputs}
    )


class Vote(wiring.Component):
    """Keeps the frame last accepted and the one last forwarded, votes them once both are there,
    and stores what both FPGAs have passed.

    accepted, peer_accepted: in, 1 bit each, events: own_frame, forwarded_frame: in, a slot_layout
    each, is a frame of the own CPU, of the peer's. crc: in, 32 bits, the own one's. peer_ok,
    peer_passed, peer_carries: in, 1 bit each, peer_sequence: in, 32 bits, see LinkReceiver.
    decides: in, 1 bit, event: decided: in, 32 bits, is the cycle that is decided.
    own: out, a slot_layout, own_crc: out, 32 bits, carries: out, 1 bit, passed: out, 1 bit,
    registers: the frame last accepted, that there is one, that it has passed. Events, 1 bit each:
    passes: out, the frames are the same. mismatch: out, they differ. skew: out, τ0 is over and one
    was alone. stored: out, `own` is. error: out, 1 bit, see Twin. Requirement DRV-6.
    """

    def __init__(self, config: Config) -> None:
        self._config = config
        slot = slot_layout(config)
        inputs = ("accepted", "peer_accepted", "peer_ok", "peer_passed", "peer_carries", "decides")
        outputs = ("carries", "passed", "passes", "mismatch", "skew", "stored", "error")
        super().__init__(
            {name: In(1) for name in inputs}
            | {name: In(32) for name in ("crc", "peer_sequence", "decided")}
            | {"own_frame": In(slot), "forwarded_frame": In(slot)}
            | {"own": Out(slot), "own_crc": Out(32)}
            | {name: Out(1) for name in outputs}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        tau0 = self._config.tau0_ticks
        m.submodules.held_remaining = remaining = Twin(tau0.bit_length())
        forwarded = Signal(slot_layout(self._config))
        own_there = Signal()
        forwarded_there = Signal()

        both = own_there & forwarded_there
        same = self.own.as_value() == forwarded.as_value()
        # An upset closes the window: nothing is voted in one that may be too long.
        closes = ~both & ((remaining.value == 1) | remaining.error)
        m.d.comb += [
            self.error.eq(remaining.error),
            self.passes.eq(both & same),
            self.mismatch.eq(both & ~same),
            self.skew.eq(closes & (own_there | forwarded_there)),
        ]
        fills = self.accepted | self.peer_accepted
        over = both | closes | (remaining.value == 0)
        m.d.comb += remaining.next.eq(Mux(over, Mux(fills, tau0, 0), remaining.value - 1))

        with m.If(both | closes):
            m.d.sync += [own_there.eq(0), forwarded_there.eq(0)]
        with m.If(self.accepted):
            m.d.sync += [
                self.own.eq(self.own_frame),
                self.own_crc.eq(self.crc),
                self.carries.eq(1),
                own_there.eq(1),
            ]
        with m.If(self.peer_accepted):
            m.d.sync += [forwarded.eq(self.forwarded_frame), forwarded_there.eq(1)]
        self._store(m)
        return m

    def _store(self, m: Module) -> None:
        """A frame passed here is open, to be stored once the peer has passed it too, until its
        cycle is decided."""
        open_ = Signal(name="open")
        ahead = Signal(signed(32))
        m.d.comb += [
            ahead.eq(self.own.index - self.decided),
            self.stored.eq(
                open_
                & self.peer_ok
                & self.peer_passed
                & self.peer_carries
                & (self.peer_sequence == self.own.sequence)
            ),
        ]
        with m.If(self.passes):
            m.d.sync += [self.passed.eq(1), open_.eq(1)]
        with m.If(self.stored | (self.decides & (ahead <= 0))):
            m.d.sync += open_.eq(0)
        with m.If(self.accepted):
            m.d.sync += [self.passed.eq(0), open_.eq(0)]
