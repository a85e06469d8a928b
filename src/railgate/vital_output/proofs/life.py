"""The life of a command: by the channel's own time, from the frame's last byte to the forced 0."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Mux, Signal, Value

from railgate.proving import Claim, Induction, Internals, Run
from railgate.vital_output.proofs.free import Free, widths
from railgate.vital_output.proofs.stimuli import Step, mutant, trace
from railgate.vital_output.spec import Config
from railgate.waves import Trace

__all__ = ["CLAIMS"]

CONFIG = Config(outputs=1)
TIME = {
    "time_valid": 1,
    "time_index": 32,
    "time_phase": (CONFIG.cycle_ticks - 1).bit_length(),
}
FRAME = {"last": 1, "which": 2}
LIFE = CONFIG.life_cycles
LONGEST = CONFIG.cycle_ticks + CONFIG.slew_ticks


class _Life(Free):
    """The image is 0 within life_bound_ticks of the last byte of the frame that was stored.

    last: in, 1 bit, a frame's last byte. which: in, 2 bits, how far the cycle that its CRC is for
    is ahead of the own one, less 1. time_valid, time_index, time_phase: in, the network's time.
    Assumed is of Command what the contract tells: a frame is accepted check_ticks after its last
    byte, if its index was acceptable then.
    """

    def __init__(self) -> None:
        super().__init__(
            CONFIG, 0, TIME | FRAME, ("sound", "time", "window", "checked", "waits", "lives")
        )
        ages = range(2 * CONFIG.life_bound_ticks)
        self.check_age, self.own_age, self.age = (
            Signal(ages, name=f"{name}_age") for name in ("check", "own", "stored")
        )
        self.check_index, self.checks = Signal(32), Signal()  # of an acceptable frame

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.channel(m)
        for part in ("valid", "index", "phase"):
            m.d.comb += inner[f"time.{part}"].eq(getattr(self, f"time_{part}"))
        life, image = inner["life"], inner["image"]
        self._frames(m, inner)
        fresh = self.last | self.checks | inner["vote.own_there"] | inner["vote.open"]
        m.d.comb += [
            self.assumed.eq(
                ~(self.last & self.checks)
                & (~self.accepted | self._verdict())
                & ~(fresh & inner["timekeeper.seats"])
            ),
            self.lemma.lives.eq(self._lives(inner) & ((life != 0) | (image == 0))),
            self.holds.eq(
                Mux(life == 0, image == 0, (life <= LIFE) & (self.age < CONFIG.life_bound_ticks))
            ),
            self.reached.eq(
                (image != 0) & inner["storage.life_out"] & (self.age == CONFIG.life_bound_ticks - 1)
            ),
        ]
        self._bind(m, inner)
        return m

    def _verdict(self) -> Value:
        """The frame under check can be accepted."""
        due = self.checks & (self.check_age == CONFIG.check_ticks)
        return due & (self.own_index == self.check_index)

    def _frames(self, m: Module, inner: Internals) -> None:
        """Follows each frame from its last byte on."""
        phase = inner["timekeeper.phase"]
        for age in (self.check_age, self.own_age, self.age):
            m.d.sync += age.eq(_older(age))
        acceptable = Cat(
            phase < CONFIG.margin_ticks, 1, phase >= CONFIG.cycle_ticks - CONFIG.margin_ticks, 0
        )
        good = inner["timekeeper.trusted"] & acceptable.bit_select(self.which, 1)
        with m.If(self.last & good):
            index = inner["timekeeper.index"] + self.which - 1
            m.d.sync += [self.checks.eq(1), self.check_age.eq(1), self.check_index.eq(index)]
        with m.Elif(self.check_age == CONFIG.check_ticks):
            m.d.sync += self.checks.eq(0)
        with m.If(self.accepted):
            m.d.sync += self.own_age.eq(_older(self.check_age))
        with m.If(inner["vote.stored"]):
            m.d.sync += self.age.eq(_older(self.own_age))

    def _bind(self, m: Module, inner: Internals) -> None:
        """The invariants of time, of the frame under check, and of the one that waits."""
        config, phase = CONFIG, inner["timekeeper.phase"]
        pending, remaining = inner["timekeeper.pending"], inner["vote.held_remaining.value"]
        own_there, forwarded_there = inner["vote.own_there"], inner["vote.forwarded_there"]
        most = config.margin_ticks + config.slew_ticks
        latest = config.margin_ticks + config.check_ticks
        alive = self.checks | own_there | inner["vote.open"] | (inner["life"] != 0)
        next_cycle = self._since(inner, self.check_index, 1)
        own_index = inner["vote.own"].index
        own_next_cycle = self._since(inner, own_index, 1)
        m.d.comb += [
            self.lemma.time.eq(
                (pending >= -most)
                & (pending <= most)
                & (phase < LONGEST)
                & (inner["timekeeper.seated"] | ~(inner["timekeeper.consistent"] | alive))
            ),
            self.lemma.window.eq(
                (remaining <= config.tau0_ticks)
                & ((remaining != 0) | ~(own_there | forwarded_there))
                & ~(own_there & inner["vote.open"])
            ),
            self.lemma.checked.eq(
                ~self.checks
                | (
                    (self.check_age >= 1)
                    & (self.check_age <= config.check_ticks)
                    & self._within(inner, self.check_index, self.check_age, 1)
                    & (~next_cycle | (phase < config.margin_ticks + self.check_age))
                )
            ),
            self.lemma.waits.eq(
                ~(own_there | inner["vote.open"])
                | (
                    self._within(inner, own_index, self.own_age, 1)
                    & (
                        ~own_next_cycle
                        | Mux(
                            own_there,
                            phase + remaining <= latest + config.tau0_ticks,
                            phase <= config.decision_ticks,
                        )
                    )
                )
            ),
        ]

    def _since(self, inner: Internals, index: Value, cycles: int) -> Value:
        """The own time's cycle is so many after that one."""
        return inner["timekeeper.index"] == (index + cycles)[:32]

    def _within(self, inner: Internals, index: Value, age: Value, most: int) -> Value:
        """A frame of cycle `index` is no older than its margin before that cycle's start, which is
        `most` cycles ago at most."""
        phase, margin = inner["timekeeper.phase"], CONFIG.margin_ticks
        before = self._since(inner, index, -1) & (age + CONFIG.cycle_ticks - margin <= phase)
        start = margin + CONFIG.slew_ticks + phase
        return (
            before
            | Cat(
                self._since(inner, index, cycles) & (age <= start + cycles * LONGEST)
                for cycles in range(most + 1)
            ).any()
        )

    def _lives(self, inner: Internals) -> Value:
        """With each life the stored frame's cycle is as many cycles ago as that has taken."""
        life, phase = inner["life"], inner["timekeeper.phase"]
        index = inner["storage.stored_index"]
        decided = phase > CONFIG.decision_ticks
        since = [self._since(inner, index, cycles) for cycles in range(LIFE + 2)]
        ages = [
            (life == LIFE - lost) & ((since[lost + 1] & decided) | (since[lost + 2] & ~decided))
            for lost in range(1, LIFE)
        ]
        fresh = self._since(inner, index, -1) | since[0] | since[1] | (since[2] & ~decided)
        full = (life == LIFE) & fresh
        return (life == 0) | (
            (full | Cat(*ages).any()) & self._within(inner, index, self.age, LIFE + 1)
        )


