"""A board on a serial line: compiled gateware on a pseudo-terminal, with faults on the line."""

import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import pytest

from railgate.odometer.device import OdometerDevice
from railgate.position_link.device import LinkDevice
from railgate.position_link.spec import Status
from railgate.registers.host import AccessError, NoAnswerError, UartBus
from registers.host.desk import BAUD, MAP, UNIT, Line, Noise, answering, on_desk, quiet

END = b"\xc0"
WAIT_S = 0.5
"""The board of the tests is slower than a real one."""


@dataclass
class Board:
    """A board that runs, its bus, and its functions."""

    line: Line
    bus: UartBus
    odometer: OdometerDevice
    link: LinkDevice


@pytest.fixture(scope="module")
def running() -> Iterator[Board]:
    with on_desk() as line, UartBus(line.port, BAUD, WAIT_S, tries=20) as bus:
        odometer = OdometerDevice(bus, UNIT.odometer, MAP.address("odometer", "identity"))
        link = LinkDevice(bus, UNIT.link, MAP.address("position_link", "identity"), UNIT.layout)
        yield Board(line, bus, odometer, link)


@pytest.fixture
def board(running: Board) -> Board:
    """On a quiet line."""
    running.line.to_board = running.line.to_host = quiet
    return running


def losing(seed: int, part: float) -> Noise:
    """Some of what is sent never comes."""
    chance = random.Random(seed)
    return lambda data: b"" if chance.random() < part else data


def flipping(seed: int, part: float) -> Noise:
    """Some bytes come with a wrong bit."""
    chance = random.Random(seed)
    return lambda data: bytes(
        byte ^ 1 << chance.randrange(8) if chance.random() < part else byte for byte in data
    )


class Whole:
    """What comes of whole answers, of which the line brings pieces."""

    def __init__(self, make: Callable[[bytes], bytes]) -> None:
        self._make, self._piece = make, b""

    def __call__(self, data: bytes) -> bytes:
        self._piece += data
        if self._piece.count(END) < 2:
            return b""
        whole, self._piece = self._piece, b""
        return self._make(whole)


@pytest.mark.shows("SYS-1", "SYS-5")
def test_every_function_is_read_over_the_line(board) -> None:
    for device in (board.odometer, board.link):
        device.registers.require_same()
    board.odometer.snapshots()
    front, rear = board.odometer.snapshots()
    assert front.number == rear.number > 1
    assert front.pulses == rear.pulses > 0
    assert board.odometer.snapshots(again=True) == (front, rear)
    told = board.link.delivery()
    assert told.status is Status.FRESH
    assert told.values["speed"] == pytest.approx(200, abs=0.2)
    assert told.consistent


@pytest.mark.shows("ODO-6", "ODO-7")
@pytest.mark.parametrize(
    ("to_board", "to_host"),
    [
        (losing(1, 0), Whole(losing(1, 0.25))),
        (losing(2, 0.25), losing(2, 0)),
        (flipping(3, 0.002), flipping(4, 0.002)),
    ],
    ids=["answers lost", "requests lost", "bytes spoilt"],
)
def test_what_the_line_loses_loses_no_pulse_and_gates_once(
    board, to_board, to_host, monkeypatch
) -> None:
    monkeypatch.setattr(board.bus, "_wait_s", 0.1)
    before = board.odometer.snapshots()[0]
    board.line.to_board, board.line.to_host = to_board, to_host
    shots = [board.odometer.snapshots()[0] for _ in range(12)]
    assert [shot.number - before.number for shot in shots] == list(range(1, 13))
    assert sum(shot.pulses for shot in shots) == shots[-1].a_rising - before.a_rising > 0


class Spoiler:
    """Every other answer has one wrong bit, each time the next one after its frame's border."""

    def __init__(self) -> None:
        self.at, self._spoils = 8, False

    def __call__(self, answer: bytes) -> bytes:
        self._spoils = not self._spoils
        if not self._spoils or self.at >= 8 * (len(answer) - 1):
            return answer
        byte, bit = divmod(self.at, 8)
        self.at += 1
        return answer[:byte] + bytes([answer[byte] ^ 1 << bit]) + answer[byte + 1 :]


