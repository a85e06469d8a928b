"""The parts of pages that are made from the code."""

from __future__ import annotations

import json
import re
import tomllib
from dataclasses import fields

import numpy as np
import pytest
from amaranth.hdl import Value

from docs.examples import ROOT
from railgate.fpga.targets import TARGETS
from railgate.odometer.spec import Config
from railgate.waves import Waveform
from sheets.configuration import configuration
from sheets.functions import FUNCTIONS
from sheets.layers import layers
from sheets.markdown import code, number, small, table
from sheets.ports import ports
from sheets.resources import COLUMNS, resources
from sheets.timing.lanes import Diagram, Lane, draw
from sheets.told import told


def rows(markdown: str) -> list[list[str]]:
    """The cells of a table, without its header."""
    lines = [line for line in markdown.splitlines() if line.startswith("|")]
    return [[c.strip().strip("`") for c in line.strip("|").split(" | ")] for line in lines[2:]]


@pytest.mark.parametrize("name", FUNCTIONS)
def test_every_port_has_its_direction_width_and_meaning(name) -> None:
    of = FUNCTIONS[name]
    component = of.top(of.config)
    found = {path: (flow, int(bits)) for path, flow, bits, _ in rows(ports(name))}
    flat = {}
    for path, member, value in component.signature.flatten(component):
        told_path = ".".join(str(part) for part in path).replace(".0.", "[n].")
        if ".1." not in ".".join(map(str, path)):
            flat[told_path] = (member.flow.name.lower(), len(Value.cast(value)))
    assert found == flat
    assert all(meaning for *_, meaning in rows(ports(name)))


def test_limits_are_those_that_the_configuration_holds_itself_to() -> None:
    told = {name: limits for name, _, limits, _ in rows(configuration("odometer"))}
    assert told["sensors"] == "1\N{NO-BREAK SPACE}…\N{NO-BREAK SPACE}16"
    Config(sensors=16)
    with pytest.raises(ValueError, match="between 1 and 16"):
        Config(sensors=17)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_every_number_of_a_configuration_has_its_default(name) -> None:
    assert [row[0] for row in rows(configuration(name))] == [
        f.name for f in fields(FUNCTIONS[name].config)
    ]
    assert all(row[1] for row in rows(configuration(name)))


def test_a_docstring_s_form_is_read() -> None:
    text = "one, other: in, both. `third` and fourth: 3 of them. none: a word that is no name"
    assert list(told(text, ("one", "other", "third", "fourth"))) == [
        ("one", "in, both."),
        ("other", "in, both."),
        ("third", "3 of them. none: a word that is no name"),
        ("fourth", "3 of them. none: a word that is no name"),
    ]


def test_the_layers_are_those_of_the_contract() -> None:
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    for each in contracts["tool"]["importlinter"]["contracts"]:
        if each["type"] == "layers":
            boxes = re.findall(r"<span>([^<]+)</span>", layers(each["name"]))
            modules = [m for row in each["layers"] for m in re.findall(r"railgate\.[\w.]+", row)]
            assert [f"railgate.{box}" for box in boxes] == modules


def test_resources_are_told_as_measured_and_whether_of_this_gateware(monkeypatch, tmp_path) -> None:
    record = tmp_path / "fpga.json"
    monkeypatch.setattr("sheets.resources.RECORD", record)
    told = dict.fromkeys(COLUMNS, 7) | {"target": "odometer", "part": "ECP5", "lut": 1234}
    for digest, changed in ((TARGETS["odometer"].sources().digest, False), ("0", True)):
        bare = told | {"lut_ratio": None, "digest": digest}
        record.write_text(json.dumps([told | {"digest": digest}, bare]), "utf-8")
        page = resources("odometer")
        assert rows(page)[1][-2:] == ["", "7"]
        assert rows(page)[0] == [
            *("ECP5", "7", "7", "7", "1\N{NARROW NO-BREAK SPACE}234", *["7"] * 5)
        ]
        assert ("has changed since" in page) == changed
    assert resources("vital_output") == "Not measured yet.\n"


def test_markdown_is_not_broken_by_what_it_holds() -> None:
    assert table(("a",), [("x | y\nz",)]) == "| a |\n| --- |\n| x \\| y z |\n"
    assert code("```").count("`````") == 2
    assert (number(1234567), number(0.125), number("x")) == (
        "1 234 567".replace(" ", "\u202f"),
        "0.125",
        "x",
    )
    assert (small(0.000034), small(1.26)) == ("3.4·10⁻⁵", "1.3")


def test_a_lane_shows_each_edge_and_each_value() -> None:
    level = Waveform.of([0, 3, 5], [0, 1, 0])
    bus = Waveform.of([0, 5], [1, 2], 8)
    names = {1: "one", 2: "two & more"}
    lanes = (Lane("level", level), Lane("bus", bus, lambda value: names[value]))
    svg = draw(Diagram(title="A < B", lanes=lanes, tick_s=1.0, start=0, end=10, unit="s"), "x")
    for word in ("level", "bus", "one", "two &amp; more", 'aria-label="A &lt; B"', "currentColor"):
        assert word in svg
    assert not re.search(r"#0([1-4])0\1", svg), "no stand-in is left"
    assert svg.count("var(--timing-bus)") == 2


def test_a_diagram_begins_with_what_was_held_before() -> None:
    wave = Waveform.of(np.array([0, 4]), np.array([7, 9]), 8)
    svg = draw(Diagram(title="", lanes=(Lane("w", wave, str),), tick_s=1.0, start=6, end=9), "x")
    assert ">9<" in svg
    assert ">7<" not in svg
