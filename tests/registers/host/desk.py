"""A board on a desk: two functions behind the serial bridge, compiled, on a pseudo-terminal."""

import os
import pty
import select
import threading
import time
import tty
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from functools import cache

import numpy as np
from amaranth.hdl import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.engines import Clock, Design
from railgate.odometer.gateware import Odometer
from railgate.odometer.plant import Sensor, course
from railgate.odometer.registers import registers as odometer
from railgate.position_link.gateware import PositionLink
from railgate.position_link.plant import Scenario
from railgate.position_link.registers import registers as position_link
from railgate.registers import Map
from railgate.registers.gateware import Decoder, Mapped, address_bits
from railgate.registers.gateware.uart import Uart
from railgate.registers.host import Running
from railgate.unit.config import Unit
from railgate.waves import Trace, Waveform

UNIT = Unit()
BIT_TICKS = 8
BAUD = UNIT.odometer.clock_hz // BIT_TICKS
FRAME_BITS = 10
BYTES = 40
"""That the board takes at a time."""
SECONDS = 30
"""Of the board's pins: for many tests."""
REST_S = 0.002
"""What a board that has nothing to say leaves to others."""

MAP = Map.of("desk", "two functions", (odometer(UNIT.odometer), position_link(UNIT.link)))


class Desk(wiring.Component):
    """All in one clock. rx, tx: the line. a, b: of each sensor. uef, data: of the link."""

    def __init__(self) -> None:
        pins = {"rx": In(1), "tx": Out(1), "uef": In(1), "data": In(1)}
        sensors = UNIT.odometer.sensors
        super().__init__(pins | {"a": In(sensors), "b": In(sensors)})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        functions = (Odometer(UNIT.odometer), PositionLink(UNIT.link))
        m.submodules.uart = uart = Uart(address_bits(MAP.size), BIT_TICKS)
        m.submodules.decoder = decoder = Decoder(MAP)
        wiring.connect(m, uart.bus, decoder.bus)
        m.d.comb += [uart.rx.eq(self.rx), self.tx.eq(uart.tx)]
        mapped = []
        for function, block in zip(functions, MAP.blocks.values(), strict=True):
            m.submodules[block.name] = each = Mapped(function, block)
            wiring.connect(m, getattr(decoder.served, block.name), each.bus)
            mapped.append(each)
        wheels, link = mapped
        m.d.comb += [link.uef.eq(self.uef), link.data.eq(self.data)]
        for n, sensor in enumerate(wheels.sensor):
            m.d.comb += [sensor.a.eq(self.a[n]), sensor.b.eq(self.b[n])]
        return m


@cache
def pins(speed_kmh: float = 200) -> Trace:
    """Both axles at that speed, and a position system that answers."""
    config = UNIT.odometer
    turned = Sensor().drive(course("constant", speed_kmh, SECONDS), config)
    both = {
        name: Waveform.of(wave.ticks, wave.values * 3, config.sensors)
        for name, wave in turned.signals.items()
    }
    cycles = SECONDS * config.clock_hz // UNIT.link.cycle_ticks + 1
    counted = np.arange(cycles)
    words = UNIT.layout.words(
        {
            "position": 10.0 * counted,
            "speed": np.full(cycles, float(speed_kmh)),
            "sequence": counted % 16,
        }
    )
    line = Scenario(words=words).plan(UNIT.link, cycles).drive()
    end = min(turned.end, line.end)
    signals = {**both, **line.signals}
    return Trace({n: wave.slice(0, end) for n, wave in signals.items()}, turned.period, 0, end)


def design() -> Design:
    clock = Clock(frequency_hz=Fraction(UNIT.odometer.clock_hz))
    return Design(name="desk", component=Desk, clocks=(clock,))


@dataclass(frozen=True)
class Wire:
    """A design's serial line: its pins, ticks of its clock a bit, the design's ticks to one."""

    rx: str = "rx"
    tx: str = "tx"
    bit_ticks: int = BIT_TICKS
    step: int = 1


