"""A small counter as gateware, what is claimed of it, and a claim to put a monitor in."""

from typing import Any

from amaranth.hdl import ClockDomain, DomainRenamer, Module, Mux, ResetSignal, Signal, signed
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.proving import Claim, Induction, Internals, Monitor, Mutant

LAST = 5
INPUTS = "railgate.primitives.inputs"


class Counter(wiring.Component):
    """Counts ticks with `go` from 0 to LAST, then from 0 again."""

    def __init__(self) -> None:
        super().__init__({"go": In(1), "count": Out(8), "wraps": Out(1)})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        m.d.comb += self.wraps.eq(self.go & (self.count == LAST))
        with m.If(self.wraps):
            m.d.sync += self.count.eq(0)
        with m.Elif(self.go):
            m.d.sync += self.count.eq(self.count + 1)
        return m


class NeverAbove(Monitor):
    """The count is never above `limit`, nor `other` (where it is given, by a lemma)."""

    def __init__(self, limit: int = LAST, other: int | None = None) -> None:
        self._limit, self._other = limit, other
        super().__init__({"go": 1}, lemmas=() if other is None else ("below",))

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        counter = Counter()
        m.submodules.counter = inner = Internals(counter)
        m.d.comb += [
            counter.go.eq(self.go),
            self.holds.eq(inner["count"] <= self._limit),
            self.reached.eq(inner["wraps"]),
        ]
        if self._other is not None:
            m.d.comb += self.lemma.below.eq(inner["count"] <= self._other)
        return m


class NeverGoing(NeverAbove):
    """Assumes that nothing goes."""

    def elaborate(self, platform: object) -> Module:
        m = super().elaborate(platform)
        m.d.comb += self.assumed.eq(~self.go)
        return m


class Impossible(NeverAbove):
    """Assumes what no input can do."""

    def elaborate(self, platform: object) -> Module:
        m = super().elaborate(platform)
        m.d.comb += self.assumed.eq(self.go & ~self.go)
        return m


class Unclocked(Monitor):
    """Holds without any register."""

    def __init__(self) -> None:
        super().__init__({"go": 1})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        m.d.comb += [self.holds.eq(self.go | ~self.go), self.reached.eq(self.go)]
        return m


class Forgotten(NeverAbove):
    """A clock that nobody drives."""

    def elaborate(self, platform: object) -> Module:
        m = super().elaborate(platform)
        m.domains += ClockDomain("sync")
        return m


class Other(NeverAbove):
    """A register beside, in a domain of its own."""

    def elaborate(self, platform: object) -> Module:
        m = super().elaborate(platform)
        m.domains += ClockDomain("other", local=True)
        late = Signal()
        m.d.other += late.eq(self.go)
        m.d.comb += self.assumed.eq(late | self.go)
        return m


class Clocked(Monitor):
    """A counter in a domain of its own has counted its clock's rising edges, but not to `limit`."""

    def __init__(self, limit: int = LAST + 1) -> None:
        self._limit = limit
        super().__init__({"toggles": 1}, domains=["other"])

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        m.domains += (domain := ClockDomain("other", local=True, reset_less=True))
        m.submodules.counter = DomainRenamer("other")(counter := Counter())
        level, edges = Signal(), Signal(8)
        m.d.sync += level.eq(level ^ self.toggles)
        with m.If(self.toggles & ~level):
            m.d.sync += edges.eq(Mux(edges == LAST, 0, edges + 1))
        m.d.comb += [
            domain.clk.eq(level),
            counter.go.eq(1),
            self.assumed.eq(~ResetSignal()),
            self.holds.eq((counter.count == edges) & (edges != self._limit) & (edges <= LAST)),
            self.reached.eq(counter.wraps),
        ]
        return m


class Signed(Monitor):
    """The last tick's pair was not -3 and 1."""

    def __init__(self) -> None:
        pair = wiring.Signature({"value": Out(signed(4)), "sure": Out(2)})
        super().__init__({"pair": pair, "go": 1})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        seen = Signal()
        m.d.sync += seen.eq((self.pair.value == -3) & (self.pair.sure == 1) & self.go)
        m.d.comb += [self.holds.eq(~seen), self.reached.eq(self.go)]
        return m


M = tuple(Mutant(name, INPUTS, "STAGES = 2", "STAGES = 3") for name in ("one", "two"))


def claim(monitor: Any, **given: Any) -> Claim:
    """A claim of a monitor, with mutants that are not to be tried."""
    told = {"method": Induction(), "mutants": M, "requirements": ("ODO-9",)} | given
    return Claim(name="test.claim", claim="It holds.", monitor=monitor, **told)
