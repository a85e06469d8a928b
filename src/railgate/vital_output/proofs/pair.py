"""Two channels with clocks of their own and a cross-link of any latency up to L."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from amaranth.hdl import Cat, EnableInserter, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.proving import Internals, Monitor
from railgate.vital_output.proofs.cut import cut
from railgate.vital_output.spec import Config, State

__all__ = ["CLOCKS", "LINKS", "PAIR", "Clock", "Line", "Pair", "Scaled"]

STEADY_TICKS = 32
"""A clock loses one tick in so many at most."""
NUMBER_BITS = 3
"""Cycles are told apart by their lowest bits."""


class Scaled(Config):
    """Times of some ticks, which keep what a configuration is held to: τ0 > 2L, τ1 and the skew of
    decisions above what they cover, the decision inside its cycle."""

    cycle_ticks = 15
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
CLOCKS = {"run_1": 1, "run_2": 1}
LINKS = {"sends_1": 1, "sends_2": 1, "delivers_1": 1, "delivers_2": 1}


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

    sent: in, what a message tells. sends: in, 1 bit, one is taken up in this tick, if none is under
    way. delivers: in, 1 bit, the one under way is there from the next tick on. told: out, what the
    last one told. in_time: out, 1 bit, that was so no longer ago than `latency_ticks`.
    """

    def __init__(self, width: int, latency_ticks: int) -> None:
        self._latency_ticks = latency_ticks
        super().__init__(
            {
                "sent": In(width),
                "sends": In(1),
                "delivers": In(1),
                "told": Out(width),
                "in_time": Out(1),
            }
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        ages = range(self._latency_ticks + 2)
        carried, carries = Signal.like(self.sent), Signal()
        carried_age, age = Signal(ages), Signal(ages)  # ticks since it was taken up
        most = self._latency_ticks + 1
        m.d.comb += self.in_time.eq(age != most)
        m.d.sync += age.eq(age + (age != most))
        m.d.sync += carried_age.eq(carried_age + (carried_age != most))
        with m.If(carries & self.delivers):
            m.d.sync += [self.told.eq(carried), carries.eq(0)]
            m.d.sync += age.eq(carried_age + (carried_age != most))
        with m.If(self.sends & (~carries | self.delivers)):
            m.d.sync += [carried.eq(self.sent), carries.eq(1), carried_age.eq(1)]
        return m


class Pair(Monitor):
    """Both channels of one output, their wiring, votes, storage and outputs; one relay.

    Cut out is what they get frames, messages, time and feedback by. run_n: FPGA n's clock. sends_n,
    delivers_n: its line, see Line. accepts_n: its CPU's frame of this cycle is accepted. images_n:
    bit k is the image of all frames of cycle k of that CPU, as in tick 0.
    Assumed is that clocks are steady, messages come in time, and frames in the cycle's first ticks.
    """

    def __init__(
        self, config: Config, inputs: Mapping[str, int], lemmas: Iterable[str] = ()
    ) -> None:
        frames = {f"{name}_{n}": 1 for name in ("accepts",) for n in (1, 2)}
        images = {f"images_{n}": 1 << NUMBER_BITS for n in (1, 2)}
        super().__init__({**CLOCKS, **LINKS, **frames, **images, **inputs}, lemmas)
        self.config = config
        self.legal: list[Value] = []
        self.contact = Signal()

    def pair(self, m: Module) -> tuple[Internals, Internals]:
        """Adds both, and all between them."""
        channels, clocks = [], []
        for n in (1, 2):
            m.submodules[f"clock_{n}"] = clock = Clock()
            m.d.comb += clock.run.eq(getattr(self, f"run_{n}"))
            self.legal.append(clock.steady)
            clocks.append(clock)
        lines = []
        width = 2 + 2 + NUMBER_BITS + 2
        for n in (1, 2):
            m.submodules[f"line_{n}"] = line = Line(width, self.config.latency_ticks)
            m.d.comb += [
                line.sends.eq(getattr(self, f"sends_{n}")),
                line.delivers.eq(getattr(self, f"delivers_{n}")),
            ]
            self.legal.append(line.in_time)
            lines.append(line)
        for n in (1, 2):
            channels.append(self._channel(m, n, getattr(self, f"run_{n}"), lines[2 - n]))
        for channel, line in zip(channels, lines, strict=True):
            own = channel["vote.own"]
            m.d.comb += line.sent.eq(
                Cat(
                    channel["output_0.code"],
                    channel["vote.carries"],
                    channel["vote.passed"],
                    own.sequence[:NUMBER_BITS],
                    own.image,
                    own.acknowledge,
                )
            )
        return channels[0], channels[1]

    def _channel(self, m: Module, n: int, run: Value, line: Line) -> Internals:
        from railgate.vital_output.gateware import channel

        config = self.config
        cycle, phase = (
            Signal(NUMBER_BITS, name=f"cycle_{n}"),
            Signal(range(config.cycle_ticks), name=f"phase_{n}"),
        )
        with m.If(run):
            m.d.sync += phase.eq(phase + 1)
            with m.If(phase == config.cycle_ticks - 1):
                m.d.sync += [phase.eq(0), cycle.eq(cycle + 1)]
        images, first = (
            Signal(1 << NUMBER_BITS, name=f"all_images_{n}"),
            Signal(init=1, name=f"first_{n}"),
        )
        m.d.sync += first.eq(0)
        with m.If(first):
            m.d.sync += images.eq(getattr(self, f"images_{n}"))

        code, carries, passed = line.told[:2], line.told[2], line.told[3]
        number, image, acknowledge = line.told[4 : 4 + NUMBER_BITS], line.told[-2], line.told[-1]
        seen, any_seen, fresh = (
            Signal(NUMBER_BITS, name=f"seen_{n}"),
            Signal(name=f"any_seen_{n}"),
            Signal(name=f"fresh_{n}"),
        )
        m.d.comb += fresh.eq(carries & (~any_seen | (number != seen)))
        with m.If(run & fresh):
            m.d.sync += [seen.eq(number), any_seen.eq(1)]

        accepts, accepted = (
            getattr(self, f"accepts_{n}"),
            Signal(name=f"accepted_{n}"),
        )  # of this cycle
        with m.If(run):
            m.d.sync += accepted.eq((accepted | accepts) & (phase != config.cycle_ticks - 1))
        may = (phase >= 1) & (phase <= 2) & ~accepted & ~first
        self.legal.append(~accepts | may)
        self.due = [*getattr(self, "due", []), (phase <= 2) | accepted]

        drove = Signal(name=f"drove_{n}")
        told = {
            "Command": {
                "accepted": accepts,
                "frame_index": cycle,
                "sequence": cycle,
                "image": images.bit_select(cycle, 1),
            },
            "FrameCheck": {"done": fresh, "good": fresh, "good_index": number},
            "LinkReceiver": {
                "peer_ok": 1,
                "peer_carries": carries,
                "peer_passed": passed,
                "peer_sequence": number,
                "peer_image": image,
                "peer_acknowledge": acknowledge,
                "peer_codes": code,
            },
            "LinkTransmitter": {},
            "Timekeeper": {"index": cycle, "decides": phase == config.decision_ticks},
            "Shutoff": {"both_done": 1},
            "Feedback": {"frequency": 1, "contact": self.contact, "fb": self.contact | drove},
            "Status": {},
        }
        told = {
            name: {k: Value.cast(v) for k, v in values.items()} for name, values in told.items()
        }
        inner = cut(channel, "Channel", (config, n - 1), told)
        m.submodules[f"fpga_{n}"] = EnableInserter(run)(inner)
        with m.If(run):
            m.d.sync += drove.eq(inner["output_0.state"] == State.DRIVE)
        return inner

    def relay(self, m: Module, channels: Iterable[Internals]) -> None:
        """Its contact closes once both have driven for two ticks, and opens two after."""
        drive = Cat(channel["output_0.state"] == State.DRIVE for channel in channels).all()
        before, earlier = Signal(), Signal()
        m.d.sync += [before.eq(drive), earlier.eq(before)]
        with m.If(drive & before & earlier):
            m.d.sync += self.contact.eq(1)
        with m.Elif(~(drive | before | earlier)):
            m.d.sync += self.contact.eq(0)
