"""The report: all that a run came to, in one page that needs nothing beside it."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from html.parser import HTMLParser
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from railgate.unit.report.envelope import Envelope
from railgate.unit.report.lanes import HEALTHS, MOST, Span, lanes, stretches
from railgate.unit.report.page import page
from railgate.unit.result import Result

OUTSIDE = re.compile(r"""url\((?!["']?data:)|@import|\bsrcset=|fetch\(|XMLHttpRequest|import\(""")
NUMBERS = st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=300)


class Page(HTMLParser):
    """What a page links to, what it shows as text, and the data in it."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.links: list[str] = []
        self.texts: list[str] = []
        self.rows: list[list[str]] = []
        self.tags: list[str] = []
        self.data: dict[str, Any] = {}
        self._in: tuple[str, dict[str, str | None]] = ("", {})
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        told = dict(attrs)
        self.tags.append(tag)
        self._in = tag, told
        self.links += [value for name in ("src", "href") if (value := told.get(name))]
        if tag == "tr":
            self.rows.append([])

    def handle_data(self, data: str) -> None:
        tag, attributes = self._in
        if attributes.get("id") == "charts" and tag == "script" and data.strip():
            self.data = json.loads(data)
        elif tag not in ("script", "style") and data.strip():
            self.texts.append(data.strip())
            if self.rows:
                self.rows[-1].append(data.strip())


@pytest.fixture(scope="module")
def html(result: Result) -> str:
    return page(result)


@pytest.fixture(scope="module")
def parsed(html: str) -> Page:
    return Page(html)


def test_the_page_needs_nothing_beside_it(html: str, parsed: Page) -> None:
    """It links to waves in its own folder, and loads nothing."""
    assert all(re.fullmatch(r"waves/\d{3}\.(vcd|gtkw)", link) for link in parsed.links)
    assert not {"link", "img", "iframe", "object"} & set(parsed.tags)
    assert not OUTSIDE.search(html)
    assert len(html) < 600_000


def test_the_page_has_the_licence_of_what_draws_its_charts(html: str) -> None:
    assert "uPlot (v1.6.32)" in html
    assert "uPlot 1.6.32, MIT licence" in html
    assert "Permission is hereby granted, free of charge" in html


def test_every_event_has_a_row_with_time_source_text_and_its_waves(
    result: Result, parsed: Page
) -> None:
    rows = [row for row in parsed.rows if any(text.endswith(".vcd") for text in row)]
    assert len(rows) == len(result.events)
    for row, event, number in zip(rows, result.events, result.excerpts.of, strict=True):
        assert row[:3] == [f"{event.time_s:.3f}", event.source, event.what]
        assert number is not None
        assert f"{number + 1:03}.vcd" in row


def test_verdict_figures_faults_and_provenance_are_told_in_words(
    result: Result, parsed: Page
) -> None:
    told = " ".join(parsed.texts)
    for words in (
        "Safe.",
        "declared 258.7 ms",
        "position link: missing",
        "warning: timeout",
        "cpu 1 dead",
        "contact opens",
        "railgate run scenario.toml --engine leap",
        f"{result.run.scenario.config.vital.digest:#010x}",
        "clock within ±100 ppm",
        'kind = "cpu-1-dead"',
    ):
        assert words in told


def test_a_run_that_was_not_safe_says_so_first(result: Result) -> None:
    """With a reaction time that the relay did not keep."""
    wrong = Result(result.name, result.text, result.run)
    late = replace(result.verdict, overdue=result.run.vital.verdict.closings[:1])
    wrong.__dict__["verdict"] = late
    told = Page(page(wrong)).texts
    assert "Not safe." in told
    assert "Safe." not in told
    assert any("without an agreed, live 1" in text for text in told)


def test_names_from_a_file_stay_text(result: Result) -> None:
    text = result.text + "# </pre></script><script>alert(1)</script>"
    found = Page(page(replace(result, name="<img src=x>", text=text)))
    assert "x" not in found.links
    assert found.tags.count("script") == 3
    assert any("<img src=x>" in each for each in found.texts)


def test_charts_have_the_truth_inside_the_interval_wherever_the_run_has(
    result: Result, parsed: Page
) -> None:
    charts = parsed.data
    assert charts["each"] == 1
    assert len(charts["times"]) == result.run.cycles.times_s.size
    for fpga in (1, 2):
        low, truth, high = (
            np.array(charts["speed"][name]) for name in (f"low {fpga}", "truth", f"high {fpga}")
        )
        outside = (truth < low - 1e-3) | (truth > high + 1e-3)
        assert not outside[~result.outside[:, fpga - 1]].any()
    assert charts["speed"]["truth"] == pytest.approx(result.run.cycles.speed_kmh, abs=1e-3)


def test_lanes_have_what_the_run_was_in(result: Result) -> None:
    found = {lane.name: lane for lane in lanes(result)}
    first, second = result.run.scenario.route.calls
    assert [span[:2] for span in found["platform"].spans] == [
        (0.0, first.departs_s),
        (second.arrives_s, second.departs_s),
    ]
    assert ("alarm", "red") in {span[2:] for span in found["position link"].spans}
    assert {span[2] for span in found["odometer 1, axle 2"].spans} <= {"sliding", "lost"}
    assert "odometer 1, axle 1" not in found, "it has rolled all the time"
    relay = found["left doors, relay"].spans
    closings = result.run.vital.verdict.closings
    (left,) = [each for each in closings if each.output == 0]
    assert [span[:2] for span in relay] == [
        pytest.approx((float(left.closed) / 1e15, float(left.opened) / 1e15))
    ]
    states = [span[2] for span in found["left doors, FPGA 1"].spans]
    assert states == ["test", "wait", "pre-drive", "drive", "wait"]


def test_a_cycle_outside_the_interval_has_a_lane_of_its_own(result: Result) -> None:
    assert not [lane for lane in lanes(result) if "interval" in lane.name]
    wrong = Result(result.name, result.text, result.run)
    outside = result.outside.copy()
    outside[100, 1] = True
    wrong.__dict__["outside"] = outside
    (lane,) = [lane for lane in lanes(wrong) if "interval" in lane.name]
    assert lane.name == "odometer 2, speed's interval"
    ((start, end, _, tone),) = lane.spans
    assert (start, end) == tuple(result.run.cycles.times_s[100:102])
    assert tone == "red"


def test_a_lane_of_too_many_spans_keeps_the_rare_ones() -> None:
    """An alarm of a moment in an hour of warnings that come and go."""
    times = np.arange(40_000) * 0.1
    health = np.where(np.arange(times.size) % 2, 2, 1)
    health[20_001] = 3
    found: list[Span] = stretches(times, health, 4000.0, HEALTHS)
    assert len(found) <= MOST
    (alarm,) = [span for span in found if span[2] == "alarm"]
    assert alarm[0] <= times[20_001] < alarm[1]
    assert alarm[1] - alarm[0] <= 2 * 4000.0 / MOST
    assert {span[2] for span in found} == {"warning", "alarm"}


@given(values=NUMBERS, each=st.integers(1, 7))
def test_an_envelope_keeps_extremes_in_their_order(values: list[float], each: int) -> None:
    column, envelope = np.array(values), Envelope(each)
    groups = [column[i : i + each] for i in range(0, column.size, each)]
    line, low, high = envelope.line(column), envelope.least(column), envelope.greatest(column)
    assert line.size == low.size == high.size == envelope.times(np.arange(column.size)).size
    if each == 1:
        assert np.array_equal(line, column)
        return
    for i, group in enumerate(groups):
        pair = line[2 * i : 2 * i + 2]
        assert sorted(pair) == [group.min(), group.max()]
        if pair[0] != pair[1]:
            assert np.argmax(group == pair[0]) < np.argmax(group == pair[1])
        assert low[2 * i] == low[2 * i + 1] == group.min()
        assert high[2 * i] == high[2 * i + 1] == group.max()


@pytest.mark.parametrize("rows", [1, 5_999, 6_000, 6_001, 72_000, 144_000])
def test_an_hour_is_drawn_with_as_few_points_as_a_minute(rows: int) -> None:
    envelope = Envelope.of(rows, 6_000)
    assert envelope.times(np.arange(rows)).size <= 6_000
    assert (envelope.each == 1) == (rows <= 6_000)
