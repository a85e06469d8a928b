"""What a channel tells of itself, with its enumerations; read from a run or from bytes (NET-5)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import Any, TypeVar

from railgate.vital_output.spec import CAUSES, Cause, Config, State, TestPhase, pack, unpack
from railgate.waves import Trace
from railgate.waves.waveform import MAX_WIDTH

__all__ = ["Status", "status_bytes"]

STATE_BITS = 3
NUMBERS = ("index", "sequence", "life", "image", "acknowledge", "blocked", "first_output")
FLAGS = ("trusted", "linked", "drifting", "latched")
COUNTS = ("accepted", "start", "lost", "passed", "stored")

Kind = TypeVar("Kind", bound=IntEnum)


def status_bytes(config: Config) -> int:
    """The length of a status as bytes."""
    return -(-sum(field.width for field in config.fields) // 8)


@dataclass(frozen=True, kw_only=True)
class Status:
    """A channel's status in one tick; see `states.status_fields` for what each field means.

    image, acknowledge, blocked: bit i is output i's. states: of each output. accepted,
    start, lost, passed, stored, causes: counters, modulo their width.
    """

    index: int
    trusted: bool
    sequence: int
    life: int
    image: int
    acknowledge: int
    states: tuple[State, ...]
    blocked: int
    test_phase: TestPhase
    linked: bool
    drifting: bool
    latched: bool
    first_cause: Cause
    first_output: int
    accepted: int
    start: int
    lost: int
    passed: int
    stored: int
    causes: Mapping[Cause, int]

    @classmethod
    def at(cls, config: Config, trace: Trace, tick: int, prefix: str = "") -> Status:
        """What the fields hold in this tick of a run, by their names behind the prefix, as
        `fpga_1.`. Raises ValueError, as `of` does."""
        values = {}
        for field in config.fields:
            whole = 0
            for low in range(0, field.width, MAX_WIDTH):
                part = f".{low // MAX_WIDTH}" if field.width > MAX_WIDTH else ""
                whole |= int(trace[prefix + field.name + part].at(tick)) << low
            values[field.name] = whole
        return cls.of(config, values)

    @classmethod
    def from_bytes(cls, config: Config, data: bytes) -> Status:
        """The fields one after the other, the first one in the most significant bits, zeros in
        front to whole bytes. Raises ValueError for another length, and as `of` does."""
        size = status_bytes(config)
        if len(data) != size:
            raise ValueError(f"a status must have {size} bytes, not {len(data)}")
        packed = int.from_bytes(data, "big")
        used = sum(field.width for field in config.fields)
        if packed >> used:
            raise ValueError(f"a status must begin with {8 * size - used} zeros, not {data[0]:#x}")
        return cls.of(config, unpack(config.fields, packed))

    @classmethod
    def of(cls, config: Config, values: Mapping[str, int]) -> Status:
        """From the fields' numbers by name. Raises ValueError where one has no meaning."""
        states = [values["states"] >> STATE_BITS * i & 7 for i in range(config.outputs)]
        told: dict[str, Any] = {
            **{name: values[name] for name in NUMBERS},
            **{name: bool(values[name]) for name in FLAGS},
            **{name: values[f"{name}_count"] for name in COUNTS},
        }
        return cls(
            **told,
            states=tuple(_meaning(State, f"state {i}", code) for i, code in enumerate(states)),
            test_phase=TestPhase(values["test_phase"]),
            first_cause=_meaning(Cause, "first_cause", values["first_cause"]),
            causes={cause: values[f"{cause.name.lower()}_count"] for cause in CAUSES},
        )

    def to_bytes(self, config: Config) -> bytes:
        """What `from_bytes` reads. Raises ValueError where a number does not fit."""
        values = {
            **vars(self),
            **{f"{name}_count": getattr(self, name) for name in COUNTS},
            **{f"{cause.name.lower()}_count": self.causes[cause] for cause in CAUSES},
            "states": sum(state << STATE_BITS * i for i, state in enumerate(self.states)),
        }
        return pack(config.fields, values).to_bytes(status_bytes(config), "big")


def _meaning(kind: type[Kind], name: str, code: int) -> Kind:
    if code > max(kind):
        raise ValueError(f"{name} must be between 0 and {int(max(kind))}, not {code}")
    return kind(code)
