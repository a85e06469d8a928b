"""One channel of the vital output, from the command and the cross-link to the pulses."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Mux, Signal, Value
from amaranth.lib import data, stream, wiring
from amaranth.lib.wiring import In, Out

from railgate.vital_output.gateware.check import FrameCheck
from railgate.vital_output.gateware.command import BYTE, Command
from railgate.vital_output.gateware.crosslink import LinkReceiver, LinkTransmitter
from railgate.vital_output.gateware.feedback import Feedback
from railgate.vital_output.gateware.output import Output
from railgate.vital_output.gateware.shutoff import Shutoff
from railgate.vital_output.gateware.status import Status
from railgate.vital_output.gateware.storage import Storage
from railgate.vital_output.gateware.timekeeper import Timekeeper
from railgate.vital_output.gateware.vote import Vote
from railgate.vital_output.spec import CAUSES, Cause, Config

__all__ = ["Channel"]

COMMAND_CAUSES = CAUSES[: CAUSES.index(Cause.INSERTION) + 1]
STORED = ("life", "image", "acknowledge", "blocked", "latched")


def time_signature(config: Config) -> wiring.Signature:
    """The network's time, an update in a tick in which it is valid."""
    return wiring.Signature(
        {"index": Out(32), "phase": Out(range(config.cycle_ticks)), "valid": Out(1)}
    )


