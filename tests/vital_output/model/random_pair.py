"""Random surroundings of the closed loop: CPU pair, network time, and what goes wrong."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from railgate.engines import Clock
from railgate.vital_output.model.clocks import clock_of, edge
from railgate.vital_output.spec import Config, pack
from railgate.waves import Trace, Waveform

__all__ = ["FS", "Times", "clocks_of", "inputs_of"]

FS = Fraction(1, 10**15)
DOMAINS = ("fpga_1", "fpga_2", "relay")


@dataclass(frozen=True)
class Times:
    """The relays' clock and times in its ticks."""

    clock_hz: int = 1_000_000
    pick_up_ticks: int = 700
    release_ticks: int = 7_000


def clocks_of(config: Config, times: Times, random: np.random.Generator) -> tuple[Clock, ...]:
    """Mostly within tolerance; now and then all the same, now and then far off."""
    kind = random.random()
    found = []
    for domain in DOMAINS:
        hertz = times.clock_hz if domain == "relay" else config.clock_hz
        ppm, phase = Fraction(int(random.integers(-100, 101))), Fraction(0)
        if kind > 0.3:
            phase = Fraction(int(random.integers(1000)), 1000)
        if kind < 0.2:
            ppm = Fraction(0)
        if kind > 0.9 and domain == "fpga_2":
            ppm = Fraction(int(random.integers(-20_000, 20_000)))
        found.append(Clock(frequency_hz=Fraction(hertz), domain=domain, ppm=ppm, phase=phase))
    return tuple(found)


def inputs_of(config: Config, clocks: tuple[Clock, ...], cycles: int, seed: int) -> Trace:
    """All inputs of the loop, in femtoseconds."""
    random = np.random.default_rng([seed, 7])
    odds = float(random.choice([0.0, 0.3, 1.0]))
    end = cycles * int(config.cycle_s / FS)
    signals: dict[str, Waveform] = {}
    sends = _sends(config, cycles, random)
    for c in range(2):
        signals |= _channel(config, clocks[c], c, sends, end, random)
    for name, width in _faults(config):
        if random.random() < odds * 0.25:
            signals[name] = _pulses(width, end, int(config.cycle_s / FS), random)
    return Trace(signals, FS, 0, end)


def _sends(
    config: Config, cycles: int, random: np.random.Generator
) -> list[tuple[int, dict[str, int]]]:
    """Index and fields of each cycle's frame; images last, and are 0 at first."""
    found, image, acknowledge = [], 0, 0
    for cycle in range(cycles):
        if cycle > 2 and random.random() < 0.35:
            image = int(random.integers(1 << config.outputs))
        if random.random() < 0.2:
            acknowledge = int(random.integers(1 << config.outputs))
        found.append((cycle, {"sequence": cycle, "image": image, "acknowledge": acknowledge}))
    return found


def _channel(
    config: Config,
    clock: Clock,
    c: int,
    sends: list[tuple[int, dict[str, int]]],
    end: int,
    random: np.random.Generator,
) -> dict[str, Waveform]:
    known = clock_of(clock, FS)[0]
    cycle = int(config.cycle_s / FS)
    tick = cycle // config.cycle_ticks
    command: list[tuple[int, int, int]] = [(0, 0, 0)]
    time: list[tuple[int, int, int, int]] = [(0, 0, 0, 0)]
    for index, fields in sends:
        if random.random() < 0.05:
            continue
        crc = config.layout.crc(config.boards[c], index, fields)
        data = pack(config.layout.frame, {**fields, "crc": crc}).to_bytes(
            config.layout.frame_bytes, "big"
        )
        at = index * cycle + cycle // 3 + int(random.integers(300)) * tick
        n = at // tick
        for place, byte in enumerate(data):
            flags = (place == 0) << 8 | (place == len(data) - 1) << 9
            command.append((edge(known, n + place), byte | flags, 1))
        command.append((edge(known, n + len(data)), 0, 0))
    for at in range(150 * tick, end - 3 * tick, cycle // 2):
        n = (at + int(random.integers(100)) * tick) // tick
        begin = edge(known, n)
        index, rest = divmod(begin, cycle)
        phase = min(rest // tick, config.cycle_ticks - 1)
        time += [(begin, index, phase, 1), (edge(known, n + 1), 0, 0, 0)]
    at, payload, valid = zip(*(row for row in command if row[0] < end), strict=True)
    when, index, phase, there = zip(*(row for row in time if row[0] < end), strict=True)
    width = (config.cycle_ticks - 1).bit_length()
    signals = {
        "command.payload": Waveform.of(at, payload, 10),
        "command.valid": Waveform.of(at, valid),
        "time.index": Waveform.of(when, index, 32),
        "time.phase": Waveform.of(when, phase, width),
        "time.valid": Waveform.of(when, there),
        "boot": Waveform.of([0], [int(random.integers(1 << 16))], 16),
    }
    return {f"fpga_{c + 1}.{name}": wave for name, wave in signals.items()}


def _faults(config: Config) -> list[tuple[str, int]]:
    outputs = config.outputs
    found = [(f"line_{c}.{name}", 1) for c in (1, 2) for name in ("flip", "low", "high")]
    found += [(f"fpga_{c}.{name}", 1) for c in (1, 2) for name in ("stopped", "test")]
    found += [("fpga_1_rst", 1), ("fpga_2_rst", 1), ("relay_rst", 1)]
    found += [(f"relay.{name}_{c}", outputs) for c in (1, 2) for name in ("open", "stuck", "rogue")]
    names = ("welded", "broken", "contact_open", "contact_stuck")
    return found + [(f"relay.{name}", outputs) for name in names]


def _pulses(width: int, end: int, cycle: int, random: np.random.Generator) -> Waveform:
    """Some times at some levels, from less than a tick to more than a cycle."""
    ticks, values = [0], [0]
    at = 0
    for _ in range(int(random.integers(1, 5))):
        at += int(random.integers(cycle // 4, 4 * cycle))
        length = int(cycle * 10.0 ** -float(random.uniform(0, 5)))
        ticks += [at, at + length]
        values += [int(random.integers(1, 1 << width)), 0]
        at += length + 1
    kept = [i for i, tick in enumerate(ticks) if tick < end]
    return Waveform.of([ticks[i] for i in kept], [values[i] for i in kept], width)
