"""What the contract says of the inputs, told from their past alone, beside the gateware."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction

from amaranth.hdl import Array, Cat, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.odometer.spec import Config, Direction
from railgate.proving import Internals, Monitor

__all__ = ["SEATED", "SMALL", "Channel", "Observed", "Strobes", "Travel", "quarter"]

SMALL = Config(
    clock_hz=20_000,
    overspeed_kmh=Fraction(80),
    minimum_kmh=Fraction(60),
    period_bits=5,
    count_bits=8,
    window_pulses=3,
)
"""What is default beside these: all limits are met within some hundred ticks."""

SEATED = 3
"""The tick from which the pin's level, so late, is the filtered one where filter_ticks = 0."""


class Channel(wiring.Component):
    """A pin as the contract has it where filter_ticks = 0: f[k] = pin[k - 3] from tick 3 on.

    pin: in, 1 bit. level: out, 1 bit, f[k]. rise, fall: out, 1 bit, an edge in this tick, from
    tick 4 on. before: out, 1 bit, f[k - 1]. ticks: since reset, SEATED + 1 at most.
    """

    def __init__(self) -> None:
        outs = ("level", "rise", "fall", "before")
        super().__init__({"pin": In(1)} | {name: Out(1) for name in outs})
        self._past = Signal(SEATED + 1)
        self.ticks = Signal(range(SEATED + 2))

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        ticks = self.ticks
        m.d.sync += [
            self._past.eq(Cat(self.pin, self._past)),
            ticks.eq(Mux(ticks == SEATED + 1, ticks, ticks + 1)),
        ]
        told = ticks == SEATED + 1
        m.d.comb += [
            self.level.eq((ticks >= SEATED) & self._past[SEATED - 1]),
            self.before.eq(told & self._past[SEATED]),
            self.rise.eq(told & self.level & ~self.before),
            self.fall.eq(~self.level & self.before),
        ]
        return m

    def agrees(self, inner: Internals, path: str) -> Value:
        """The invariant that binds the input `path` of the gateware to the pin's past."""
        expected = {
            "synchroniser.stage0": self._past[0],
            "synchroniser.stage1": self._past[1],
            "level": self.level,
            "rise": self.rise,
            "fall": self.fall,
            "seats": (1 << self.ticks)[:SEATED],
            "held": 0,
        }
        equal = [inner[f"{path}.{name}"] == value for name, value in expected.items()]
        # What is older than the reset is 0.
        silent = (self.ticks > 1) | ((self._past >> self.ticks)[:2] == 0)
        return Cat(*equal, silent, self.ticks <= SEATED + 1).all()


class Travel(wiring.Component):
    """Steps as the contract has them, by the quarter that the levels are in.

    a, b: in, 1 bit, the levels after this tick's edges. edge: in, 1 bit, there may be one.
    forward, back, illegal: out, 1 bit, what this tick's edges are. reversal: out, 1 bit, a step
    against `direction`. direction: out, 2 bits, before this tick's step; next: after it.
    """

    def __init__(self) -> None:
        flags = ("forward", "back", "illegal", "reversal")
        super().__init__(
            {name: In(1) for name in ("a", "b", "edge")}
            | {name: Out(1) for name in flags}
            | {"direction": Out(2), "next": Out(2)}
        )
        self._before = Signal(2)

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        now = quarter(self.a, self.b)
        steps = Mux(self.edge, (now - self._before)[:2], 0)
        m.d.sync += [self._before.eq(now), self.direction.eq(self.next)]
        m.d.comb += [
            self.forward.eq(steps == 1),
            self.illegal.eq(steps == 2),
            self.back.eq(steps == 3),
            self.reversal.eq(
                (self.forward & (self.direction == Direction.REVERSE))
                | (self.back & (self.direction == Direction.FORWARD))
            ),
        ]
        after = (self.direction, Direction.FORWARD, Direction.NONE, Direction.REVERSE)
        m.d.comb += self.next.eq(Array(after)[steps])
        return m

    def agrees(self, inner: Internals, path: str, a: Value, b: Value) -> Value:
        """The invariant that binds the steps of the sensor at `path`, and the levels before this
        tick's edges, to these."""
        same = inner[f"{path}.steps.direction"] == self.direction
        return (quarter(a, b) == self._before) & same


def quarter(a: Value, b: Value) -> Value:
    """How many steps forward of 00 the levels are: 00, 10, 11, 01 are 0, 1, 2, 3."""
    return Mux(b, 3 - a, a)[:2]


