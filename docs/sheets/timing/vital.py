"""The vital output's diagrams."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cache

from railgate.vital_output.plant.edges import femtoseconds
from railgate.vital_output.simulate import Run, simulate
from railgate.vital_output.situations import SITUATIONS
from railgate.vital_output.spec import Config, State
from railgate.vital_output.timeline import NAMES
from railgate.waves import Waveform
from sheets.timing.lanes import Diagram, Lane

__all__ = ["cpu_dead", "on_and_off", "start", "vote"]

CONFIG = Config(outputs=2)
FEMTO = 1e-15
MILLI = Fraction(1, 1000)
PULSING = (State.DRIVE, State.TEST)
Span = tuple[Fraction, Fraction]


@cache
def _run(situation: str, span: Span | None = None) -> Run:
    """A situation; pulses and cross-link are kept of a span of it, seconds."""
    return simulate(SITUATIONS[situation].make(CONFIG), CONFIG, waves_s=span)


@cache
def _first_stored(situation: str) -> Fraction:
    """When FPGA 1 first stores a frame that commands output 0 on, seconds."""
    stores = _run(situation).channels[0].stores
    at = next(at for at, frame in stores if frame.image & 1)
    return Fraction(at, 10**15)


def _state(run: Run, fpga: int) -> Lane:
    wave = run.channels[fpga - 1].state(0)
    return Lane(f"FPGA {fpga} output 0", wave, lambda value: NAMES[State(value)])


def _bit(wave: Waveform) -> Waveform:
    """Its lowest bit: what is of output 0."""
    return Waveform.of(wave.ticks, wave.values & 1)


def _frames(run: Run, fpga: int, least_ms: float) -> Lane:
    """The command's stream, as a pulse that lasts so long at least that it is seen."""
    ticks, values = [0], [0]
    wide = int(least_ms * 1e12)
    for frame in run.channels[fpga - 1].frames:
        ticks += [frame.at, frame.at + wide]
        values += [1, 0]
    return Lane(f"CPU {fpga} frame", Waveform.of(ticks, values))


def _common(run: Run, least_ms: float) -> list[Lane]:
    """Frames, life, image, states."""
    one = run.channels[0]
    return [
        _frames(run, 1, least_ms),
        _frames(run, 2, least_ms),
        Lane("FPGA 1 life", one.wave("life"), str),
        Lane("FPGA 1 image", one.wave("image"), lambda value: f"{value:#x}"),
        _state(run, 1),
        _state(run, 2),
    ]


def _diagram(
    title: str,
    lanes: Sequence[Lane],
    span: Span,
    marks: Sequence[tuple[Fraction, str]],
    zero: Fraction = Fraction(0),
) -> Diagram:
    """Of a span in seconds."""
    return Diagram(
        title=title,
        lanes=lanes,
        tick_s=FEMTO,
        start=femtoseconds(span[0]),
        end=femtoseconds(span[1]),
        zero=femtoseconds(zero),
        marks=[(femtoseconds(at), text) for at, text in marks],
    )


def on_and_off() -> Diagram:
    """A whole run: test of the shut-off paths, on, off."""
    run = _run("good")
    contact = Lane("relay's contact", _bit(run.trace["contact"]))
    on, off = (command.start_s for command in run.scenario.commands)
    return _diagram(
        "Vital output: both shut-off paths are tested, then output 0 is commanded on, and off",
        [*_common(run, 3), contact],
        (Fraction(0), run.scenario.seconds),
        ((on, "1 commanded"), (off, "0 commanded")),
    )


def vote() -> Diagram:
    """From the frames to the pulses."""
    stored = _first_stored("good")
    span = (stored - MILLI / 2, stored + MILLI / 2)
    run = _run("good", span)
    one = run.channels[0]
    pulses = [
        Lane(f"FPGA {fpga} pulses", _bit(run.waves[f"fpga_{fpga}.pulses"])) for fpga in (1, 2)
    ]
    links = [Lane(f"cross-link {n}→{3 - n}", run.waves[f"fpga_{n}.link_tx"]) for n in (1, 2)]
    lanes = [
        *_common(run, 0.02)[:2],
        *links,
        Lane("FPGA 1 passed", one.wave("passed_count"), str),
        Lane("FPGA 1 stored", one.wave("stored_count"), str),
        *_common(run, 0.02)[3:],
        *pulses,
    ]
    return _diagram(
        "Vital output: frames, forwarded frames, vote, store, pre-drive, drive, pulses",
        lanes,
        span,
        ((stored, "FPGA 1 stores"),),
        zero=stored,
    )


def start() -> Diagram:
    """From drive to the closed contact."""
    stored = _first_stored("good")
    span = (stored - 5 * MILLI, stored + 45 * MILLI)
    run = _run("good", span)
    pulses = [
        Lane(f"FPGA {fpga} pulses", _bit(run.waves[f"fpga_{fpga}.pulses"])) for fpga in (1, 2)
    ]
    contact = Lane("relay's contact", _bit(run.waves["contact"]))
    return _diagram(
        "Vital output: both pulse trains run, and the relay picks up",
        [*_common(run, 0.4)[4:], *pulses, contact],
        span,
        ((stored, "FPGA 1 stores"),),
        zero=stored,
    )


def cpu_dead() -> Diagram:
    """The life of the last command, and the declared reaction time."""
    run = _run("cpu-dead")
    (closing,) = run.verdict.closings
    live, opened = (Fraction(at or 0, 10**15) for at in (closing.live, closing.opened))
    contact = Lane("relay's contact", _bit(run.trace["contact"]))
    declared = live + run.verdict.declared_s
    return _diagram(
        "Vital output: CPU 1 dies; the command lives on for its cycles, then both FPGAs stop",
        [*_common(run, 2), contact],
        (live - 60 * MILLI, declared + 20 * MILLI),
        ((live, "last live 1"), (opened, "open"), (declared, "declared")),
        zero=live,
    )
