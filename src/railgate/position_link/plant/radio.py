"""The radio unit as a function of the link's serial line."""

from __future__ import annotations

import numpy as np

from railgate.engines.signals import parts
from railgate.position_link.plant.clk import Clk
from railgate.position_link.plant.words import Bits, Words, checks, from_bits
from railgate.position_link.spec import Config
from railgate.waves import Trace, Waveform
from railgate.waves.waveform import Ticks

__all__ = ["outputs", "received"]

COUNT_BITS = 32
BLOCK = 8192
"""Frames that are sampled at once."""


def outputs(config: Config) -> dict[str, int]:
    """What a radio unit tells, and the width of each: the frame's fields, and whether its check is
    right; the counts of right frames and of faults."""
    fields = {field.name: field.width for field in config.frame_fields}
    return fields | {"right": 1, "frames": COUNT_BITS, "faults": COUNT_BITS}


def received(config: Config, link: Trace) -> Trace:
    """What a radio unit tells over the time of `link`, as `radio.word`, …

    link: signals radio_valid and radio_data from tick 0 on, beside others; CLK is as the
    specification has it. Raises ValueError.
    """
    if link.start:
        raise ValueError(f"the radio line must begin in tick 0, not {link.start}")
    clk = Clk(config)
    first, last = _frames(link["radio_valid"], clk, link.end)
    ends = clk.fall(last) + 1
    first, last, ends = (each[ends < link.end] for each in (first, last, ends))
    whole = last - first == config.frame_bits
    bits = _sampled(link["radio_data"], clk, first[whole], config.frame_bits)
    values = _fields(config, bits)
    good = whole.copy()
    good[whole] = values["right"][:, 0] != 0
    signals: dict[str, Waveform] = {}
    for name, rows in values.items():
        signals |= _waves(name, outputs(config)[name], ends[whole], rows)
    for name, counted in (("frames", good), ("faults", ~good)):
        count = np.cumsum(counted).astype(np.uint64) & np.uint64((1 << COUNT_BITS) - 1)
        signals |= _waves(name, COUNT_BITS, ends, count[:, None])
    return Trace(signals, link.period, 0, link.end)


def _fields(config: Config, bits: Bits) -> dict[str, Words]:
    """The fields of frames of the right length, and whether each one's check is right."""
    values, at = {}, 0
    for field in config.frame_fields:
        values[field.name] = from_bits(bits[:, at : at + field.width])
        at += field.width
    values["right"] = np.ones((bits.shape[0], 1), np.uint64)
    if not config.bare:
        check = checks(config.radio_check, bits[:, : -config.radio_check.width])
        values["right"] = (check == values["check"]).astype(np.uint64)
    return values


def _frames(valid: Waveform, clk: Clk, end: int) -> tuple[Ticks, Ticks]:
    """Of each run of samples with valid 1 the falling edges: its first, and the one behind it."""
    high = np.flatnonzero(valid.values)
    edges = np.append(valid.ticks, end)
    first = clk.falls_before(np.maximum(edges[high], 1))
    last = clk.falls_before(np.maximum(edges[high + 1], 1))
    seen = last > first
    first, last = first[seen], last[seen]
    new = np.ones(first.size, np.bool_)
    new[1:] = first[1:] != last[:-1]
    return first[new], last[np.append(new[1:], True)[: new.size]]


def _sampled(data: Waveform, clk: Clk, first: Ticks, size: int) -> Bits:
    """The bits of the frames whose first one is sampled with these falling edges."""
    bits = np.empty((first.size, size), np.uint8)
    for start in range(0, first.size, BLOCK):
        edges = first[start : start + BLOCK, None] + np.arange(size)
        bits[start : start + BLOCK] = data.at(clk.fall(edges))
    return bits


def _waves(name: str, width: int, ticks: Ticks, values: Words) -> dict[str, Waveform]:
    """A signal, or its parts, that is 0 at first and then takes a row of values at each tick."""
    return {
        part: Waveform.of(np.append(0, ticks), np.append(np.uint64(0), values[:, i]), wide)
        for i, (part, wide, _) in enumerate(parts(f"radio.{name}", width))
    }
