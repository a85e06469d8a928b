"""Both channels."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Mux, Signal

from railgate.proving import Bounded, Claim, Search
from railgate.vital_output.proofs.pair import PAIR, Pair
from railgate.vital_output.proofs.stimuli import mutant
from railgate.vital_output.spec import State

__all__ = ["CLAIMS"]


class _Images(Pair):
    def __init__(self) -> None:
        super().__init__(PAIR, {})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        channels = self.pair(m)
        self.relay(m, channels)
        one, other = channels
        apart = Signal(range(PAIR.skew_ticks + 2))
        differ = one["image"] != other["image"]
        m.d.sync += apart.eq(Mux(differ, apart + (apart != PAIR.skew_ticks + 1), 0))
        m.d.comb += [
            self.assumed.eq(Cat(self.legal).all()),
            self.holds.eq(apart <= PAIR.skew_ticks),
            self.reached.eq(apart == PAIR.latency_ticks),
        ]
        return m


class _Works(Pair):
    """0, 1, 1, 0: driven, no alarm."""

    def __init__(self) -> None:
        super().__init__(PAIR, {})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        channels = self.pair(m)
        self.relay(m, channels)
        alarm = Cat(c["output_0.state"] >= State.HANDSHAKE_ALARM for c in channels).any()
        drive = Cat(c["output_0.state"] == State.DRIVE for c in channels).all()
        idle = Cat(c["output_0.state"] == State.IDLE for c in channels).all()
        was = Signal()
        m.d.sync += was.eq(was | (drive & self.contact))
        m.d.comb += [
            self.assumed.eq(
                Cat(self.legal).all()
                & Cat(self.due).all()
                & (self.images_1 == 6)
                & (self.images_2 == 6)
            ),
            self.holds.eq(~alarm),
            self.reached.eq(was & idle),
        ]
        return m


CLAIMS = (
    Claim(
        name="vital_output.images",
        claim="x.",
        requirements=("DRV-6",),
        monitor=_Images,
        method=Bounded(46, "x"),
        cover=Search(25),
        mutants=(mutant("a", "output", "a", "b"), mutant("b", "output", "a", "b")),
    ),
    Claim(
        name="vital_output.works",
        claim="x.",
        requirements=("DRV-6",),
        monitor=_Works,
        method=Bounded(30, "x"),
        cover=Search(65),
        mutants=(mutant("a", "output", "a", "b"), mutant("b", "output", "a", "b")),
    ),
)
