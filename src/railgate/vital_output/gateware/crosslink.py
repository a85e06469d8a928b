"""The cross-link: messages of the own state to the peer, and what the peer's tell."""

from __future__ import annotations

from amaranth.hdl import Cat, Const, Module, Signal
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from railgate.primitives import FilteredInput, SerialCheck, SerialReceiver, SerialTransmitter
from railgate.vital_output.gateware.oscillator import MOST_STEPS, Oscillator
from railgate.vital_output.spec import Config
from railgate.vital_output.spec.frame import CRC_BITS

__all__ = ["LinkReceiver", "LinkTransmitter"]

MADE_HERE = ("number", "digest", "crc")
"""Fields of a message that the cross-link makes and compares itself."""
FORWARDED = ("sequence", "image", "acknowledge", "frame_crc")
FIRST_START = 8
"""The tick in which message 0 begins on the line."""


def message_fields(config: Config) -> dict[str, int]:
    """The widths of the fields that a message is sent for."""
    return {
        field.name: field.width for field in config.layout.message if field.name not in MADE_HERE
    }


def message_check(config: Config, board: int) -> SerialCheck:
    """The check of messages that this one of config.boards sends."""
    check = config.layout.message_check(config.boards[board])
    return SerialCheck(check.width, check.polynomial, check.initial, check.final)


