"""A channel with its own wiring, to which frames, messages and time come as a monitor has it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from amaranth.hdl import Cat, Module, Value

from railgate.proving import Internals, Monitor
from railgate.vital_output.proofs.cut import Told, cut
from railgate.vital_output.spec import Config

__all__ = ["Free", "widths"]

PINS = ("test", "pulse_feedback", "contact")


def widths(config: Config) -> dict[str, int]:
    """Of a Free's own inputs."""
    n = config.outputs
    return {
        "test": 1,
        "pulse_feedback": n,
        "contact": n,
        "accepted": 1,
        "own_index": 32,
        "sequence": 32,
        "image": n,
        "acknowledge": n,
        "forwarded": 1,
        "forwarded_index": 32,
        "peer_sequence": 32,
        "peer_image": n,
        "peer_acknowledge": n,
        "peer_codes": 2 * n,
        "peer_test": 2,
        **dict.fromkeys(("peer_ok", "peer_passed", "peer_carries", "booted"), 1),
    }


class Free(Monitor):
    """A channel in which all that brings it frames and messages is cut out: what they tell is free.

    inputs: those of the monitor, beside the pins `test`, `pulse_feedback`, `contact` and: accepted,
    with own_index, sequence, image, acknowledge: the own CPU's frame is accepted. forwarded, with
    forwarded_index, peer_sequence, peer_image, peer_acknowledge: one that the peer has forwarded is
    good. peer_ok, peer_passed, peer_carries, peer_codes, peer_test, booted: see LinkReceiver.
    lemma.sound, if it is among them: no redundant register is upset.
    """

    def __init__(
        self,
        config: Config,
        board: int,
        inputs: Mapping[str, int],
        lemmas: Iterable[str],
    ) -> None:
        super().__init__({**widths(config), **inputs}, lemmas)
        self.config, self.board = config, board

    def told(self) -> Told:
        """What the blocks that are cut out tell."""
        taken = [name for name in self.signature.members if name.startswith("peer_")]
        return {
            "Command": {
                "accepted": self.accepted,
                "frame_index": self.own_index,
                "sequence": self.sequence,
                "image": self.image,
                "acknowledge": self.acknowledge,
            },
            "FrameCheck": {
                "done": self.forwarded,
                "good": self.forwarded,
                "good_index": self.forwarded_index,
            },
            "LinkReceiver": {name: getattr(self, name) for name in (*taken, "booted")},
            "LinkTransmitter": {},
            "Status": {},
        }

    def channel(self, m: Module) -> Internals:
        from railgate.vital_output.gateware import channel

        arguments = (self.config, self.board)
        m.submodules.dut = inner = cut(channel, "Channel", arguments, self.told())
        m.d.comb += [inner[name].eq(getattr(self, name)) for name in PINS]
        if "sound" in self.lemmas:
            blocks = ["vote", "storage", "shutoff"]
            blocks += [f"output_{number}" for number in range(self.config.outputs)]
            m.d.comb += self.lemma.sound.eq(~Cat(inner[f"{block}.error"] for block in blocks).any())
        return inner

    def own_frame(self) -> Value:
        """As it comes, index and sequence in its low bits."""
        return Cat(self.own_index, self.sequence, self.image, self.acknowledge)

    def forwarded_frame(self) -> Value:
        """Likewise."""
        return Cat(self.forwarded_index, self.peer_sequence, self.peer_image, self.peer_acknowledge)
