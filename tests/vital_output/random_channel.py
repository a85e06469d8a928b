"""Random surroundings of one channel: its CPU, the network's time, the peer, relay and feedback."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np

from railgate.engines import Engine
from railgate.vital_output.spec import Code, Config, TestPhase, pack
from railgate.waves import Trace, Waveform

__all__ = ["inputs_of", "surroundings"]

SETTLED = 400
"""Feedback follows the pulses by so many ticks: the gateware runs in steps of it."""


@dataclass
class Script:
    """Random choices of one run: `odds` is how often something goes wrong."""

    config: Config
    board: int
    cycles: int
    odds: float
    random: np.random.Generator
    start: int = field(init=False)
    offset: int = field(init=False)

    def __post_init__(self) -> None:
        self.start = int(self.random.choice([0, 7, 0xFFFF_FFFE, 0x8000_0000]))
        self.offset = int(self.random.integers(self.config.cycle_ticks))

    @property
    def end(self) -> int:
        return self.cycles * self.config.cycle_ticks

    def goes_wrong(self) -> bool:
        return bool(self.random.random() < self.odds)

    def jumps(self) -> bool:
        return self.goes_wrong() and bool(self.random.random() < 0.3)

    def network(self, tick: int) -> tuple[int, int]:
        """Index and phase of the network's time in a tick."""
        index, phase = divmod(tick + self.offset, self.config.cycle_ticks)
        return (self.start + index) % 2**32, phase

    def sequence(self, cycle: int) -> int:
        return (self.start * 3 + 2**32 - 4 + cycle) % 2**32

    def sends(self) -> list[tuple[int, int, dict[str, int]]]:
        """Tick, index and fields of the frame of each cycle, mostly in mid-cycle; images last."""
        found = []
        mask = (1 << self.config.outputs) - 1
        image = acknowledge = 0
        for cycle in range(self.cycles):
            if cycle > 2 and self.random.random() < 0.4:
                image = int(self.random.integers(mask + 1))
            if self.random.random() < 0.2:
                acknowledge = int(self.random.integers(mask + 1))
            phase = self.config.cycle_ticks // 3
            if self.goes_wrong():
                phase = int(self.random.integers(self.config.cycle_ticks))
            tick = cycle * self.config.cycle_ticks + phase
            fields = {
                "sequence": self.sequence(cycle),
                "image": image,
                "acknowledge": acknowledge,
            }
            found.append((tick, self.network(tick)[0], fields))
        return found


def inputs_of(config: Config, board: int, cycles: int, seed: int) -> Trace:
    """All inputs of a channel but its feedback."""
    random = np.random.default_rng(seed)
    script = Script(config, board, cycles, float(random.choice([0.0, 0.02, 0.1, 0.3])), random)
    sends = script.sends()
    signals = {
        **_command(script, sends),
        **_time(script),
        "link_rx": _line(script, sends),
        "boot": Waveform.of([0], [int(random.integers(1 << 16))], 16),
        "test": _pulses(script, 0.3),
    }
    if random.random() < 0.15:
        at = int(random.integers(script.end - 2))
        signals["rst"] = Waveform.of([0, at, at + int(random.integers(1, 3))], [0, 1, 0])
    return Trace(signals, Fraction(1, config.clock_hz), 0, script.end)


def _pulses(script: Script, odds: float) -> Waveform:
    """Mostly 0, now and then 1 for a tick."""
    ticks, values = [0], [0]
    if script.random.random() < odds:
        at = int(script.random.integers(1, script.end - 2))
        ticks, values = [0, at, at + 1], [0, 1, 0]
    return Waveform.of(ticks, values)


def _command(script: Script, sends: list[tuple[int, int, dict[str, int]]]) -> dict[str, Waveform]:
    ticks, payloads, valids = [0], [0], [0]
    for tick, index, fields in sends:
        for at, data in _frames(script, tick, index, fields):
            if at <= ticks[-1]:
                continue
            for place, (byte, first, last) in enumerate(data):
                ticks.append(at + place)
                payloads.append(byte | first << 8 | last << 9)
                valids.append(1)
            ticks.append(at + len(data))
            payloads.append(0)
            valids.append(0)
    return {
        "command.payload": Waveform.of(ticks, payloads, 10).slice(0, script.end),
        "command.valid": Waveform.of(ticks, valids).slice(0, script.end),
    }


