"""Two channels of one output, with clocks of their own and a cross-link of any latency up to L."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from amaranth.hdl import Cat, Const, EnableInserter, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.proving import Internals, Monitor
from railgate.vital_output.proofs.cut import Told, cut
from railgate.vital_output.spec import Config, State

__all__ = ["PAIR", "STEADY_TICKS", "TIMING", "TOLD", "Clock", "Line", "Pair", "Scaled"]

STEADY_TICKS = 32
"""A clock loses one of so many ticks at most: far more than its tolerance."""
CYCLE_BITS = 2
"""Cycles, and the frames in them, are told apart by so many bits."""
CYCLES = 1 << CYCLE_BITS
LAST_PHASE = 2
"""Frames that are not late are accepted in phases 1 … LAST_PHASE of their cycle."""


class Scaled(Config):
    """Times of some ticks, which keep what a configuration is held to: τ0 > 2L, τ1 above 2L, the
    skew of decisions above L and twice the margin, the decision inside its cycle."""

    cycle_ticks = 13
    margin_ticks = 1
    latency_ticks = 3
    tau0_ticks = 2 * latency_ticks + 2
    tau1_ticks = 2 * latency_ticks + 4
    decision_ticks = margin_ticks + tau0_ticks + latency_ticks
    skew_ticks = latency_ticks + 3
    not_yet_driving_ticks = 2 * latency_ticks + 1
    period_ticks = 4
    half_period_ticks = 2
    pulse_grace_ticks = 6
    pick_up_ticks = 10
    release_ticks = 14
    test_ticks = 15

    def __post_init__(self) -> None:
        """None of them follows from the fields: what holds between those does not matter."""


PAIR = Scaled(outputs=1, life_cycles=1)


TOLD = (
    f"a cycle of {PAIR.cycle_ticks} ticks, L {PAIR.latency_ticks}, tau0 {PAIR.tau0_ticks}, tau1 "
    f"{PAIR.tau1_ticks}, decision {PAIR.decision_ticks}, skew {PAIR.skew_ticks}, not_yet_driving "
    f"{PAIR.not_yet_driving_ticks}, pick_up {PAIR.pick_up_ticks}, release {PAIR.release_ticks}; "
    f"a clock loses one of {STEADY_TICKS} ticks at most, at any time"
)
"""The scaled constants, for a claim's sentence."""
TIMING = {name: 1 for n in (1, 2) for name in (f"run_{n}", f"delivers_{n}")}
"""Inputs: FPGA n's clock has an edge; the message on FPGA n's line is there, see Line."""


class Clock(wiring.Component):
    """run: in, 1 bit, this tick of the monitor is one of the clock's. steady: out, 1 bit, it loses
    no more than one tick in STEADY_TICKS."""

    def __init__(self) -> None:
        super().__init__({"run": In(1), "steady": Out(1)})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        since = Signal(range(STEADY_TICKS), init=STEADY_TICKS - 1)
        rested = since == STEADY_TICKS - 1
        m.d.comb += self.steady.eq(self.run | rested)
        m.d.sync += since.eq(Mux(self.run, since + ~rested, 0))
        return m


