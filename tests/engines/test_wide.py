"""Members wider than 64 bits: their parts in pysim and cxxrtl, against numbers of Python's own."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
from amaranth.hdl import Module, signed
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out
from hypothesis import given, settings
from hypothesis import strategies as st

from railgate.engines import Clock, Design, Engine
from railgate.engines.cxxrtl import Cxxrtl, netlist
from railgate.engines.pysim import PySim
from railgate.engines.signals import parts
from railgate.waves import Trace, Waveform

PAIR = data.StructLayout({"low": 60, "high": 70})
WORD, SUM, LEVEL = 512, 65, 100


class Wide(wiring.Component):
    """512 bits rotated and accumulated, 65 bits added to in the same tick, 100 bits signed."""

    def __init__(self) -> None:
        super().__init__(
            {
                "word": In(WORD),
                "mixed": Out(WORD),
                "add": In(SUM),
                "sum": Out(SUM),
                "level": In(signed(LEVEL)),
                "halves": Out(signed(LEVEL)).array(2),
                "minus_one": Out(1),
                "pair": Out(PAIR),
            }
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        m.d.sync += [
            self.mixed.eq(self.mixed ^ self.word.rotate_left(67)),
            self.halves[1].eq(self.level >> 1),
        ]
        m.d.comb += [
            self.sum.eq(self.add + self.word[0]),
            self.halves[0].eq(self.level >> 65),
            self.minus_one.eq(self.level == -1),
            self.pair.low.eq(self.word),
            self.pair.high.eq(self.level),
        ]
        return m


WIDE = Design(name="wide", component=Wide, clocks=(Clock(frequency_hz=Fraction(1_000)),))
PORTS, _, _ = netlist(WIDE)
INPUTS = {port.name: port for port in PORTS if not port.output}
END = 12

Changes = dict[str, dict[int, int]]


def trace(changes: Changes, end: int = END) -> Trace:
    waves = {}
    for name, values in changes.items():
        ticks, held = zip(*sorted({0: 0, **values}.items()), strict=True)
        waves[name] = Waveform.of(ticks, held, INPUTS[name].width, INPUTS[name].signed)
    return Trace(waves, WIDE.period, 0, end)


def driven(name: str) -> st.SearchStrategy[dict[int, int]]:
    port = INPUTS[name]
    low = -(1 << port.width - 1) if port.signed else 0
    return st.dictionaries(
        st.integers(0, END - 1), st.integers(low, low + (1 << port.width) - 1), max_size=4
    )


CHANGES = st.fixed_dictionaries({}, optional={n: driven(n) for n in INPUTS if n != "rst"})


def joined(found: Trace, name: str, width: int, tick: int) -> int:
    """The member's number, its last part's sign too, from the signals of its parts."""
    return sum(int(found[part].at(tick)) << offset for part, _, offset in parts(name, width))


def expected(stimulus: Trace) -> list[dict[str, int]]:
    """What the outputs hold in each tick."""
    driven = Trace(
        {name: Waveform.of([0], [0], p.width, p.signed) for name, p in INPUTS.items()}
        | dict(stimulus.signals),
        stimulus.period,
        0,
        stimulus.end,
    )
    rows, mixed, half = [], 0, 0
    for tick in range(stimulus.end):
        word, add, level = (
            joined(driven, name, width, tick)
            for name, width in (("word", WORD), ("add", SUM), ("level", LEVEL))
        )
        rows.append(
            {
                "mixed": mixed,
                "sum": (add + (word & 1)) % (1 << SUM),
                "halves.0": level >> 65,
                "halves.1": half,
                "minus_one": level == -1,
                "pair": word % (1 << 60) | level % (1 << 70) << 60,
            }
        )
        mixed ^= (word << 67 | word >> WORD - 67) % (1 << WORD)
        half = level >> 1
    return rows


def numbers(found: Trace) -> list[dict[str, int]]:
    """The outputs of an engine in each tick."""
    widths = {"mixed": WORD, "sum": SUM, "halves.0": LEVEL, "halves.1": LEVEL}
    widths |= {"minus_one": 1, "pair": 130}
    return [
        {name: joined(found, name, width, tick) for name, width in widths.items()}
        for tick in range(found.start, found.end)
    ]


@settings(deadline=None, max_examples=40)
@given(CHANGES)
def test_wide_members_carry_their_numbers_through_both_engines(changes: Changes) -> None:
    stimulus = trace(changes)
    compiled, reference = Cxxrtl(WIDE).advance(END, stimulus), PySim(WIDE).advance(END, stimulus)
    assert numbers(compiled) == expected(stimulus)
    assert compiled == reference


@pytest.mark.parametrize("kind", [Cxxrtl, PySim])
def test_a_part_is_driven_alone_and_the_others_hold(kind: type[Engine]) -> None:
    engine: Any = kind(WIDE)
    ones = (1 << 64) - 1
    first = engine.advance(2, trace({"word.3": {0: ones}, "level.0": {0: 5}}, 2))
    assert joined(first, "mixed", WORD, 1) == ones << 3 * 64 + 67
    second = engine.advance(4, trace({"word.0": {0: 1}, "level.1": {0: -1}}, 4))
    assert joined(second, "sum", SUM, 2) == 1
    assert joined(second, "halves.1", LEVEL, 3) == (5 - (1 << 64)) >> 1
    before = joined(second, "mixed", WORD, 2)
    assert joined(second, "mixed", WORD, 3) == before ^ (ones << 3 * 64 | 1) << 67


@pytest.mark.parametrize("kind", [Cxxrtl, PySim])
def test_a_negative_number_has_no_bits_beyond_its_member(kind: type[Engine]) -> None:
    engine: Any = kind(WIDE)
    found = engine.advance(3, trace({"level.0": {1: (1 << 64) - 1}, "level.1": {1: -1}}, 3))
    assert found["minus_one"] == Waveform.of([0, 1], [0, 1])


@pytest.mark.parametrize("kind", [Cxxrtl, PySim])
def test_a_part_of_an_output_has_its_own_changes_only(kind: type[Engine]) -> None:
    engine: Any = kind(WIDE)
    found = engine.advance(END, trace({"word.3": {4: 1, 5: 0}}))
    ticks = {part: found[part].ticks.tolist() for part, *_ in parts("mixed", WORD)}
    assert ticks == {f"mixed.{i}": [0, 5] if i == 4 else [0] for i in range(8)}


@pytest.mark.parametrize("kind", [Cxxrtl, PySim])
def test_from_a_checkpoint_all_parts_go_on_as_they_did(kind: type[Engine]) -> None:
    engine, other = (kind(WIDE) for _ in range(2))  # type: ignore[call-arg]
    changes = {f"word.{i}": {1: 1 << 63 - i, 3: i} for i in range(8)} | {"level.1": {2: -7}}
    engine.advance(5, trace(changes))
    saved = engine.checkpoint()
    first = engine.advance(END, trace({"word.5": {8: 9}}))
    for again in (engine, other):
        again.restore(saved)
        assert again.advance(END, trace({"word.5": {8: 9}})) == first
    assert numbers(first)[0]["mixed"] != numbers(first)[1]["mixed"]


def test_parts_are_named_and_shaped_from_the_least_significant() -> None:
    assert parts("w", 64) == (("w", 64, 0),)
    assert parts("w", 65) == (("w.0", 64, 0), ("w.1", 1, 64))
    assert parts("w", 128) == (("w.0", 64, 0), ("w.1", 64, 64))
    assert parts("w", 4096)[-1] == ("w.63", 64, 4032)
    for width in (0, 4097):
        with pytest.raises(ValueError, match=f'"w" must be between 1 and 4096 .* not {width}'):
            parts("w", width)


@pytest.mark.parametrize("kind", [Cxxrtl, PySim])
def test_the_signals_of_a_design_are_the_parts_of_its_members(kind: type[Engine]) -> None:
    engine: Any = kind(WIDE)
    found = engine.advance(1, trace({}, 1))
    shapes = {name: (wave.width, wave.signed) for name, wave in found.signals.items()}
    assert list(shapes) == [
        *(f"mixed.{i}" for i in range(8)),
        *("sum.0", "sum.1", "halves.0.0", "halves.0.1", "halves.1.0", "halves.1.1"),
        *("minus_one", "pair.0", "pair.1", "pair.2"),
    ]
    assert shapes["mixed.7"] == (64, False)
    assert shapes["sum.1"] == (1, False)
    assert (shapes["halves.1.0"], shapes["halves.1.1"]) == ((64, False), (36, True))
    assert shapes["pair.2"] == (2, False)
    with pytest.raises(ValueError, match=r'no input "word" .*; there are: word\.0, word\.1, .*'):
        engine.advance(2, Trace({"word": Waveform.of([0], [0])}, WIDE.period, 0, 2))
    paths = {(port.path, port.offset) for port in PORTS if port.name == "halves.1.1"}
    assert paths == {(("halves", 1), 64)}


@pytest.mark.parametrize("kind", [Cxxrtl, PySim])
def test_the_widest_member_passes(kind: type[Engine]) -> None:
    class Widest(wiring.Component):
        def __init__(self) -> None:
            super().__init__({"word": In(4096), "back": Out(4096)})

        def elaborate(self, _platform: object) -> Module:
            m = Module()
            m.d.sync += self.back.eq(~self.word.rotate_left(70))
            return m

    design = Design(name="widest", component=Widest, clocks=WIDE.clocks)
    wave = Waveform.of([0], [1], 64)
    engine: Any = kind(design)
    found = engine.advance(2, Trace({"word.63": wave}, design.period, 0, 2))
    assert joined(found, "back", 4096, 1) == (1 << 4096) - 1 - (1 << 6)


@pytest.mark.parametrize("kind", [Cxxrtl, PySim])
def test_what_is_too_wide_or_has_the_name_of_another_is_refused_by_name(kind: Any) -> None:
    def refused(members: dict[str, Any], message: str) -> None:
        class Refused(wiring.Component):
            def __init__(self) -> None:
                super().__init__(members)

            def elaborate(self, _platform: object) -> Module:
                return Module()

        with pytest.raises(ValueError, match=message):
            kind(Design(name="refused", component=Refused, clocks=WIDE.clocks))

    refused({"word": Out(4097)}, '"word" must be between 1 and 4096 bits wide, not 4097')
    refused({"none": Out(0)}, '"none" must be between 1 and 4096 bits wide, not 0')
    refused({"rst": In(1)}, 'a name of its own, not 2 of them "rst"')
