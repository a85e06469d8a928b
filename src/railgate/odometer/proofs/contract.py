"""What the contract says of the inputs, told from their past alone, beside the gateware."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction

from amaranth.hdl import Array, Cat, Module, Mux, Shape, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.odometer.spec import Config, Direction, Flag
from railgate.proving import Internals, Monitor

__all__ = [
    "LATE",
    "SEATED",
    "SMALL",
    "Channel",
    "Observed",
    "Strobes",
    "Travel",
    "aged",
    "ages_count",
    "counts",
    "quarter",
]

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


LATE = 3
"""Ticks by which the gateware's sensors, and so what is observed of them, are late."""


class Channel(wiring.Component):
    """A pin as the contract has it where filter_ticks = 0, `late` ticks late.

    So f[k] = pin[k - 3] from tick 3 on.
    pin: in, 1 bit. level: out, 1 bit, f[k - late]. rise, fall: out, 1 bit, an edge in that tick,
    from tick 4 on. before: out, 1 bit, the level a tick before. begun: out, 1 bit, what has no
    reset in the gateware has started.
    """

    def __init__(self, late: int) -> None:
        super().__init__(
            {"pin": In(1)} | {name: Out(1) for name in ("level", "before", "rise", "fall", "begun")}
        )
        self._seated = SEATED + late
        self._past = Signal(self._seated + 1)
        self.ticks = Signal(range(self._seated + 2))

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        ticks, before = self.ticks, self._past[self._seated]
        told = ticks == self._seated + 1
        m.d.sync += [
            self._past.eq(Cat(self.pin, self._past)),
            ticks.eq(Mux(told, ticks, ticks + 1)),
        ]
        m.d.comb += [
            self.level.eq((ticks >= self._seated) & self._past[self._seated - 1]),
            self.rise.eq(told & self.level & ~before),
            self.fall.eq(told & ~self.level & before),
            self.before.eq(told & before),
            self.begun.eq(ticks > 1),
        ]
        return m

    def agrees(self, inner: Internals, path: str) -> Value:
        """The invariant that binds the input `path` of the gateware to the pin's past."""
        ticks = self.ticks
        edge = (ticks > SEATED) & (self._past[SEATED - 1] != self._past[SEATED])
        expected = {
            "synchroniser.stage0": self._past[0],
            "synchroniser.stage1": self._past[1],
            "level": (ticks >= SEATED) & self._past[SEATED - 1],
            "rise": edge & self._past[SEATED - 1],
            "fall": edge & ~self._past[SEATED - 1],
            "seats": (1 << ticks)[:SEATED],
            "held": 0,
        }
        equal = [inner[f"{path}.{name}"] == value for name, value in expected.items()]
        # What is older than the reset is 0.
        silent = (ticks > 1) | ((self._past >> ticks)[:2] == 0)
        return Cat(*equal, silent, ticks <= self._seated + 1).all()

    def age(self, tick: int) -> Value:
        """Whether it is that tick of the contract, or a later one."""
        return self.ticks >= tick + self._seated - SEATED


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

    def agrees(self, inner: Internals, path: str) -> Value:
        """The invariant that binds the steps of the sensor at `path` to these."""
        steps = f"{path}.steps"
        return (inner[f"{steps}.heading"] == self.next) & (
            inner[f"{steps}.direction"] == self.direction
        )


def quarter(a: Value, b: Value) -> Value:
    """How many steps forward of 00 the levels are: 00, 10, 11, 01 are 0, 1, 2, 3."""
    return Mux(b, 3 - a, a)[:2]


