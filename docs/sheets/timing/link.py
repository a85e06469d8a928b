"""The position link's diagrams."""

from __future__ import annotations

from fractions import Fraction
from functools import cache

from railgate.position_link.host import example
from railgate.position_link.plant import Fault, Scenario
from railgate.position_link.simulate import simulate
from railgate.position_link.spec import Config, Health, Status, cause_names
from railgate.waves import Trace, Waveform
from sheets.timing.lanes import Diagram, Lane

__all__ = ["cycle", "faults", "request"]

LAYOUT = example()
CONFIG: Config = LAYOUT.config
TICK_S = 1 / CONFIG.clock_hz
CYCLES = 10
LOST = Fault("missing", 2 * CONFIG.cycle_s, 6 * CONFIG.cycle_s - Fraction(1, 10**6))
LATENCY_CLK = 12


@cache
def _waves() -> Trace:
    """Of the first cycles, four of which are lost."""
    scenario = Scenario(faults=(LOST,), latency_clk=LATENCY_CLK)
    return simulate(scenario, CONFIG, CYCLES, layout=LAYOUT, wave_cycles=CYCLES).waves


def _pins(*names: str) -> list[Lane]:
    return [Lane(name.upper(), _waves()[name]) for name in names]


def request() -> Diagram:
    """The request, and the first bits of the answer."""
    second = 1 + CONFIG.cycle_ticks
    return Diagram(
        title="Position link: ANF for 10 CLK; UEF rises, and DATA is read with falling CLK",
        lanes=_pins("clk", "anf", "uef", "data"),
        tick_s=TICK_S,
        start=second - 100,
        end=second + CONFIG.rise(20),
        unit="µs",
        zero=second,
        marks=((second + CONFIG.rise(LATENCY_CLK - 1), f"UEF rises with CLK {LATENCY_CLK}"),),
    )


def cycle() -> Diagram:
    """From the request to the delivery, and the radio unit's frame."""
    second = 1 + CONFIG.cycle_ticks
    delivery = second + CONFIG.delivery_ticks
    waves = _waves()
    lanes = [
        *_pins("anf", "uef", "data"),
        Lane("delivery", _wide(waves["delivery"], 120)),
        Lane("number", waves["number"], str),
        Lane("word", waves["word"], lambda word: f"{word:016x}"),
        Lane("radio_valid", waves["radio_valid"]),
        Lane("radio_data", waves["radio_data"]),
    ]
    return Diagram(
        title="Position link: one cycle's answer, its delivery, and the frame to the radio unit",
        lanes=lanes,
        tick_s=TICK_S,
        start=second - 400,
        end=second + CONFIG.rise(CONFIG.radio_first + CONFIG.frame_bits + 6),
        unit="µs",
        zero=second,
        marks=((delivery, "delivery, at the same phase of every cycle"),),
    )


def faults() -> Diagram:
    """Answers that are lost: held twice, then the fault word."""
    waves = _waves()
    status, health = ({each.value: each.name.lower() for each in kind} for kind in (Status, Health))
    lanes = [
        Lane("ANF", _wide(waves["anf"], 8000)),
        Lane("UEF", _wide(waves["uef"], 8000)),
        Lane("delivery", _wide(waves["delivery"], 8000)),
        Lane("status", waves["status"], lambda value: status[value]),
        Lane("age", waves["age"], str),
        Lane("health", waves["health"], lambda value: health[value]),
        Lane("causes", waves["causes"], lambda value: ", ".join(cause_names(value)) or "0"),
    ]
    return Diagram(
        title="Position link: four answers are lost; two words are held, then comes the fault word",
        lanes=lanes,
        tick_s=TICK_S,
        start=0,
        end=waves.end - 1,
    )


def _wide(wave: Waveform, ticks: int) -> Waveform:
    """Each pulse so long at least that it is seen."""
    rises, falls = wave.rising(), wave.falling()
    ends = [max(fall, rise + ticks) for rise, fall in zip(rises, falls, strict=False)]
    turns = [turn for pair in zip(rises.tolist(), ends, strict=False) for turn in pair]
    return Waveform.of([int(wave.ticks[0]), *turns], [0, *([1, 0] * len(ends))])