def _older(age: Signal) -> Value:
    return age + ~age.all()


def _longest() -> Trace:
    """A frame as early as it can be for its cycle, in a time that is as slow as it can be."""
    config = CONFIG
    early = config.cycle_ticks - config.margin_ticks
    peer = {"peer_ok": 1, "peer_passed": 1, "peer_carries": 1}
    frame = {"image": 1, "peer_image": 1, "own_index": 1, "forwarded_index": 1} | peer
    steps: tuple[Step, ...] = (
        (1, {"time_valid": 1}),
        (config.margin_ticks, {}),
        (1, {"time_valid": 1, "time_phase": 1}),
        (early - config.margin_ticks - 2, {}),
        (1, {"last": 1, "which": 2}),
        (config.check_ticks - 1, {}),
        (1, {"accepted": 1, "forwarded": 1} | frame),
        (config.life_bound_ticks, peer),
    )
    return trace(widths(CONFIG) | TIME | FRAME, steps)


LONGEST_LIFE = Run(_longest().end, _longest)

CLAIMS = (
    Claim(
        name="vital_output.life-bound",
        claim=(
            "For ever and whatever the CPU, the peer and the network tell, the image is 0 at the "
            "latest life_bound_ticks after the last byte of the frame last stored, by the own "
            "ticks, and that late it may be; without a life it is 0 (1 output, else default "
            "configuration; the command's frames come as its contract has them, its check is cut "
            "out). Assumed is that the network does not seat the time between a frame's last byte "
            "and its store: where it does so again and again, the bound does not hold."
        ),
        requirements=("DRV-7", "DRV-16"),
        monitor=_Life,
        method=Induction(),
        cover=LONGEST_LIFE,
        mutants=(
            mutant("a-cycle-more", "storage", "(ahead < 0)", "(ahead < -1)", LONGEST_LIFE),
            mutant(
                "stays-at-one",
                "storage",
                "self.life_out.eq(falls & (life.value == 1))",
                "self.life_out.eq(0)",
                LONGEST_LIFE,
            ),
            mutant(
                "a-tick-late",
                "timekeeper",
                "self.decides.eq(self.phase == config.decision_ticks)",
                "self.decides.eq(self.phase == config.decision_ticks + 1)",
                LONGEST_LIFE,
            ),
        ),
        fast=False,
    ),
)