def test_an_answer_that_is_spoilt_in_any_bit_is_none(board, monkeypatch) -> None:
    monkeypatch.setattr(board.bus, "_wait_s", 0.05)
    right, spoiler = board.bus.read(0, 2), Spoiler()
    board.line.to_host = Whole(spoiler)
    bits = 8 * 4 * (1 + len(right) + 1)
    while spoiler.at < 8 + bits:
        assert board.bus.read(0, 2) == right


def test_an_answer_that_comes_too_late_is_of_no_other_request(board) -> None:
    last = [b""]

    def twice(answer: bytes) -> bytes:
        """Each one again, before the next."""
        late, last[0] = last[0], answer
        return late + answer

    identity, configuration = board.bus.read(0, 2)
    board.line.to_host = Whole(twice)
    for _ in range(5):
        assert board.bus.read(0) == [identity]
        assert board.bus.read(4) == [configuration]


def test_every_byte_can_be_sent_and_come_back(board) -> None:
    """Numbers of requests go through all bytes, among them those that are escaped."""
    identity = board.bus.read(0)
    for _ in range(0x100):
        assert board.bus.read(0) == identity


@pytest.mark.shows("SYS-1")
def test_what_is_not_there_is_refused_with_its_address(board) -> None:
    bus, end = board.bus, MAP.blocks[0].words * 4
    for access, address in (
        (lambda: bus.read(end), end),
        (lambda: bus.read(end - 8, 3), end),
        (lambda: bus.read(MAP.size), MAP.size),
        (lambda: bus.write(0, [1]), 0),
        (lambda: bus.read(8), 8),
    ):
        with pytest.raises(AccessError, match=f"at address {address:#x}$") as refused:
            access()
        assert refused.value.address == address
    for wrong in (lambda: bus.read(2), lambda: bus.read(0, 0), lambda: bus.write(-4, [0])):
        with pytest.raises(ValueError, match="must be"):
            wrong()


def test_a_burst_may_be_longer_than_the_bridge_takes(board) -> None:
    board.odometer.strobe()
    size = MAP.blocks[0].place("snapshot").group.words
    first = MAP.address("odometer", "snapshot")
    whole = board.bus.read(first + 4, 2 * size - 1)
    assert size < board.bus._most < len(whole)
    assert whole[size - 1 :] == board.bus.read(first + 4 * size, size)
    assert whole[: size - 1] == board.bus.read(first + 4, size - 1)


def test_a_port_is_one_hosts(board) -> None:
    with pytest.raises(ValueError, match="cannot be opened"):
        UartBus(board.line.port, BAUD, WAIT_S)


@pytest.mark.parametrize(
    ("answer", "says"),
    [
        (lambda _: b"", "no answer after 2 tries, at address 0x0"),
        (lambda _: b"\xc0hello, is there\xc0", "no good answer, the CRC is wrong after 2 tries"),
        (lambda data: data[:-2] + b"x\xc0", "the CRC is wrong"),
    ],
    ids=["silent", "no bridge", "spoilt"],
)
def test_what_is_no_bridge_is_told(answer, says) -> None:
    with answering(answer) as line, pytest.raises(NoAnswerError, match=says):
        UartBus(line.port, BAUD, wait_s=0.05, tries=2)


def test_a_port_that_cannot_be_opened_is_told() -> None:
    with pytest.raises(ValueError, match=r"/dev/none cannot be opened at 115200 baud: .*No such"):
        UartBus("/dev/none", 115_200)


def test_a_board_that_goes_is_told() -> None:
    with answering(lambda _: b"") as line:
        pass
    with pytest.raises(ValueError, match="cannot be opened"):
        UartBus(line.port, BAUD)
