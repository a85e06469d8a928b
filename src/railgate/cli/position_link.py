"""The position link's commands."""

from __future__ import annotations

import re
from dataclasses import dataclass, fields
from math import ceil
from pathlib import Path
from typing import Annotated, Any

import typer

from railgate import quantity
from railgate.cli.options import option, whole_hz, with_setup
from railgate.cli.output import present, running
from railgate.engines import ENGINES
from railgate.position_link.decode import decode
from railgate.position_link.host import Layout, example, read_layout
from railgate.position_link.plant import Scenario
from railgate.position_link.plant import fault as parse_fault
from railgate.position_link.simulate import simulate
from railgate.position_link.spec import EVEN, ODD, Check, Config, Edge
from railgate.position_link.table import show, show_decoded
from railgate.waves import read

__all__ = ["Line", "Link", "decode_", "simulate_link"]

OF_WORDS = ("word_bits", "fault_word", "zero_is_fault", "check")
"""What a layout says too."""
CRC = re.compile(r"crc:(\d+)((?::0x[0-9a-fA-F]+){1,3})", re.ASCII)


@dataclass(frozen=True)
class Line:
    """A line to a position system and its words, as the user gave them."""

    bit_rate: Annotated[str, option("Rate of CLK.")] = "512kHz"
    cycle: Annotated[str, option("From request to request.")] = "20ms"
    request: Annotated[int, option("Width of ANF, CLK.")] = 10
    timeout: Annotated[int, option("UEF rises within so many CLK of the request.")] = 30
    timeout_from_end: Annotated[
        bool, option("The timeout counts from ANF's end.", "--timeout-from-end")
    ] = False
    earliest: Annotated[int, option("The first CLK with which UEF may rise, from 1.")] = 2
    rising: Annotated[bool, option("DATA is read with rising CLK.", "--rising")] = False
    word_bits: Annotated[int, option("Length of the word, without a layout.")] = 64
    fault_word: Annotated[str | None, option("As 0xffff; None: all ones. No layout.")] = None
    zero_is_fault: Annotated[
        bool, option("The word zero is none. No layout.", "--zero-is-fault")
    ] = False
    check: Annotated[
        str, option("none, even, odd, crc:WIDTH:POLY[:INITIAL[:FINAL]]. No layout.")
    ] = "none"
    layout: Annotated[Path | None, option("What the word's bits mean, a TOML file.")] = None
    json: Annotated[bool, option("Print one JSON object and nothing else.", "--json")] = False
    out: Annotated[Path | None, option("Write tables, waves and a picture there.")] = None

    @property
    def says_words(self) -> list[str]:
        """The options given that a layout says too."""
        given = [
            f for f in fields(self) if f.name in OF_WORDS and getattr(self, f.name) != f.default
        ]
        return [f"--{field.name.replace('_', '-')}" for field in given]

    def words(self) -> Layout | None:
        """The layout, where there is one. Raises ValueError."""
        if self.layout is None:
            return None
        if self.says_words:
            raise ValueError(f"--layout says what {', '.join(self.says_words)} says: give one")
        return read_layout(self.layout)

    def config(self, layout: Layout | None, **more: Any) -> Config:
        """The link's configuration. Raises ValueError."""
        config = Config(
            bit_rate_hz=quantity.frequency_hz(self.bit_rate),
            cycle_s=quantity.time_s(self.cycle),
            request_bits=self.request,
            timeout_bits=self.timeout,
            timeout_from_end=self.timeout_from_end,
            earliest_clk=self.earliest,
            sampling_edge=Edge.RISING if self.rising else Edge.FALLING,
            word_bits=self.word_bits,
            fault_word=None if self.fault_word is None else _number(self.fault_word),
            zero_is_fault=self.zero_is_fault,
            check=_check(self.check),
            **more,
        )
        return config if layout is None else layout.applied_to(config)


@dataclass(frozen=True)
class Link(Line):
    """A position link, the engine and where the result goes, as the user gave them."""

    clock: Annotated[str, option("Reference clock.")] = "40MHz"
    tolerated: Annotated[int, option("Faulty cycles in a row that raise the alarm.")] = 3
    recovery: Annotated[int, option("Good cycles in a row that end it.")] = 1
    filter: Annotated[int, option("Glitch filter: levels of at most so many ticks vanish.")] = 10
    guard: Annotated[int, option("DATA holds still so many ticks about its sampling.")] = 4
    bare: Annotated[bool, option("The radio unit takes the bare word.", "--bare")] = False
    engine: Annotated[
        str, option(f"{', '.join(ENGINES)}: leap is the model, the others the gateware.")
    ] = "leap"

    def built(self, layout: Layout | None) -> Config:
        """The link's configuration. Raises ValueError."""
        return self.config(
            layout,
            clock_hz=whole_hz("--clock", self.clock),
            tolerated_cycles=self.tolerated,
            recovery_cycles=self.recovery,
            filter_ticks=self.filter,
            guard_ticks=self.guard,
            bare=self.bare,
        )


