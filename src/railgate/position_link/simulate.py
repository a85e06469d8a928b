"""The link against a simulated position system: its cycles, words, ages, faults and waves."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, dataclass
from typing import Any

from railgate.engines import Engine, open_engine
from railgate.engines.signals import parts
from railgate.position_link.decode import word_text
from railgate.position_link.design import design
from railgate.position_link.host import (
    Deliveries,
    Delivery,
    Layout,
    Summary,
    deliveries,
    summary,
)
from railgate.position_link.loop import loop
from railgate.position_link.plant import Scenario, received
from railgate.position_link.plant.radio import outputs
from railgate.position_link.spec import Config
from railgate.waves import Trace

__all__ = ["Run", "simulate"]

Progress = Callable[[float], None]

PART_CYCLES = 500
"""So many are run at once, where no progress is reported."""
PINS = ("clk", "anf", "uef", "data")
RADIO = ("radio_valid", "radio_data")


@dataclass(frozen=True)
class Run:
    """What a link made of a scenario.

    deliveries: one each cycle. radio_frames, radio_faults: what the radio unit received, right and
    wrong. waves: pins and fields of the first cycles, in ticks of the clock.
    """

    engine: str
    config: Config
    cycles: int
    deliveries: Deliveries
    radio_frames: int
    radio_faults: int
    waves: Trace

    @property
    def summary(self) -> Summary:
        """The run in figures."""
        return summary(self.deliveries)

    def as_json(self) -> dict[str, Any]:
        """All but the waves, as plain numbers, strings and lists; see docs/commands.md."""
        config = self.config
        return {
            "engine": self.engine,
            "clock_hz": config.clock_hz,
            "bit_rate_hz": float(config.bit_rate_hz),
            "cycle_ticks": config.cycle_ticks,
            "word_bits": config.word_bits,
            "duration_s": float(self.cycles * config.cycle_s),
            **asdict(self.summary),
            "availability": self.summary.availability,
            "radio_frames": self.radio_frames,
            "radio_faults": self.radio_faults,
            "cycles": [self._told(each) for each in self.deliveries],
        }

    def _told(self, each: Delivery) -> dict[str, Any]:
        """One cycle as plain numbers, strings and lists."""
        return {
            "tick": each.tick,
            "t_s": each.time_s,
            "number": each.number,
            "word": word_text(each.word, self.config.word_bits),
            "status": each.status.name.lower(),
            "age": each.age,
            "age_s": each.age_s,
            "health": each.health.name.lower(),
            "causes": list(each.causes),
            "values": dict(each.values),
            "consistent": each.consistent,
        }


def simulate(
    scenario: Scenario,
    config: Config,
    cycles: int,
    engine: str = "leap",
    layout: Layout | None = None,
    wave_cycles: int = 0,
    progress: Progress | None = None,
) -> Run:
    """Run so many cycles: leap on the plant's step functions, the others on the closed loop.

    layout: of the words, for their values. wave_cycles: of so many cycles at the beginning, at
    least one, all pins are kept, CLK too. Raises ValueError.
    """
    planned = scenario.plan(config, cycles)
    leaps = engine == "leap"
    stimulus = planned.drive() if leaps else planned.controls()
    opened = open_engine(design(config) if leaps else loop(config), engine)
    radio = _parts(outputs(config), "radio.")
    fields = _parts({field.name: field.width for field in config.fields})
    told = ["delivery", *fields, *RADIO, *([] if leaps else radio)]
    kept = min(max(wave_cycles, 1) * config.cycle_ticks, stimulus.end)
    part = config.cycle_ticks * (1 if progress else PART_CYCLES)
    first = list(_run(opened, kept, stimulus, part, None, progress))
    rest = list(_run(opened, stimulus.end, stimulus, part, told, progress))
    waves = first[0].concatenate(*first[1:])
    link = waves.select(told).concatenate(*rest)
    if leaps:
        heard = received(config, link)
        pins = stimulus.slice(0, waves.end)
        waves, link = waves.merge(pins).merge(heard.slice(0, waves.end)), link.merge(heard)
    return Run(
        engine=engine,
        config=config,
        cycles=cycles,
        deliveries=deliveries(link, config, layout),
        radio_frames=int(link["radio.frames"].values[-1]),
        radio_faults=int(link["radio.faults"].values[-1]),
        waves=waves.select([*PINS, *RADIO, "delivery", *fields, *radio]),
    )


def _parts(widths: Mapping[str, int], prefix: str = "") -> list[str]:
    """The names of the signals of these members, wide ones in parts."""
    found = [parts(prefix + name, width) for name, width in widths.items()]
    return [name for members in found for name, *_ in members]


def _run(
    opened: Engine,
    until: int,
    stimulus: Trace,
    part: int,
    outputs: list[str] | None,
    progress: Progress | None,
) -> Iterator[Trace]:
    """Run to a tick in parts of so many ticks, with these outputs."""
    while opened.now < until:
        yield opened.advance(min(opened.now + part, until), stimulus, outputs)
        if progress:
            progress(opened.now / stimulus.end)