class Channel(wiring.Component):
    """Votes the commands of both CPUs and drives its half of each output, by the contract in spec.

    board: which of config.boards it is, 0 or 1.
    In domain sync, whose clock is the reference clock and whose reset makes a new tick 0:
    command: in, a stream of BYTE. time: in, see time_signature. boot: in, 16 bits, another number
    after each start. test: in, 1 bit, a test of the shut-off paths is wanted. link_rx: in, 1 bit,
    pulse_feedback, contact: in, one bit an output each, pins, asynchronous.
    link_tx: out, 1 bit, pulses: out, one bit an output, pins. One out of each of config.fields:
    width and unit are told there. All outputs come from flip-flops, `states` and `test_phase`
    through the decoding of their codes.
    """

    def __init__(self, config: Config, board: int) -> None:
        self._config = config
        self._board = board
        n = config.outputs
        super().__init__(
            {
                "command": In(stream.Signature(BYTE)),
                "time": In(time_signature(config)),
                "boot": In(16),
                "test": In(1),
                "link_rx": In(1),
                "pulse_feedback": In(n),
                "contact": In(n),
                "link_tx": Out(1, init=1),
                "pulses": Out(n),
            }
            | {field.name: Out(field.width, init=field.start) for field in config.fields}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        config, board = self._config, self._board
        m.submodules.timekeeper = time = Timekeeper(config)
        m.submodules.command = command = Command(config, board)
        m.submodules.receiver = receiver = LinkReceiver(config, board)
        late_ticks = config.margin_ticks + config.latency_ticks
        m.submodules.forwarded = forwarded = FrameCheck(config, 1 - board, late_ticks)
        m.submodules.vote = vote = Vote(config)
        m.submodules.storage = storage = Storage(config)
        m.submodules.shutoff = shutoff = Shutoff(config, board)
        m.submodules.status = status = Status(config)
        m.submodules.transmitter = transmitter = LinkTransmitter(config, board)

        lifeless = storage.life == 0
        upset = vote.error | storage.error | shutoff.error
        now = {"index": time.index, "phase": time.phase, "trusted": time.trusted}
        decision = {"decides": time.decides, "decided": time.index - 1}
        peer_accepted = forwarded.done & forwarded.good
        # Until its check is done, the message that brought a frame is the one last taken.
        peer_image = receiver.peer_image

        _feed(
            m,
            time,
            valid=self.time.valid,
            index_in=self.time.index,
            phase_in=self.time.phase,
            lifeless=lifeless,
        )
        wiring.connect(m, wiring.flipped(self.command), command.command)
        _feed(m, command, **now, lifeless=lifeless, life_ends=storage.life_ends)
        _feed(m, receiver, link_rx=self.link_rx)
        _feed(m, forwarded, **now, start=receiver.fresh_frame)
        _feed(
            m,
            forwarded.frame,
            sequence=receiver.new_sequence,
            image=receiver.new_image,
            acknowledge=receiver.new_acknowledge,
            crc=receiver.new_frame_crc,
        )
        _feed(
            m,
            vote,
            **decision,
            accepted=command.accepted,
            crc=command.crc,
            peer_accepted=peer_accepted,
            peer_ok=receiver.peer_ok,
            peer_passed=receiver.peer_passed,
            peer_carries=receiver.peer_carries,
            peer_sequence=receiver.peer_sequence,
        )
        _feed(
            m,
            vote.own_frame,
            index=command.frame_index,
            sequence=command.sequence,
            image=command.image,
            acknowledge=command.acknowledge,
        )
        _feed(
            m,
            vote.forwarded_frame,
            index=forwarded.good_index,
            sequence=receiver.peer_sequence,
            image=peer_image,
            acknowledge=receiver.peer_acknowledge,
        )
        _feed(
            m,
            storage,
            **decision,
            stored=vote.stored,
            own=vote.own,
            accepted=command.accepted,
            accepted_image=command.image,
            peer_accepted=peer_accepted,
            forwarded_image=peer_image,
            rejected=command.rejected,
            booted=receiver.booted,
            upset=upset,
        )
        _feed(
            m,
            shutoff,
            states=self.states,
            image=storage.image,
            peer_ok=receiver.peer_ok,
            peer_test=receiver.peer_test,
            booted=receiver.booted,
            test=self.test,
        )
        drives = ~upset & shutoff.both_done
        cmd = Mux(drives, storage.image & ~storage.blocked, 0)
        peer_codes = Mux(receiver.peer_ok, receiver.peer_codes, 0)  # OFF without a peer
        outputs = self._outputs(m)
        for number, output in enumerate(outputs):
            _feed(
                m,
                output,
                cmd=cmd[number],
                peer_code=peer_codes.word_select(number, len(output.peer_code)),
                acknowledged=storage.acknowledged[number],
                begins=shutoff.begins,
                watching=shutoff.watching,
                upset=upset,
            )
        codes, pulses, handshakes, feedbacks, upsets = (
            Cat(getattr(output, name) for output in outputs)
            for name in ("code", "pulse", "handshake_alarm", "feedback_alarm", "error")
        )
        _feed(
            m,
            transmitter,
            boot=self.boot,
            test=shutoff.test_phase,
            codes=codes,
            carries=vote.carries,
            passed=vote.passed,
            sequence=vote.own.sequence,
            image=vote.own.image,
            acknowledge=vote.own.acknowledge,
            frame_crc=vote.own_crc,
        )
        _feed(
            m,
            status,
            **{cause.name.lower(): command.cause == cause for cause in COMMAND_CAUSES},
            accepted=command.accepted,
            start=command.started,
            lost=command.lost,
            passed=vote.passes,
            stored=vote.stored,
            acknowledged=storage.acknowledged.any(),
            forward=forwarded.done & ~forwarded.good,
            skew=vote.skew,
            mismatch=vote.mismatch,
            link_check=receiver.bad_check,
            link_digest=receiver.bad_digest,
            link_sequence=receiver.bad_sequence,
            link_lost=receiver.lost,
            oscillator=receiver.off_frequency,
            time_jump=time.jump,
            life_out=storage.life_out,
            handshake_alarm=handshakes,
            feedback_alarm=feedbacks,
            latched=storage.latches,
            upset=upset | upsets.any(),
        )

        trusted = Signal()
        m.d.sync += trusted.eq(time.trusted)
        shown = {
            "index": time.index,
            "trusted": trusted,
            "sequence": vote.own.sequence,
            "states": Cat(output.state for output in outputs),
            "test_phase": shutoff.test_phase,
            "linked": receiver.linked,
            "drifting": receiver.drifting,
        } | {name: getattr(storage, name) for name in STORED}
        for field in config.fields:
            value = shown[field.name] if field.name in shown else getattr(status, field.name)
            m.d.comb += getattr(self, field.name).eq(value)
        _feed(m, self, link_tx=transmitter.link_tx, pulses=pulses)
        return m

    def _outputs(self, m: Module) -> list[Output]:
        """Each with its feedback."""
        outputs = []
        for number in range(self._config.outputs):
            m.submodules[f"feedback_{number}"] = feedback = Feedback(self._config)
            m.submodules[f"output_{number}"] = output = Output(self._config)
            pulse, contact = self.pulse_feedback[number], self.contact[number]
            _feed(m, feedback, pulse_pin=pulse, contact_pin=contact)
            told = {name: getattr(feedback, name) for name in ("fb", "frequency", "contact")}
            _feed(m, output, **told)
            outputs.append(output)
        return outputs


def _feed(m: Module, block: wiring.Component | data.View, **sources: Value) -> None:
    """Drives these members of a block."""
    m.d.comb += [getattr(block, name).eq(source) for name, source in sources.items()]
