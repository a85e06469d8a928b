"""The diagrams show what the runs did."""

from __future__ import annotations

import pytest

from railgate.waves import Waveform
from sheets.timing import DIAGRAMS, timing
from sheets.timing.lanes import Diagram


def lane(diagram: Diagram, name: str) -> Waveform:
    (found,) = (each.wave for each in diagram.lanes if each.name == name)
    return found


def marked(diagram: Diagram, text: str) -> float:
    (found,) = (at for at, told in diagram.marks if told == text)
    return found


@pytest.mark.parametrize("name", DIAGRAMS)
def test_something_happens_in_every_lane_of_a_diagram(name) -> None:
    diagram = DIAGRAMS[name]()
    constant = [
        each.name
        for each in diagram.lanes
        if not any(diagram.start < tick < diagram.end for tick in each.wave.ticks.tolist())
    ]
    assert constant in ([], ["pulses", "phase"], ["pulses"])  # at a constant speed they are
    assert all(diagram.start <= at <= diagram.end for at, _ in diagram.marks)
    assert diagram.title in timing(name).replace("&#x27;", "'")


def test_the_fields_change_where_the_snapshot_s_diagram_says() -> None:
    diagram = DIAGRAMS["odometer-snapshot"]()
    mark = marked(diagram, "the fields change")
    assert mark - lane(diagram, "strobe").rising()[2] == 16
    for name in ("number", "time", "position"):
        assert mark in lane(diagram, name).ticks


def test_the_delivery_is_where_the_link_s_diagram_says() -> None:
    diagram = DIAGRAMS["link-cycle"]()
    mark = marked(diagram, "delivery, at the same phase of every cycle")
    assert mark in lane(diagram, "delivery").rising()
    assert mark in lane(diagram, "word").ticks


def test_the_contact_opens_between_the_last_live_1_and_the_declared_time() -> None:
    diagram = DIAGRAMS["vital-cpu-dead"]()
    live, opened, declared = (marked(diagram, text) for text in ("last live 1", "open", "declared"))
    assert live < opened < declared
    assert opened in lane(diagram, "relay's contact").falling()
    assert not any(live < at < declared for at in lane(diagram, "CPU 1 frame").rising())
