"""The own CPU's frames: which of them are accepted."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from amaranth.hdl import Cat, Module, Mux, Signal, Value

from railgate.proving import Claim, Induction, Internals, Monitor, Mutant, Run
from railgate.vital_output.proofs.cut import cut
from railgate.vital_output.proofs.stimuli import Step, mutant, trace
from railgate.vital_output.spec import Cause, Config, pack
from railgate.waves import Trace

__all__ = ["CLAIMS"]

CONFIG = Config(outputs=3)
BYTES = CONFIG.layout.frame_bytes
INPUTS = {
    "data": 8,
    "first": 1,
    "last": 1,
    "valid": 1,
    "lifeless": 1,
    "life_ends": 1,
    "cause": 5,
    "good_index": 32,
}


class _Command(Monitor):
    """The command, its check cut out: the verdict is free, in its time. What the contract makes of
    bytes and verdicts beside it.

    data, first, last, valid: in, the stream. cause: in, 5 bits, the check's, NONE is good.
    lifeless, life_ends, good_index: in, as the command's.
    """

    def __init__(self, *lemmas: str) -> None:
        super().__init__(INPUTS, ("checks", "bytes", *lemmas))
        self.check_left = Signal(range(CONFIG.check_ticks + 1))  # ticks of the check with this one
        self.frame = Signal(8 * BYTES)

    def command(self, m: Module) -> Internals:
        from railgate.vital_output.gateware import command

        done = self.check_left == 1
        told = {
            "done": done,
            "due": self.check_left == 2,
            "good": self.cause == Cause.NONE,
            "cause": self.cause,
            "good_index": self.good_index,
        }
        m.submodules.dut = inner = cut(command, "Command", (CONFIG, 0), {"FrameCheck": told})
        byte = inner["command.payload"]
        m.d.comb += [
            byte.data.eq(self.data),
            byte.first.eq(self.first),
            byte.last.eq(self.last),
            inner["command.valid"].eq(self.valid),
            inner["lifeless"].eq(self.lifeless),
            inner["life_ends"].eq(self.life_ends),
        ]
        self.transfer = self.valid & (self.check_left <= 1)
        with m.If(self.transfer & self.last):
            m.d.sync += self.check_left.eq(CONFIG.check_ticks)
        with m.Elif(self.check_left != 0):
            m.d.sync += self.check_left.eq(self.check_left - 1)
        with m.If(self.transfer):
            m.d.sync += self.frame.eq(Cat(self.data, self.frame))
        m.d.comb += [
            self.lemma.checks.eq(
                (inner["command.ready"] == (self.check_left <= 1))
                & (self.check_left <= CONFIG.check_ticks)
            ),
            self.lemma.bytes.eq(inner["frame"] == self.frame),
        ]
        return inner

    def field(self, name: str, frame: Value) -> Value:
        """That field of a frame, its first byte in the highest bits."""
        low = 0
        for field in reversed(CONFIG.layout.frame):
            if field.name == name:
                return frame[low : low + field.width]
            low += field.width
        raise ValueError(f"a frame must have a field {name}")


class _Form(_Command):
    """A check begins with each frame's last byte, of its fields as they came; malformed is what is
    not begun just once, not as long as a frame, or sets bits of no output."""

    def __init__(self) -> None:
        super().__init__("form")

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.command(m)
        count = Signal(range(BYTES + 2))  # bytes of this frame, BYTES + 1 of more
        firsts = Signal(range(3))  # since the frame before, 2 of more
        count_now = Mux(self.first, 1, Mux(count == BYTES + 1, count, count + 1))
        firsts_now = Mux(firsts == 2, 2, firsts + self.first)
        with m.If(self.transfer):
            m.d.sync += [count.eq(count_now), firsts.eq(Mux(self.last, 0, firsts_now))]

        starts = self.transfer & self.last
        frame = Cat(self.data, self.frame)[: 8 * BYTES]
        fields = {
            name: self.field(name, frame) for name in ("sequence", "image", "acknowledge", "crc")
        }
        beyond = Cat(fields[name][CONFIG.outputs :] for name in ("image", "acknowledge"))
        malformed = (firsts_now != 1) | (count_now != BYTES) | beyond.any()
        as_sent = Cat(
            inner[f"check.frame.{name}"] == value[: len(inner[f"check.frame.{name}"])]
            for name, value in fields.items()
        )
        m.d.comb += [
            self.lemma.form.eq(
                (inner["begun"] == (firsts != 0))
                & (inner["repeated"] == (firsts == 2))
                & ((firsts == 0) | (inner["count"] == Mux(count > BYTES, BYTES, count)))
                & ((firsts == 0) | (count >= 1))
                & (count <= BYTES + 1)
                & (firsts <= 2)
            ),
            self.holds.eq(
                (inner["check.start"] == starts)
                & (~starts | ((inner["check.frame.malformed"] == malformed) & as_sent.all()))
            ),
            self.reached.eq(starts & ~malformed),
        ]
        return m


class _Sequence(_Command):
    """A frame is accepted only with a good verdict and a number that is next, or, with a life, up
    to life_cycles ahead; else the cause is the contract's."""

    def __init__(self) -> None:
        super().__init__("step", "reference")

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.command(m)
        reference, referenced = Signal(32), Signal()
        sequence = self.field("sequence", self.frame)
        done, step = self.check_left == 1, (sequence - reference)[:32].as_signed()
        good = done & (self.cause == Cause.NONE)
        ahead = (step == 1) | (~self.lifeless & (step >= 1) & (step <= CONFIG.life_cycles))
        accepted = good & referenced & ahead
        with m.If(self.life_ends):
            m.d.sync += referenced.eq(0)
        with m.If(accepted | (good & self.lifeless)):
            m.d.sync += [reference.eq(sequence), referenced.eq(1)]
        refused = Mux(step == 0, Cause.REPETITION, Mux(step < 0, Cause.RESEQUENCE, Cause.INSERTION))
        cause = Mux(good, Mux(referenced & ~ahead, refused, Cause.NONE), self.cause)
        told = Mux(done, cause, Cause.NONE)
        m.d.comb += [
            self.lemma.step.eq(
                (self.check_left == 0)
                | (self.check_left == CONFIG.check_ticks)
                | (inner["step"] == step)
            ),
            self.lemma.reference.eq(
                (inner["reference"] == reference) & (inner["referenced"] == referenced)
            ),
            self.holds.eq(
                (inner["accepted"] == accepted)
                & (inner["started"] == (good & ~referenced))
                & (inner["cause"] == told)
                & (inner["rejected"] == ((told != Cause.NONE) & (told != Cause.TIME)))
                & (
                    ~accepted
                    | (
                        (inner["lost"] == step - 1)
                        & (inner["frame_index"] == self.good_index)
                        & Cat(
                            inner[name] == self.field(name, self.frame)[: len(inner[name])]
                            for name in ("sequence", "image", "acknowledge", "crc")
                        ).all()
                    )
                )
            ),
            self.reached.eq(accepted & (step == CONFIG.life_cycles)),
        ]
        return m