class LinkTransmitter(wiring.Component):
    """Sends a message every link_period_ticks.

    board: which of config.boards is the own one.
    One in of each of message_fields, read two ticks before the message begins on the line; but
    `boot`, 16 bits, is read in tick 0. link_tx: out, 1 bit, register, the line. Requirement DRV-6.
    """

    def __init__(self, config: Config, board: int) -> None:
        self._config = config
        self._board = board
        super().__init__(
            {name: In(width) for name, width in message_fields(config).items()}
            | {"link_tx": Out(1, init=1)}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        config = self._config
        lead = FIRST_START - 2  # two registers on the way to the line
        until_bit = Signal(range(max(lead + 1, config.bit_ticks)), init=lead)
        period_bits = config.link_period_ticks // config.bit_ticks
        bit = Signal(range(period_bits))
        number = Signal(8)

        strobe = until_bit == 0
        starts = strobe & (bit == 0)
        m.d.sync += until_bit.eq(until_bit - 1)
        with m.If(strobe):
            m.d.sync += [until_bit.eq(config.bit_ticks - 1), bit.eq(bit + 1)]
            with m.If(bit == period_bits - 1):
                m.d.sync += bit.eq(0)
        with m.If(starts):
            m.d.sync += number.eq(number + 1)

        boot = Signal.like(self.boot)
        booted = Signal()
        m.d.sync += booted.eq(1)
        with m.If(~booted):
            m.d.sync += boot.eq(self.boot)

        values = {name: getattr(self, name) for name in message_fields(config)}
        values |= {"number": number, "boot": boot, "digest": Const(config.digest, 32)}
        fields = reversed(config.layout.message[:-1])
        message = Cat(*(values[field.name] for field in fields), Const(0, 1))
        m.submodules.line = line = SerialTransmitter(len(message), CRC_BITS)
        m.submodules.check = check = message_check(config, self._board)
        m.d.comb += [
            line.strobe.eq(strobe),
            line.start.eq(starts),
            line.frame.eq(message),
            line.tail.eq(check.field),
            check.restart.eq(starts),
            check.enable.eq(strobe & ~starts),
            check.bit.eq(line.bit),
        ]
        m.d.sync += self.link_tx.eq(~line.valid | line.data)
        return m


class LinkReceiver(wiring.Component):
    """Takes the peer's messages, and tells the state of the link and of the peer's clock.

    board: which of config.boards is the own one; messages must be the other's.
    link_rx: in, 1 bit, the pin, asynchronous. linked: out, 1 bit, register, messages come.
    drifting: out, 1 bit, register, see Oscillator. peer_ok: out, 1 bit, linked and not drifting.
    One out of each of message_fields, with `peer_` before its name: register, of the message last
    taken.
    Events, 1 bit each: taken: out, a message is; its new fields are in these registers from the
    next tick on. booted: out, taken from a peer that has started anew. bad_check, bad_digest,
    bad_sequence, lost, off_frequency: out, see Cause: LINK_CHECK, LINK_DIGEST, LINK_SEQUENCE,
    LINK_LOST, OSCILLATOR. fresh_frame: out, a frame to be checked is taken; with it are valid:
    new_sequence, new_image, new_acknowledge, new_frame_crc: out, its fields. Requirements DRV-5,
    DRV-6, DRV-17, SYS-5.
    """

    def __init__(self, config: Config, board: int) -> None:
        self._config = config
        self._board = board
        widths = message_fields(config)
        states = ("linked", "drifting", "peer_ok")
        causes = ("bad_check", "bad_digest", "bad_sequence", "lost", "off_frequency")
        super().__init__(
            {"link_rx": In(1)}
            | {name: Out(1) for name in (*states, *causes, "taken", "booted", "fresh_frame")}
            | {f"peer_{name}": Out(width) for name, width in widths.items()}
            | {f"new_{name}": Out(widths[name]) for name in FORWARDED}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        config = self._config
        m.submodules.input = pin = FilteredInput(config.link_filter_ticks)
        m.submodules.line = line = SerialReceiver(config.bit_ticks, config.layout.message_bits)
        m.submodules.check = check = message_check(config, 1 - self._board)
        m.submodules.oscillator = oscillator = Oscillator(config)
        m.d.comb += [
            pin.pin.eq(self.link_rx),
            line.level.eq(pin.level),
            line.fall.eq(pin.fall),
            check.restart.eq(line.starts),
            check.enable.eq(line.bit),
            check.bit.eq(line.data),
        ]
        layout = data.StructLayout(
            {field.name: field.width for field in reversed(config.layout.message)}
        )
        # A message is compared while its last bit is sampled, so that its verdict need not wait.
        coming = layout(Cat(line.data, line.word)[:-1])
        message = layout(line.word)

        known = Signal()
        digest_differs = Signal()
        step = Signal(8)
        number = Signal(8)
        numbered = Signal()
        m.d.sync += [
            known.eq(check.field == line.data << CRC_BITS - 1),  # the CRC's last bit alone is left
            digest_differs.eq(coming.digest != config.digest),
            step.eq(coming.number - number),
        ]
        follows = (step >= 1) & (step <= MOST_STEPS)
        peers = line.done & known & ~digest_differs
        m.d.comb += [
            self.bad_check.eq(line.false_start | (line.done & ~known)),
            self.bad_digest.eq(line.done & known & digest_differs),
            self.bad_sequence.eq(peers & self.linked & ~follows),
            self.taken.eq(peers & ((self.linked & follows) | (numbered & (step == 1)))),
        ]
        with m.If(peers & ~self.bad_sequence):
            m.d.sync += [number.eq(message.number), numbered.eq(1)]
        self._supervise(m, numbered)
        self._keep(m, message, coming)

        m.d.comb += [
            oscillator.linked.eq(self.linked),
            oscillator.taken.eq(self.taken),
            oscillator.step.eq(step),
            self.off_frequency.eq(oscillator.off_frequency),
            self.drifting.eq(oscillator.drifting),
            self.peer_ok.eq(self.linked & ~self.drifting),
        ]
        return m

    def _supervise(self, m: Module, numbered: Signal) -> None:
        """The link comes with a message taken, and goes after too long a silence."""
        silence = Signal(range(self._config.lost_ticks))
        m.d.comb += self.lost.eq(
            self.linked & ~self.taken & (silence == self._config.lost_ticks - 1)
        )
        m.d.sync += silence.eq(silence + 1)
        with m.If(self.lost):
            m.d.sync += [self.linked.eq(0), numbered.eq(0)]
        with m.If(self.taken):
            m.d.sync += [self.linked.eq(1), silence.eq(0)]

    def _keep(self, m: Module, message: data.View, coming: data.View) -> None:
        """The peer's fields, and what is new about them."""
        met = Signal()
        seen = Signal(32)
        any_seen = Signal()
        other_boot = Signal()
        other_sequence = Signal()
        m.d.sync += [
            other_boot.eq(coming.boot != self.peer_boot),
            other_sequence.eq(coming.sequence != seen),
        ]
        unseen = ~any_seen | self.booted | other_sequence
        m.d.comb += [
            self.booted.eq(self.taken & met & other_boot),
            self.fresh_frame.eq(self.taken & message.carries & unseen),
        ]
        m.d.comb += [getattr(self, f"new_{name}").eq(message[name]) for name in FORWARDED]
        with m.If(self.taken):
            m.d.sync += met.eq(1)
            m.d.sync += [
                getattr(self, f"peer_{name}").eq(message[name])
                for name in message_fields(self._config)
            ]
        with m.If(self.booted):
            m.d.sync += any_seen.eq(0)
        with m.If(self.fresh_frame):
            m.d.sync += [seen.eq(message.sequence), any_seen.eq(1)]