def sent(data: bytes, bit_ticks: int = BIT_TICKS) -> list[int]:
    """The levels of bytes on the line, one a tick."""
    bits = [level for byte in data for level in (0, *(byte >> n & 1 for n in range(8)), 1)]
    return [level for level in bits for _ in range(bit_ticks)]


class Ear:
    """Takes bytes off the line."""

    def __init__(self, bit_ticks: int = BIT_TICKS) -> None:
        self._levels = np.empty(0, np.uint8)
        self._bit_ticks = bit_ticks

    def hear(self, levels: np.ndarray) -> bytes:
        """Those that are whole with these further levels, one a tick."""
        self._levels, found = np.append(self._levels, levels), bytearray()
        while (low := np.flatnonzero(self._levels == 0)).size:
            self._levels = self._levels[low[0] :]
            if self._levels.size < FRAME_BITS * self._bit_ticks:
                return bytes(found)
            middles = self._levels[self._bit_ticks // 2 :: self._bit_ticks][:FRAME_BITS]
            assert middles[-1] == 1, "a stop bit"
            found.append(int(np.packbits(middles[1:9], bitorder="little")[0]))
            self._levels = self._levels[(FRAME_BITS - 1) * self._bit_ticks + self._bit_ticks // 2 :]
        self._levels = self._levels[:0]
        return bytes(found)


Noise = Callable[[bytes], bytes]
"""What comes out of a direction of the line, of what goes in at a time."""


def quiet(data: bytes) -> bytes:
    return data


@dataclass
class Line:
    """The port of a board that is on, and what is wrong with its line: may be changed."""

    port: str
    to_board: Noise = quiet
    to_host: Noise = quiet


@contextmanager
def on_desk(speed_kmh: float = 200, make: Callable[[], Design] = design) -> Iterator[Line]:
    """A board that runs by itself as long as the context lasts, or its pins."""
    with on_line(Running(make(), "cxxrtl", pins(speed_kmh)), Wire()) as line:
        yield line


@contextmanager
def on_line(running: Running, wire: Wire) -> Iterator[Line]:
    """As `on_desk`, of whatever runs."""
    board, host = pty.openpty()
    tty.setraw(host)
    line, off = Line(os.ttyname(host)), threading.Event()
    thread = threading.Thread(target=_run, args=(running, wire, board, line, off))
    thread.start()
    try:
        yield line
    finally:
        off.set()
        thread.join()
        os.close(board)
        os.close(host)


def _run(running: Running, wire: Wire, board: int, line: Line, off: threading.Event) -> None:
    """Carry bytes between the pseudo-terminal and the pins."""
    ear = Ear(wire.bit_ticks)
    waiting = b""
    span = BYTES * wire.bit_ticks * FRAME_BITS
    while not off.is_set():
        if select.select([board], [], [], 0)[0]:
            waiting += line.to_board(os.read(board, 1024))
        now, waiting = waiting[:BYTES], waiting[BYTES:]
        start = running.now
        levels = [*sent(now, wire.bit_ticks), 1]
        told = running.run({wire.rx: (1, levels)}, span, [wire.tx])
        heard = ear.hear(told[wire.tx].at(np.arange(start, running.now, wire.step)))
        if heard and (told_back := line.to_host(heard)):
            os.write(board, told_back)
        if not now and told[wire.tx].values.all():
            time.sleep(REST_S)


@contextmanager
def answering(answer: Callable[[bytes], bytes]):
    """A port at whose other end something answers, but no bridge."""
    board, host = pty.openpty()
    tty.setraw(host)

    def run() -> None:
        while data := os.read(board, 1024):
            if data == b"stop":
                return
            os.write(board, answer(data))

    thread = threading.Thread(target=run)
    thread.start()
    try:
        yield Line(os.ttyname(host))
    finally:
        os.write(host, b"stop")
        thread.join()
        os.close(board)
        os.close(host)


def flipped(data: bytes) -> bytes:
    """An answer that is spoilt."""
    return data[:-2] + bytes([data[-2] ^ 1]) + data[-1:]