def _bytes(sequence: int, **others: int) -> list[int]:
    fields = {"sequence": sequence, "image": 5, "acknowledge": 2, "crc": 0x0123_4567}
    return list(pack(CONFIG.layout.frame, fields | others).to_bytes(BYTES, "big"))


def _sent(
    data: list[int], beside: Mapping[str, int] | None = None, firsts: tuple[int, ...] = (0,)
) -> Iterator[Step]:
    """A frame byte by byte, and its check. firsts: the bytes that are told as a first one."""
    beside = beside or {}
    for number, byte in enumerate(data):
        place = {"first": number in firsts, "last": number == len(data) - 1}
        yield 1, {"valid": 1, "data": byte, **place, **beside}
    yield CONFIG.check_ticks, beside


def _frames() -> Trace:
    """Frames in and out of sequence, in and out of form."""
    no_life, corrupted = {"lifeless": 1}, {"lifeless": 1, "cause": Cause.CORRUPTION}
    wrong = {"cause": Cause.FORMAT}
    steps = (
        *(*_sent(_bytes(7), no_life), *_sent(_bytes(8), no_life)),
        *(step for number in (8, 7, 9, 12, 16, 12) for step in _sent(_bytes(number))),
        *(*_sent(_bytes(14), no_life), *_sent(_bytes(17), corrupted)),
        *_sent(_bytes(15), no_life),
        *(*_sent(_bytes(15)[:4], wrong), *_sent(_bytes(15)[4:], wrong, ())),
        *(*_sent(_bytes(15)[:-1], wrong), *_sent([*_bytes(15), 0], wrong)),
        *_sent([0, *_bytes(15)], wrong),
        *_sent([*_bytes(15)[:3], *_bytes(15)], wrong, (0, 3)),
        *(*_sent(_bytes(15, image=13), wrong), *_sent(_bytes(15, acknowledge=8), wrong)),
        *((1, {"life_ends": 1}), *_sent(_bytes(16))),
    )
    return trace(INPUTS, steps)