class Line(wiring.Component):
    """Carries messages one after the other, each for as long as it likes.

    sent: in, what a message tells that is taken up in this tick. delivers: in, 1 bit, the one under
    way is there from the next tick on, and the next one is taken up. carried, told: out, what the
    one under way tells, what the last one has told. in_time: out, 1 bit, that was so no longer than
    latency_ticks ago.
    """

    def __init__(self, width: int, latency_ticks: int) -> None:
        self._latency_ticks = latency_ticks
        super().__init__(
            {"sent": In(width), "delivers": In(1), "in_time": Out(1)}
            | {"carried": Out(width), "told": Out(width)}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        late = self._latency_ticks + 1
        carried_age, age = Signal(range(late + 1)), Signal(range(late + 1))
        older = carried_age + (carried_age != late)
        m.d.comb += self.in_time.eq(age != late)
        m.d.sync += [age.eq(age + (age != late)), carried_age.eq(older)]
        with m.If(self.delivers):
            m.d.sync += [self.told.eq(self.carried), age.eq(older)]
            m.d.sync += [self.carried.eq(self.sent), carried_age.eq(1)]
        return m


class Pair(Monitor):
    """Both channels with their own wiring, of which is cut out what brings them frames, messages,
    time and feedback, and the test of the shut-off paths; also the blocks of the names `cut`.

    inputs: those of the monitor, beside TIMING and, for FPGA n: accepts_n, its CPU's frame of this
    cycle is accepted; images_n, in tick 0, bit k is that frame's image in cycle k.
    Assumed is that clocks are steady, messages in time, and frames in phases 1 … last_phase, one a
    cycle at most and apart_ticks or more apart. Each CPU numbers its frames as the cycles; time
    begins in first_phase, FPGA 2's up to two margins after FPGA 1's.
    """

    def __init__(
        self,
        inputs: Mapping[str, int],
        cut: Iterable[str] = (),
        *,
        first_phase: int = 0,
        last_phase: int = LAST_PHASE,
        apart_ticks: int = 1,
    ) -> None:
        frames = {f"accepts_{n}": 1 for n in (1, 2)}
        images = {f"images_{n}": CYCLES for n in (1, 2)}
        super().__init__({**TIMING, **frames, **images, **inputs})
        self._cut, self._first_phase = tuple(cut), first_phase
        self._last_phase, self._apart_ticks = last_phase, apart_ticks
        self.legal: list[Value] = []
        self.punctual: list[Value] = []  # for each CPU, its frame of this cycle is not late
        self.contact = Signal()

    def pair(self, m: Module) -> tuple[Internals, Internals]:
        """Adds both, and what is between them."""
        tick = Signal(range(2 * PAIR.margin_ticks + 1))
        begins = tick != 2 * PAIR.margin_ticks
        m.d.sync += tick.eq(tick + begins)
        lines = [Line(6 + CYCLE_BITS, PAIR.latency_ticks) for _ in range(2)]
        channels = []
        for n, (own, peers) in enumerate((lines, lines[::-1]), 1):
            run = getattr(self, f"run_{n}")
            m.submodules[f"clock_{n}"] = clock = Clock()
            m.submodules[f"line_{n}"] = own
            inner = self._channel(m, n, peers.told)
            m.submodules[f"fpga_{n}"] = EnableInserter(run)(inner)
            m.d.comb += [
                clock.run.eq(run),
                own.delivers.eq(getattr(self, f"delivers_{n}")),
                own.sent.eq(self._sent(inner)),
            ]
            self.legal += [clock.steady | begins if n == 2 else run, own.in_time]
            channels.append(inner)
        return channels[0], channels[1]

    def _sent(self, inner: Internals) -> Value:
        own = inner["vote.own"]
        told = [inner["output_0.code"]] if "Output" not in self._cut else [Const(0, 2)]
        told += [inner["vote.carries"], inner["vote.passed"], own.image, own.acknowledge]
        return Cat(*told, own.sequence[:CYCLE_BITS])

    def _channel(self, m: Module, n: int, message: Value) -> Internals:
        from railgate.vital_output.gateware import channel

        run, accepts = getattr(self, f"run_{n}"), getattr(self, f"accepts_{n}")
        cycle, phase = self._time(m, n, run)
        accepted, first, drove = (
            Signal(name=f"{name}_{n}") for name in ("accepted", "past", "drove")
        )
        rests = Signal(range(self._apart_ticks), name=f"rests_{n}")  # no frame for so long
        images, seen = (
            Signal(CYCLES, name=f"image_of_{n}"),
            Signal(CYCLE_BITS + 1, name=f"seen_{n}"),
        )
        carries, passed, image, acknowledge = message[2:6]
        number = message[6:]
        fresh = carries & (seen != Cat(number, 1))
        m.d.sync += first.eq(1)
        with m.If(~first):
            m.d.sync += images.eq(getattr(self, f"images_{n}"))
        with m.If(run):
            m.d.sync += [
                accepted.eq((accepted | accepts) & (phase != PAIR.cycle_ticks - 1)),
                rests.eq(Mux(accepts, self._apart_ticks - 1, rests - (rests != 0))),
            ]
        with m.If(run & fresh):
            m.d.sync += seen.eq(Cat(number, 1))
        in_phase = (phase >= 1) & (phase <= self._last_phase)
        self.legal.append(~accepts | (in_phase & first & ~accepted & (rests == 0)))
        self.punctual.append((phase <= LAST_PHASE) | accepted)

        told: Told = {
            "Command": {
                "accepted": accepts,
                "frame_index": cycle,
                "sequence": cycle,
                "image": images.bit_select(cycle, 1),
            },
            "FrameCheck": {"done": fresh, "good": fresh, "good_index": number},
            "LinkReceiver": {
                "peer_ok": Const(1),
                "peer_codes": message[:2],
                "peer_carries": carries,
                "peer_passed": passed,
                "peer_sequence": number,
                "peer_image": image,
                "peer_acknowledge": acknowledge,
            },
            "LinkTransmitter": {},
            "Timekeeper": {"index": cycle, "decides": phase == PAIR.decision_ticks},
            "Shutoff": {"both_done": Const(1)},
            "Feedback": {
                "frequency": Const(1),
                "contact": self.contact,
                "fb": self.contact | drove,
            },
            "Status": {},
            **{name: {} for name in self._cut},
        }
        inner = cut(channel, "Channel", (PAIR, n - 1), told)
        with m.If(run):
            m.d.sync += drove.eq(self.drives(inner))
        return inner

    def _time(self, m: Module, n: int, run: Value) -> tuple[Signal, Signal]:
        """Cycle and phase by the channel's own clock."""
        cycle = Signal(CYCLE_BITS, name=f"cycle_{n}")
        phase = Signal(range(PAIR.cycle_ticks), init=self._first_phase, name=f"phase_{n}")
        ends = phase == PAIR.cycle_ticks - 1
        with m.If(run):
            m.d.sync += [phase.eq(Mux(ends, 0, phase + 1)), cycle.eq(cycle + ends)]
        return cycle, phase

    def drives(self, inner: Internals) -> Value:
        return Const(0) if "Output" in self._cut else inner["output_0.state"] == State.DRIVE

    def relay(self, m: Module, channels: Iterable[Internals]) -> None:
        """Its contact closes after 3 ticks in which both drive, and opens after 3 without."""
        both = Cat(self.drives(channel) for channel in channels).all()
        before = Signal(2)
        m.d.sync += before.eq(Cat(both, before))
        with m.If(both & before.all()):
            m.d.sync += self.contact.eq(1)
        with m.Elif(~both & ~before.any()):
            m.d.sync += self.contact.eq(0)
