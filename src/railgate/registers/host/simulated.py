"""A design with a bus, in an engine: each access runs it for as long as the access takes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from railgate.registers.host.bus import AccessError, NoAnswerError, addresses
from railgate.registers.host.running import Drive, Running
from railgate.registers.register import WORD_BITS, WORD_BYTES
from railgate.waves import Trace

__all__ = ["SimulatedBus"]

LISTENING = 4
"""Steps between two looks for the answer: what a bank needs."""


class SimulatedBus:
    """The bus of a design whose component has a member called as `path`, of
    `registers.gateware.bus_signature`, in the domain whose steps `running` counts.

    size: bytes of the bus' addresses, of its map or block. patience: so many steps without an
    answer are none.
    """

    def __init__(
        self, running: Running, size: int, path: str = "bus", patience: int = 4096
    ) -> None:
        self._running = running
        self._address_bits = (size - 1).bit_length()
        self._path = path
        self._patience = patience

    def read(self, address: int, count: int = 1) -> list[int]:
        """See Bus."""
        return [self._access(at) for at in addresses(address, count)]

    def write(self, address: int, words: Sequence[int]) -> None:
        """See Bus."""
        for at, word in zip(addresses(address, len(words)), words, strict=True):
            self._access(at, word)

    def _access(self, address: int, word: int | None = None) -> int:
        """One word, as it is read, or written."""
        if address >> self._address_bits:
            raise AccessError(address, "it is not on the bus")
        strobes = (1 << WORD_BYTES) - 1
        parts = [(address, self._address_bits), (word is not None, 1), (word or 0, WORD_BITS)]
        payload, width = 0, 0
        for value, bits in (*parts, (strobes, WORD_BYTES)):
            payload |= value << width
            width += bits
        drive = {f"{self._path}.request.payload": (width, [payload])}
        valid = f"{self._path}.request.valid"
        for _ in range(self._patience):
            told = self._run(drive | {valid: (1, [1])}, 1)
            if told[f"{self._path}.request.ready"].values[-1]:
                return self._answer(address, {valid: (1, [0])})
        raise NoAnswerError(address, "the bus takes no request")

    def _answer(self, address: int, idle: Mapping[str, Drive]) -> int:
        for _ in range(0, self._patience, LISTENING):
            told = self._run(idle, LISTENING)
            valid = told[f"{self._path}.response.valid"]
            there = valid.ticks[valid.values != 0]
            if there.size:
                if told[f"{self._path}.response.error"].at(there[0]):
                    raise AccessError(address, "the bus tells an error")
                return int(told[f"{self._path}.response.data"].at(there[0]))
        raise NoAnswerError(address, "no answer")

    def _run(self, inputs: Mapping[str, Drive], steps: int) -> Trace:
        names = ("request.ready", "response.valid", "response.error", "response.data")
        return self._running.run(inputs, steps, [f"{self._path}.{name}" for name in names])
