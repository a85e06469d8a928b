"""What the link delivered: words to values in engineering units, with their age and why.

A delivery's values are those of a word that can be believed, FRESH or HELD. With status FAULT there
are none, whatever the word's bits. Requirements LNK-5, LNK-6, LNK-7, LNK-8.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from railgate.position_link.host.layout import Layout
from railgate.position_link.host.words import Words, pack, parted, sound, unpack
from railgate.position_link.spec import Config, Health, Status, cause_names
from railgate.waves.trace import Trace
from railgate.waves.waveform import Ticks

__all__ = ["Deliveries", "Delivery", "deliveries", "position_uncertainty_m"]

Masked: TypeAlias = "np.ma.MaskedArray[Any, np.dtype[Any]]"


def position_uncertainty_m(age_s: float, speed_max_kmh: float) -> float:
    """How far the vehicle can have come since a word of that age, metres."""
    return age_s * speed_max_kmh / 3.6


@dataclass(frozen=True)
class Delivery:
    """One delivery.

    tick, time_s: of the delivery, since the run's tick 0. number: as counted by the link, modulo
    its width. age: cycles since the last good one. age_s: since UEF rose for the word; None where
    there was none yet or it is longer ago than the link can count. causes: why the cycle was
    faulty, in lower case. values: name -> value by the layout; empty where there is no word to
    believe. consistent: its fields do not contradict one another, see `Deliveries.inconsistent`.
    """

    tick: int
    time_s: float
    number: int
    word: int
    status: Status
    age: int
    age_s: float | None
    health: Health
    causes: tuple[str, ...]
    values: Mapping[str, float]
    consistent: bool


@dataclass(frozen=True, eq=False)
class Deliveries:
    """The deliveries of a run, column by column, in order; `deliveries[i]` is one of them.

    ticks: int64, shape (n,). words: (n, parts), see `Layout.columns`. fields: the other fields of
    `Config.fields`, name -> shape (n,). layout: None: the words stay words.
    """

    config: Config
    layout: Layout | None
    ticks: Ticks
    words: Words
    fields: Mapping[str, NDArray[Any]]

    def __len__(self) -> int:
        return self.ticks.size

    @cached_property
    def age_s(self) -> NDArray[np.float64]:
        """Seconds since UEF rose for the word; inf where there was none yet, or too long ago."""
        ticks = self.fields["age_ticks"]
        counted = ticks < (1 << self.config.age_ticks_bits) - 1
        return np.where(counted, ticks / self.config.clock_hz, np.inf)

    @cached_property
    def inconsistent(self) -> NDArray[np.bool_]:
        """Where the fields contradict one another, as those of a sound link never do.

        Status or health of no meaning, FAULT without the fault word, or a FRESH or HELD word that
        is the fault word, zero where that is none, or fails its check.
        """
        status, health = self.fields["status"], self.fields["health"]
        unknown = (status > max(Status)) | (health > max(Health))
        fault_word = pack([self.config.invalid_word], self.config.word_bits)
        fault = (self.words == fault_word.reshape(1, -1)).all(axis=1)
        believed = (status == Status.FRESH) | (status == Status.HELD)
        wrong = np.where(believed, ~sound(self.words, self.config), ~fault)
        wrong |= unknown
        return wrong

    @cached_property
    def believed(self) -> NDArray[np.bool_]:
        """Where there is a word to believe: FRESH or HELD, and nothing speaks against it."""
        word: NDArray[np.bool_] = self.fields["status"] != Status.FAULT
        return word & ~self.inconsistent

    @cached_property
    def values(self) -> dict[str, Masked]:
        """The layout's fields, name -> shape (n,), masked (and 0) where no word is believed."""
        if self.layout is None:
            return {}
        columns = self.layout.columns(self.words)
        absent = ~self.believed
        return {
            name: np.ma.MaskedArray(np.where(absent, column.dtype.type(0), column), mask=absent)
            for name, column in columns.items()
        }

    @cached_property
    def restarted(self) -> NDArray[np.bool_]:
        """Where the numbers begin anew, after a reset; the first too where it is number 1.

        They do where they do not go on, or by half of their range or more.
        """
        number, half = self.fields["number"], 1 << self.config.count_bits - 1
        step = self._forward(number)
        anew: NDArray[np.bool_] = (step == 0) | (step >= half)
        anew[:1] = number[:1] == 1
        return anew

    @cached_property
    def lost(self) -> NDArray[np.int64]:
        """How many deliveries are missing right before each, by the numbers."""
        number = self.fields["number"].astype(np.int64)
        missing = np.where(self.restarted, number, self._forward(number)) - 1
        return missing.clip(min=0)

    def grown(self, name: str) -> int:
        """By how much one of the counts grew over the run, resets and lost deliveries included.

        From the first delivery on, or from the reset where that is number 1. Between deliveries a
        count must grow by less than 2^count_bits.
        """
        count = self.fields[name].astype(np.int64)
        more = np.where(self.restarted, count, self._forward(count))
        return int(more.sum())

    def _forward(self, counts: NDArray[Any]) -> NDArray[np.int64]:
        """How far a count went on from delivery to delivery; to the first by 0."""
        wide = counts.astype(np.int64)
        more: NDArray[np.int64] = wide - np.concatenate([wide[:1], wide[:-1]])
        return more & np.int64((1 << self.config.count_bits) - 1)

    def __getitem__(self, i: int) -> Delivery:
        fields = {name: int(column[i]) for name, column in self.fields.items()}
        status, health = fields["status"], fields["health"]
        age_s = float(self.age_s[i])
        return Delivery(
            tick=int(self.ticks[i]),
            time_s=int(self.ticks[i]) / self.config.clock_hz,
            number=fields["number"],
            word=unpack(self.words[[i]])[0],
            status=Status(status) if status <= max(Status) else Status.FAULT,
            age=fields["age"],
            age_s=age_s if np.isfinite(age_s) else None,
            health=Health(health) if health <= max(Health) else Health.ALARM,
            causes=cause_names(fields["causes"]),
            values={name: column.data[i].item() for name, column in self.values.items()}
            if self.believed[i]
            else {},
            consistent=not self.inconsistent[i],
        )

    def __iter__(self) -> Iterator[Delivery]:
        return (self[i] for i in range(len(self)))