class Strobes(wiring.Component):
    """The gate as the contract has it: strobes while one is under way change nothing.

    strobe: in, 1 bit. opens: out, 1 bit, this tick's strobe is a snapshot's. latches: out, 1 bit,
    the last tick's was. busy: out, 1 bit. publishes: out, 1 bit, in the tick before the fields
    change. delivers: out, 1 bit, in the first tick in which they are a new snapshot's.
    """

    def __init__(self) -> None:
        flags = ("opens", "latches", "busy", "publishes", "delivers")
        super().__init__({"strobe": In(1)} | {name: Out(1) for name in flags})
        self._past = Signal(Config.snapshot_latency_ticks)  # bit n: one opened n + 1 ticks ago

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        m.d.sync += self._past.eq(Cat(self.opens, self._past))
        m.d.comb += [
            self.opens.eq(self.strobe & ~self.busy),
            self.latches.eq(self._past[0]),
            self.busy.eq(self._past[:-1].any()),
            self.publishes.eq(self._past[-2]),
            self.delivers.eq(self._past[-1]),
        ]
        return m

    def agrees(self, inner: Internals) -> Value:
        """The invariant that binds the gateware's gate to the strobes of the past."""
        last = len(self._past) - 1
        under_way = [self._past[n] == (inner["gate.remaining"] == last - n) for n in range(last)]
        alone = ~(self._past[-1] & self.busy)
        return Cat(*under_way, inner["gate.latch"] == self.latches, alone).all()


class Observed(Monitor):
    """An odometer with filter_ticks = 0, its sensor 0 and its strobe free; its other sensors rest.

    For what is claimed of one sensor: each is what it would be alone, by odometer.sensors. `lemmas`
    are further ones beside `inputs` and `gate`.
    """

    def __init__(self, config: Config, lemmas: Iterable[str] = ()) -> None:
        super().__init__({"a": 1, "b": 1, "strobe": 1}, ("inputs", "gate", *lemmas))
        self.config = config
        self.on_a, self.on_b = Channel(), Channel()
        self.travel, self.strobes = Travel(), Strobes()
        self.at_strobe: dict[str, Value] = {}

    def odometer(self, m: Module) -> Internals:
        """Adds the odometer and the contract's view of its inputs."""
        from railgate.odometer.gateware import Odometer

        dut = Odometer(self.config)
        m.submodules.dut = inner = Internals(dut)
        m.submodules += [self.on_a, self.on_b, self.travel, self.strobes]
        for pin, channel, to in (
            (self.a, self.on_a, dut.sensor[0].a),
            (self.b, self.on_b, dut.sensor[0].b),
        ):
            m.d.comb += [channel.pin.eq(pin), to.eq(pin)]
        self.edge = self.on_a.rise | self.on_a.fall | self.on_b.rise | self.on_b.fall
        m.d.comb += [
            dut.strobe.eq(self.strobe),
            self.strobes.strobe.eq(self.strobe),
            self.travel.a.eq(self.on_a.level),
            self.travel.b.eq(self.on_b.level),
            self.travel.edge.eq(self.edge),
            self.lemma.inputs.eq(
                self.on_a.agrees(inner, "sensor_0.input_a")
                & self.on_b.agrees(inner, "sensor_0.input_b")
                & (self.on_a.ticks == self.on_b.ticks)
                & self.travel.agrees(inner, "sensor_0", self.on_a.before, self.on_b.before)
            ),
            self.lemma.gate.eq(self.strobes.agrees(inner)),
        ]
        return inner

    def reports(
        self, m: Module, inner: Internals, fields: Mapping[str, Value]
    ) -> tuple[Value, Value]:
        """That the snapshot's fields are those values as they stand after the strobe's tick.

        fields: sensor 0's, by name, each after the events of this tick; `at_strobe` then has them
        as they were in the last strobe's. The first value returned is the claim at the ports, of
        all ticks with busy = 0; the second the invariant behind it.
        """
        told, carried = [], []
        for name, value in fields.items():
            live, out = inner[f"sensor_0.{name}"], inner[f"sensor.0.{name}"]
            self.at_strobe[name] = copy = Signal.like(live, name=f"{name}_at_strobe")
            with m.If(self.strobes.opens):
                m.d.sync += copy.eq(value)
            under_way = Mux(self.strobes.latches, live, inner[f"latched_0_{name}"])
            told.append(self.strobes.busy | (out == copy))
            carried.append(Mux(self.strobes.busy, under_way, out) == copy)
        return Cat(*told).all(), Cat(*carried).all()