def _frames(
    script: Script, tick: int, index: int, fields: dict[str, int]
) -> list[tuple[int, list[tuple[int, int, int]]]]:
    """The bytes of the frames of one cycle, with what goes wrong."""
    config, random = script.config, script.random
    board, fields = config.boards[script.board], dict(fields)
    kind = random.choice(KINDS) if script.goes_wrong() else "right"
    step = int(random.integers(-5, 6))
    if kind == "masquerade":
        board = config.boards[1 - script.board]
    index += step if kind == "delay" else 0
    fields["sequence"] = (fields["sequence"] + (step if kind == "sequence" else 0)) % 2**32
    fields["image"] ^= 1 if kind == "image" else 0
    fields["image"] |= 1 << 7 if kind == "padding" else 0
    crc = config.layout.crc(board, index, fields)
    count = config.layout.frame_bytes
    packed = pack(config.layout.frame, {**fields, "crc": crc})
    packed ^= 1 << int(random.integers(8 * count)) if kind == "corruption" else 0
    data = [(byte, 0, 0) for byte in packed.to_bytes(count, "big")]
    if kind == "short":
        data = data[: int(random.integers(1, count))]
    if kind == "long":
        data += [(1, 0, 0)] * int(random.integers(1, 300))
    data[0] = (data[0][0], int(kind != "headless"), 0)
    if kind == "begun-anew":
        data[2] = (data[2][0], 1, 0)
    data[-1] = (*data[-1][:2], 1)
    if kind == "missing":
        return []
    again = [(tick + int(random.integers(20, 900)), data)] if kind == "repetition" else []
    return [(tick, data), *again]


KINDS = (
    "masquerade",
    "delay",
    "sequence",
    "image",
    "padding",
    "corruption",
    "short",
    "long",
    "headless",
    "begun-anew",
    "missing",
    "repetition",
)


def _time(script: Script) -> dict[str, Waveform]:
    """An update a cycle, early or late by a little, now and then by much."""
    config, random = script.config, script.random
    width = (config.cycle_ticks - 1).bit_length()
    ticks: list[int] = [0]
    values: list[tuple[int, int, int]] = [(0, 0, 0)]
    at = int(random.integers(50, 500))
    off = 0
    while at < script.end - 2:
        index, phase = script.network(at)
        off += int(random.integers(-3, 4))
        far = int(random.integers(-3 * config.cycle_ticks, 3 * config.cycle_ticks))
        index, phase = script.network(at + off + (far if script.jumps() else 0))
        if script.jumps():
            phase = min(config.cycle_ticks + 1, (1 << width) - 1)
        ticks += [at, at + 1]
        values += [(1, index, phase), (0, 0, 0)]
        at += int(random.integers(500, config.cycle_ticks))
    valid, index_in, phase_in = zip(*values, strict=True)
    return {
        "time.valid": Waveform.of(ticks, valid),
        "time.index": Waveform.of(ticks, index_in, 32),
        "time.phase": Waveform.of(ticks, phase_in, width),
    }


def _line(script: Script, sends: list[tuple[int, int, dict[str, int]]]) -> Waveform:
    """Messages of the peer, its clock off by some ppm, with wrong bits now and then."""
    config, random = script.config, script.random
    ppm = int(random.choice([-200, 0, 200, 5000]))
    bit = config.bit_ticks * (1 + Fraction(ppm, 1_000_000))
    period = config.link_period_ticks * (1 + Fraction(ppm, 1_000_000))
    peer = Peer(script, sends, int(random.integers(1 << 16)))
    ticks, values = [0], [1]
    begin = Fraction(int(random.integers(10, config.link_period_ticks)))
    while begin + config.message_ticks + config.bit_ticks < script.end:
        bits = peer.message(int(begin))
        if bits is not None:
            for place, level in enumerate(bits):
                ticks.append(int(begin + place * bit))
                values.append(level)
            ticks.append(int(begin + len(bits) * bit))
            values.append(1)
        begin += period
        if script.odds and random.random() < 0.002:
            begin += int(random.integers(1, 4000))
    return Waveform.of(ticks, values)