def deliveries(trace: Trace, config: Config, layout: Layout | None = None) -> Deliveries:
    """The deliveries in a run: one in each tick in which `delivery` is 1.

    trace: holds `delivery` and `Config.fields`, in ticks of the link's clock; a word of more than
    64 bits as `word.0`, `word.1`, … of 64 bits each, the least significant first. layout: must
    describe words of this very link. Raises ValueError.
    """
    if trace.period * config.clock_hz != 1:
        raise ValueError(f"a tick must last 1/{config.clock_hz} s, not {trace.period} s")
    if layout is not None:
        _require_same_word(layout.config, config)
    wave = trace["delivery"]
    ticks = wave.ticks[wave.values != 0]

    def column(name: str, width: int) -> NDArray[Any]:
        if trace[name].width != width:
            raise ValueError(f'"{name}" must be {width} bits wide, not {trace[name].width}')
        return trace[name].at(ticks)

    bits = config.word_bits
    parts = [("word", bits)]
    if bits > 64:
        parts = [(f"word.{low // 64}", min(64, bits - low)) for low in range(0, bits, 64)]
    words = np.stack([column(*part).astype(np.uint64) for part in parts], axis=1)
    fields = {
        field.name: column(field.name, field.width)
        for field in config.fields
        if field.name != "word"
    }
    return Deliveries(config, layout, ticks, parted(words, bits), fields)


def _require_same_word(layout: Config, link: Config) -> None:
    for name in ("word_bits", "invalid_word", "zero_is_fault", "check"):
        its, mine = getattr(layout, name), getattr(link, name)
        if its != mine:
            raise ValueError(f"the layout's {name} must be the link's, {mine}, not {its}")