FRAMES = Run(_frames().end, _frames)


def _mutant(name: str, old: str, new: str) -> Mutant:
    return mutant(name, "command", old, new, FRAMES)


CLAIMS = (
    Claim(
        name="vital_output.command-form",
        claim=(
            "For ever and whatever bytes come, a check begins with each byte told as a last one, "
            "of the fields as they came since the first one, and told malformed just where there "
            "has been no first byte or more than one since the frame before, where they are not "
            "frame_bytes, or where a bit of no output is set (3 outputs, else default "
            "configuration)."
        ),
        requirements=("DRV-1", "DRV-5"),
        monitor=_Form,
        method=Induction(),
        cover=FRAMES,
        mutants=(
            _mutant(
                "longer-will-do",
                "Elif(count != layout.frame_bytes)",
                "Elif(count != layout.frame_bytes - 1)",
            ),
            _mutant("first-twice", "(begun ^ byte.first) & ~repeated", "begun ^ byte.first"),
            _mutant("bits-beyond", "self._beyond(received.acknowledge)", "0"),
            _mutant("never-begun", "(begun ^ byte.first)", "1"),
        ),
    ),
    Claim(
        name="vital_output.command-sequence",
        claim=(
            "For ever, whatever frames come and whatever their checks find, a frame is accepted "
            "only check_ticks after its last byte, with the verdict good, and a sequence number "
            "one ahead of the reference or, with a life, up to life_cycles: never one that stands "
            "or falls, nor the first after a reset or the life's end; each other frame has the "
            "contract's cause (3 outputs, else default configuration; the check is cut out, its "
            "verdict is free)."
        ),
        requirements=("DRV-5",),
        monitor=_Sequence,
        fast=False,
        method=Induction(),
        cover=FRAMES,
        mutants=(
            _mutant("repetition", "~self.lifeless & (step >= 1)", "~self.lifeless & (step >= 0)"),
            _mutant(
                "one-lost-too-many",
                "(step <= self._config.life_cycles)",
                "(step <= self._config.life_cycles + 1)",
            ),
            _mutant("skips-without-life", "within = ~self.lifeless &", "within ="),
            _mutant(
                "reference-outlives", "m.d.sync += referenced.eq(0)", "m.d.sync += reference.eq(0)"
            ),
            _mutant("accepts-the-first", "good & referenced & ((step", "good & ((step"),
            _mutant(
                "bad-verdict-refers",
                "self.accepted | (good & self.lifeless)",
                "self.accepted | (check.done & self.lifeless)",
            ),
        ),
    ),
)