@dataclass
class Peer:
    """What the peer's messages say."""

    script: Script
    sends: list[tuple[int, int, dict[str, int]]]
    boot: int
    number: int = 0
    skew: int = field(init=False)
    tested: int = field(init=False)

    def __post_init__(self) -> None:
        config, random = self.script.config, self.script.random
        most = config.tau0_ticks - 2 * config.latency_ticks
        self.skew = int(random.integers(-most, most))
        # FPGA 1 waits for a peer that is WANTED, FPGA 2 for one that is DONE.
        ready = config.cycle_ticks * (0 if self.script.board else 1) + 4 * config.link_period_ticks
        self.tested = ready + int(random.integers(config.cycle_ticks // 2))

    def message(self, tick: int) -> list[int] | None:
        """The levels of its bits, start bit first; None where it is not sent."""
        config, random = self.script.config, self.script.random
        if self.script.odds and random.random() < 0.003:
            self.boot, self.number = int(random.integers(1 << 16)), 0
        self.number += 1
        wrong = self.script.goes_wrong() and random.random() < 0.2
        if wrong and random.random() < 0.3:
            return None
        if wrong and random.random() < 0.3:
            self.number += int(random.integers(-2, 6))
        values = {
            "number": self.number % 256,
            "boot": self.boot,
            "digest": config.digest ^ int(wrong and random.random() < 0.2),
            "test": self._test(tick),
            "codes": self._codes(tick),
            **self._frame(tick),
        }
        layout = config.layout
        board = config.boards[self.script.board if wrong else 1 - self.script.board]
        check = layout.message_check(board)
        body = pack(layout.message[:-1], values)
        crc = check.of(body, layout.message_bits - 33)
        packed = body << 32 | crc
        packed ^= int(wrong) << int(random.integers(layout.message_bits - 1))
        count = layout.message_bits - 1
        return [0, *(packed >> place & 1 for place in reversed(range(count)))]

    def _test(self, tick: int) -> int:
        if self.script.goes_wrong() and self.script.random.random() < 0.1:
            return int(self.script.random.integers(4))
        if tick < self.tested:
            return TestPhase.WANTED
        length = self.script.config.test_ticks
        return TestPhase.RUNNING if tick < self.tested + length else TestPhase.DONE

    def _past(self, tick: int) -> list[tuple[int, int, dict[str, int]]]:
        return [each for each in self.sends if each[0] + self.skew < tick]

    def _frame(self, tick: int) -> dict[str, int]:
        """The frame that the peer's CPU sent last, and whether it has passed there."""
        script, random = self.script, self.script.random
        past = self._past(tick)
        if not past:
            names = ("carries", "passed", "sequence", "image", "acknowledge", "frame_crc")
            return dict.fromkeys(names, 0)
        sent, index, fields = past[-1]
        fields = dict(fields)
        if script.goes_wrong() and random.random() < 0.2:
            fields["image"] ^= 1
        board = script.config.boards[1 - script.board]
        crc = script.config.layout.crc(board, index, fields)
        late = tick - sent - self.skew
        passed = late > script.config.latency_ticks + int(random.integers(500))
        return {"carries": 1, "passed": int(passed), **fields, "frame_crc": crc}

    def _codes(self, tick: int) -> int:
        """As if the peer drove what was commanded a while ago."""
        script, random = self.script, self.script.random
        late = script.config.latency_ticks
        past = self._past(tick - 2 * late)
        image = past[-1][2]["image"] if past else 0
        before = self._past(tick - 4 * late)
        held = before[-1][2]["image"] if before else 0
        codes = 0
        for output in range(script.config.outputs):
            code = Code.OFF
            if image >> output & 1:
                code = Code.DRIVE if held >> output & 1 else Code.PRE_DRIVE
            if script.goes_wrong() and random.random() < 0.1:
                code = Code(int(random.integers(4)))
            codes |= code << 2 * output
        return codes


def surroundings(config: Config, board: int, cycles: int, seed: int, engine: Engine) -> Trace:
    """inputs_of with a feedback that follows the pulses of `engine`, which runs along.

    Each output's pulse feedback is its pulses, SETTLED ticks late; its contact follows after a
    while of pulses; both are stuck at some level for some time now and then.
    """
    inputs = inputs_of(config, board, cycles, seed)
    random = np.random.default_rng([seed, 1])
    odds = float(random.choice([0.0, 0.0, 0.02]))
    outputs = config.outputs
    parts: list[Trace] = []
    pulses = Waveform.of([0], [0], outputs)
    on = np.zeros(outputs, np.int64)
    stuck, level = 0, 0
    for start in range(0, inputs.end, SETTLED):
        end = min(start + SETTLED, inputs.end)
        if random.random() < odds:
            stuck, level = (int(random.integers(1 << outputs)) for _ in range(2))
        elif random.random() < 0.1:
            stuck = 0
        values = pulses.values.astype(np.int64) & ~stuck | level & stuck
        back = Waveform.of(pulses.ticks - pulses.ticks[0] + start, values, outputs)
        for output in range(outputs):
            alive = bool((pulses.values.astype(np.uint64) >> np.uint64(output) & 1).any())
            on[output] = on[output] + 1 if alive else min(on[output], 12) - 1 if on[output] else 0
        drives = start > 4 * config.cycle_ticks  # before, it pulses alone in its test
        closed = sum(1 << output for output in range(outputs) if drives and on[output] > 4)
        contact = Waveform.of([start], [closed & ~stuck | level & stuck], outputs)
        given = {"pulse_feedback": back.slice(start, end), "contact": contact}
        part = Trace(given, inputs.period, start, end)
        parts.append(part)
        told = inputs.slice(start, end).merge(part)
        pulses = engine.advance(end, told, ["pulses"])["pulses"]
    return inputs.merge(parts[0].concatenate(*parts[1:]))
