"""The pictures of a run: they tell only what the contract allows, and every word can be read."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from itertools import combinations
from pathlib import Path

import pytest
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch
from matplotlib.text import Text
from matplotlib.transforms import Bbox

from railgate.vital_output.diagram import EDGES, draw_states
from railgate.vital_output.observed import Observed
from railgate.vital_output.picture import draw, shown
from railgate.vital_output.plant.cpu import Command
from railgate.vital_output.plant.faults import fault
from railgate.vital_output.plant.scenario import Scenario
from railgate.vital_output.simulate import Run, simulate
from railgate.vital_output.situations import SITUATIONS
from railgate.vital_output.spec import Config, State
from vital_output.runs import run_of

Drawn = Callable[[Callable[[Run, Path], None], Run], Figure]


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Drawn:
    """Draws, and gives back the figure that went into the file."""
    kept: list[Figure] = []
    save = Figure.savefig
    monkeypatch.setattr(Figure, "savefig", lambda f, *a, **k: (kept.append(f), save(f, *a, **k)))

    def figure(draws: Callable[[Run, Path], None], run: Run) -> Figure:
        draws(run, tmp_path / "drawn.png")
        assert (tmp_path / "drawn.png").read_bytes().startswith(b"\x89PNG")
        return kept[-1]

    return figure


def boxes(figure: Figure) -> dict[str, Bbox]:
    """Where each text stands, in pixels; of ticks beyond an axis matplotlib draws none."""
    texts = [text for text in figure.findobj(Text) if text.get_text() and text.get_visible()]
    placed = {f"{text.get_text()} #{i}": text.get_window_extent() for i, text in enumerate(texts)}
    return {name: box for name, box in placed.items() if (box.x0 + box.x1) / 2 < figure.bbox.x1}


def assert_readable(texts: dict[str, Bbox], figure: Figure) -> None:
    for name, box in texts.items():
        assert Bbox.union([figure.bbox, box.padded(-0.5)]).bounds == figure.bbox.bounds, name
    for (one, a), (other, b) in combinations(texts.items(), 2):
        assert not a.padded(-0.5).overlaps(b.padded(-0.5)), (one, other)


def test_no_word_of_the_diagram_is_hidden_even_if_every_arrow_was_taken(
    drawn: Drawn, monkeypatch: pytest.MonkeyPatch
) -> None:
    every = [(n * 123_456_789_012_345, *edge) for n, edge in enumerate(12 * list(EDGES))]
    monkeypatch.setattr(Observed, "transitions", lambda *_: every)
    figure = drawn(draw_states, run_of("channel-restart"))
    texts = boxes(figure)
    assert sum("FPGA 1: 12 ×" in text for text in texts) == len(EDGES)
    assert_readable(texts, figure)
    for node in figure.findobj(FancyBboxPatch):
        box = node.get_window_extent()
        over = [text for text, each in texts.items() if box.overlaps(each) and "×" in text]
        assert over == []


@pytest.mark.parametrize("situation", SITUATIONS)
def test_a_run_takes_only_arrows_that_the_contract_has(situation: str) -> None:
    run = run_of(situation)
    for channel in run.channels:
        for output in range(run.config.outputs):
            taken = {(State(old), State(new)) for _, old, new in channel.transitions(output)}
            assert taken <= EDGES.keys()


def test_the_diagram_tells_how_often_and_when_first(drawn: Drawn) -> None:
    texts = " ".join(boxes(drawn(draw_states, run_of("channel-restart"))))
    assert "command 1\nFPGA 1: 2 ×, 0." in texts
    assert "drive\nat the end: FPGA 1, FPGA 2" in texts
    assert "reset to idle: FPGA 1 1 ×, 0." in texts


def busy() -> Run:
    """With all of its outputs on, many faults and causes."""
    faults = ("pulse-open-1:2@600ms..800ms", "corruption-1:3@700ms..820ms", "welded:5@1s")
    faults += ("link-noise:20000@900ms..950ms", "link-cut-1@1.2s..1.4s", "cpu-2-dead@1.6s")
    times = ((400, 0xFFFF), (1000, 5), (1500, 0))
    scenario = Scenario(
        commands=tuple(Command(start_s=Fraction(ms, 1000), image=image) for ms, image in times),
        seconds=Fraction(2),
        faults=tuple(fault(text) for text in faults),
    )
    return simulate(scenario, Config())


@pytest.mark.parametrize("situation", ["good", "welded-contact", "feedback-open", None])
def test_every_word_of_the_course_can_be_read(drawn: Drawn, situation: str | None) -> None:
    run = run_of(situation) if situation else busy()
    figure = drawn(draw, run)
    texts = boxes(figure)
    assert_readable(texts, figure)
    told = " ".join(texts)
    for name in ("CPU 1", "FPGA 2", "contact", "declared", "life / cycles", "time / s"):
        assert name in told
    for each in run.scenario.faults:
        assert each.kind in told


def test_the_outputs_that_moved_are_drawn_at_most_three() -> None:
    assert shown(run_of("good")) == [0]
    never = run_of("clock-off")
    assert shown(replace(never, scenario=replace(never.scenario, commands=()))) == [0]
    other = (Command(start_s=Fraction(0), image=2),)
    assert shown(replace(never, scenario=replace(never.scenario, commands=other))) == [1]
    assert shown(busy()) == [0, 1, 2]