def _number(text: str) -> int:
    try:
        return int(text, 0)
    except ValueError:
        raise ValueError(f"--fault-word must be a number as 0xffff, not {text!r}") from None


def _check(text: str) -> Check | None:
    known = {"none": None, "even": EVEN, "odd": ODD}
    if text in known:
        return known[text]
    if not (found := CRC.fullmatch(text)):
        raise ValueError(
            "--check must be none, even, odd or crc:WIDTH:POLY[:INITIAL[:FINAL]], "
            f"as crc:8:0x2f:0xff:0xff, not {text!r}"
        )
    names = ("polynomial", "initial", "final")
    numbers = [int(part, 16) for part in found[2][1:].split(":")]
    return Check(width=int(found[1]), **dict(zip(names, numbers, strict=False)))


@with_setup
def simulate_link(
    fault: Annotated[
        list[str] | None,
        typer.Option(help="KIND[:VALUE]@TIME or @T0..T1, again for each fault."),
    ] = None,
    seconds: Annotated[str, typer.Option(help="Length of the run.")] = "0.5s",
    speed: Annotated[float, typer.Option(help="Of the train whose words are sent, km/h.")] = 430.0,
    latency: Annotated[
        int | None, typer.Option(help="The CLK with which UEF rises; None: mid-window.")
    ] = None,
    delay: Annotated[int, typer.Option(help="Of cable and launch, ticks.")] = 2,
    seed: Annotated[int, typer.Option(help="Of all that is random.")] = 0,
    waves: Annotated[
        int, typer.Option(min=1, max=1000, help="So many cycles, the first ones, go into waves.")
    ] = 25,
    *,
    setup: Link,
) -> None:
    """A simulated position system through the link: cycles, words, ages, faults."""
    layout = setup.words()
    if layout is None and not setup.says_words:
        layout = example()
    config = setup.built(layout)
    scenario = Scenario(
        speed_kmh=speed,
        latency_clk=latency,
        delay_ticks=delay,
        faults=tuple(parse_fault(text) for text in fault or ()),
        seed=seed,
    )
    cycles = ceil(quantity.time_s(seconds) / config.cycle_s)
    with running(setup.engine) as progress:
        run = simulate(
            scenario,
            config,
            cycles,
            engine=setup.engine,
            layout=layout,
            wave_cycles=waves if setup.out else 0,
            progress=progress,
        )
    paths = []
    if setup.out:
        from railgate.position_link.record import record  # matplotlib doubles the time to start

        paths = record(run, setup.out)
    present(run.as_json() if setup.json else show(run), paths)


@with_setup
def decode_(
    capture: Annotated[Path, typer.Argument(help="A .sr, .vcd, .fst, .csv or .parquet file.")],
    clk: Annotated[str, typer.Option(help="The channel that is CLK.")],
    uef: Annotated[str, typer.Option(help="The channel that is UEF.")],
    data: Annotated[str, typer.Option(help="The channel that is DATA.")],
    anf: Annotated[
        str | None, typer.Option(help="The channel that is ANF; without, UEF alone is judged.")
    ] = None,
    filter: Annotated[
        int, typer.Option(help="Levels of at most so many of the capture's ticks are none.")
    ] = 0,
    *,
    setup: Line,
) -> None:
    """Words and faults from a capture of a position system's line."""
    channels = {clk: "clk", uef: "uef", data: "data"} | ({anf: "anf"} if anf else {})
    if len(channels) < 3 + bool(anf):
        raise ValueError(f"CLK, UEF, DATA and ANF must be different channels, not {list(channels)}")
    layout = setup.words()
    # What only a link must fit into a bit and a cycle, its own filter and frame, binds no capture.
    config = setup.config(layout, filter_ticks=0, bare=True)
    found = decode(read(capture, list(channels)).rename(channels), config, layout, filter)
    paths = []
    if setup.out:
        from railgate.position_link.record import record_decoded

        paths = record_decoded(found, setup.out)
    present(found.as_json() if setup.json else show_decoded(found), paths)