class Strobes(wiring.Component):
    """The gate as the contract has it: strobes while one is under way change nothing.

    strobe: in, 1 bit. opens: out, 1 bit, the strobe of `late` ticks ago is a snapshot's. latches:
    out, 1 bit, that of the tick before was. opened: out, 16 bits, bit n: that of n + 1 ticks ago
    is one. busy: out, 1 bit. publishes: out, 1 bit, in the tick before the fields change. delivers:
    out, 1 bit, in the first tick in which they are a new snapshot's.
    """

    def __init__(self, late: int = 0) -> None:
        self._late = late
        flags = ("opens", "latches", "busy", "publishes", "delivers")
        super().__init__(
            {"strobe": In(1), "opened": Out(Config.snapshot_latency_ticks)}
            | {name: Out(1) for name in flags}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        opens = self.strobe & ~self.busy
        m.d.sync += self.opened.eq(Cat(opens, self.opened))
        m.d.comb += [
            self.opens.eq(Cat(opens, self.opened)[self._late]),
            self.latches.eq(self.opened[self._late]),
            self.busy.eq(self.opened[:-1].any()),
            self.publishes.eq(self.opened[-2]),
            self.delivers.eq(self.opened[-1]),
        ]
        return m

    def agrees(self, inner: Internals) -> Value:
        """The invariant that binds the gateware's gate to the strobes of the past."""
        alone = (self.opened & (self.opened - 1)) == 0
        same = inner["gate.latches"] == self.opened[:-1]
        return alone & same & (inner["gate.busy"] == self.busy)


class Observed(Monitor):
    """An odometer with filter_ticks = 0, its sensor 0 and its strobe free; its other sensors rest.

    Edges and strobes are observed LATE ticks late, as the gateware's sensors take them.
    For what is claimed of one sensor: each is what it would be alone, by odometer.sensors. `lemmas`
    are further ones beside `inputs` and `gate`.
    """

    def __init__(self, config: Config, lemmas: Iterable[str] = ()) -> None:
        super().__init__({"a": 1, "b": 1, "strobe": 1}, ("inputs", "gate", *lemmas))
        self.config = config
        self.on_a, self.on_b = Channel(LATE), Channel(LATE)
        self.travel, self.strobes = Travel(), Strobes(LATE)
        self.at_strobe = {
            field.name: Signal(Shape(field.width, field.signed), name=f"{field.name}_at_strobe")
            for field in config.sensor_fields
        }

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
                & self.travel.agrees(inner, "sensor_0")
            ),
            self.lemma.gate.eq(self.strobes.agrees(inner)),
        ]
        return inner

    def reports(
        self,
        m: Module,
        inner: Internals,
        fields: Mapping[str, tuple[Value, Value]],
    ) -> tuple[Value, Value]:
        """That the snapshot's fields are those values as they stand after the strobe's tick.

        fields: sensor 0's, by name, before and after the events of this tick; `at_strobe` then has
        them as they were after the last strobe's. The first value returned is the claim at the
        ports, of all ticks with busy = 0; the second the invariant behind it: each part of the
        gateware's register has, so late as it is, what it had before the events of a tick.
        """
        opened, busy = self.strobes.opened, self.strobes.busy
        told, carried = [], []
        for name, (before, after) in fields.items():
            out, latched = inner[f"sensor.0.{name}"], inner[f"latched_0_{name}"]
            register = inner[f"sensor_0.{name}"]
            copy = self.at_strobe[name]
            with m.If(self.strobes.opens):
                m.d.sync += copy.eq(after)
            told.append(busy | (out == copy))
            carried.append(told[-1])
            past: list[Value] = [before]
            for part, late in self.settled(name):
                while len(past) <= late - LATE:
                    past.append(Signal.like(out, name=f"{name}_{len(past)}_ago"))
                    m.d.sync += past[-1].eq(past[-2])
                live = register[part] == past[late - LATE][part]
                taken = opened[late + 1 : -1].any()
                carried += [live | ~self.on_a.begun, ~taken | (latched[part] == copy[part])]
            carried += [~opened[LATE + n] | (each == copy) for n, each in enumerate(past)]
        return Cat(*told).all(), Cat(*carried).all()

    def settled(self, name: str) -> list[tuple[slice, int]]:
        """As the gateware tells it, of a sensor's field by its name."""
        from railgate.odometer.gateware.sensor import settled

        (field,) = (each for each in self.config.sensor_fields if each.name == name)
        return list(settled(self.config, field))

    def cleared(self, name: str, value: Value) -> Value:
        """Before this tick's events, a gateware's register of a field that a strobe clears.

        It is cleared by the latch, and an edge in its tick is in it a tick later.
        """
        strobes = self.strobes
        return Mux(strobes.latches, self.at_strobe[name], Mux(strobes.opened[LATE + 1], 0, value))

    def flagged(
        self, m: Module, inner: Internals, flag: Flag, due: Value, at_strobe: Value
    ) -> tuple[Value, Value]:
        """That the snapshot's flags have that one where it was due.

        due: it is, before this tick's events. at_strobe: it was after the last strobe's. Returns
        the claim and its invariant, as `reports`.
        """
        opened = self.strobes.opened
        ((_, late),) = self.settled("flags")
        live, latched, out = (
            (inner[path] & flag).any()
            for path in ("sensor_0.flags", "latched_0_flags", "sensor.0.flags")
        )
        told = opened[LATE:-1].any() | ~at_strobe | out
        carried = [told, ~opened[late + 1 : -1].any() | ~at_strobe | latched]
        past: Value = Mux(self.strobes.latches, at_strobe, due)
        for n in range(late - LATE + 1):
            carried.append(~opened[LATE + n] | (past == at_strobe))
            if n == late - LATE:
                carried.append(~past | live)
            ago = Signal(name=f"{flag.name}_{n + 1}_ago")
            m.d.sync += ago.eq(past)
            past = ago
        return told, Cat(*carried).all()


def ages_count(inner: Internals) -> Value:
    """The invariant of both counters of sensor 0's ages, once they have begun."""
    which = (counts(inner, f"sensor_0.ages.age_{n}", saturates=True) for n in range(2))
    return Cat(*which).all()


def aged(inner: Internals, of: Channel, since: Value, limit: int) -> Value:
    """The invariant of sensor 0's ticks since the last edge, which are `since`, from tick 1 on."""
    expected = Mux(since > limit, limit, since)
    return ~of.begun | (
        ages_count(inner) & (~of.age(1) | (inner["sensor_0.ages.last"] == expected))
    )


def counts(inner: Internals, name: str, *, saturates: bool = False) -> Value:
    """The invariant of a counter of the gateware: what is looked ahead for is so."""
    from railgate.primitives.chunked import CHUNK_BITS, LOW_BITS, LUT_BITS, chunks

    value = inner[name]
    low, high = value[:LOW_BITS], value[LOW_BITS:]
    same = [inner[f"{name}_full"] == value.all()]
    if not len(high):
        return same[0]
    ones, ahead, passes = (inner[f"{name}_{flag}"] for flag in ("ones", "ahead", "passes"))
    for flag, part in zip(ones, chunks(len(high), LUT_BITS), strict=True):
        same.append((low == 0) | (flag == high[part].all()))
    for at, flag in enumerate(ahead):
        same.append((low <= at + 1) | (flag == high[: (at + 1) * CHUNK_BITS].all()))
    for at, flag in enumerate(passes):
        here = value[: LOW_BITS + at * CHUNK_BITS].all()
        same.append(flag == (here & ~value.all() if saturates else here))
    return Cat(*same).all()
