"""The very top that is built for a board, compiled, answers `railgate attach`."""

import time
from fractions import Fraction
from functools import cache
from itertools import islice

import numpy as np
import pytest

from railgate.attach import Live, readings
from railgate.engines import Clock, Design
from railgate.fpga.cpu_line import command_frame, time_frame
from railgate.fpga.gateware.top import PINS, TARGETS, Top
from railgate.odometer.plant import Sensor, course
from railgate.position_link.plant import Scenario
from railgate.registers.gateware.uart import BAUD
from railgate.registers.host import Running, UartBus
from railgate.unit.config import Unit
from railgate.vital_output.host import encode
from railgate.waves import Trace, Waveform
from registers.host.desk import Wire, on_line, sent

UNIT = Unit()
SECONDS = 20
"""Of the pins."""
FEMTOSECOND = Fraction(1, 10**15)
BOOT = 77
WAIT_S = 20.0
"""For an answer: the top in the engine is slower than one on a board."""
LOOKS_EVERY_S = 1.0
LOOKS = 60
"""At most, until a channel is through its start-up test: how fast the engine is varies."""


@cache
def wheels() -> Trace:
    """Both axles at 200 km/h."""
    turned = Sensor().drive(course("constant", 200, SECONDS), UNIT.odometer)
    axles = [turned.rename({name: f"sensor_{n}.{name}" for name in "ab"}) for n in (1, 2)]
    return axles[0].merge(axles[1])


@cache
def line() -> Trace:
    """A position system that tells 200 km/h."""
    cycles = 50 * SECONDS
    words = UNIT.layout.words(
        {
            "position": np.zeros(cycles),
            "speed": np.full(cycles, 200.0),
            "sequence": np.zeros(cycles),
        }
    )
    line = Scenario(words=words).plan(UNIT.link, cycles).drive()
    return line.rename({name: f"link.{name}" for name in ("uef", "data")})


@cache
def commands(bit_ticks: int, board: int) -> Trace:
    """What the CPU of FPGA `board` + 1 sends: in each system cycle the time, then a command."""
    config = UNIT.vital
    ticks, levels = [0], [1]
    for index in range(20 * SECONDS):
        start = index * config.cycle_ticks + config.cycle_ticks // 2
        frame = time_frame(index, 0, BOOT)
        phase = config.cycle_ticks // 2 + len(sent(frame, bit_ticks))
        data = time_frame(index, phase, BOOT)
        data += command_frame(encode(config, board, index, index + 1, 1))
        bits = np.array([*sent(data, bit_ticks), 1])
        changes = np.flatnonzero(np.diff(bits, prepend=1))
        ticks += [start + int(at) for at in changes]
        levels += bits[changes].tolist()
    end = SECONDS * config.clock_hz
    return Trace({"channel.cpu_rx": Waveform.of(ticks, levels, 1)}, Fraction(1, 16_000_000), 0, end)


def design(target: str) -> Design:
    clocks = tuple(
        Clock(frequency_hz=Fraction(hz), domain=domain)
        for domain, hz in Top(UNIT, target).clocks.items()
    )
    return Design(name=f"top-{target}", component=lambda: Top(UNIT, target), clocks=clocks)


def pins(target: str, made: Design) -> Trace:
    """All that it has."""
    top = Top(UNIT, target)
    there = {
        "sensor_1": wheels,
        "link": line,
        "channel": lambda: commands(top.bit_ticks, int(target == "fpga_2")),
    }
    traces = [make() for name, make in there.items() if name in top.signature.members]
    if not made.single:
        traces = [trace.resample(FEMTOSECOND) for trace in traces]
    end = min(trace.end for trace in traces)
    first, *others = (trace.slice(0, end) for trace in traces)
    for other in others:
        first = first.merge(other)
    return first


@pytest.mark.shows("SYS-1", "SYS-3", "SYS-5")
@pytest.mark.parametrize(
    "target",
    [pytest.param(t, marks=[pytest.mark.slow] if t != "position_link" else []) for t in TARGETS],
)
def test_a_top_answers_attach(target) -> None:
    made, top = design(target), Top(UNIT, target)
    step = 1 if made.single else int(Fraction(1, top.clocks["sync"]) / FEMTOSECOND)
    wire = Wire("uart.rx", "uart.tx", top.bit_ticks, step)
    with (
        on_line(Running(made, "cxxrtl", pins(target, made)), wire) as serial,
        UartBus(serial.port, BAUD, WAIT_S) as bus,
    ):
        live = Live(bus, UNIT, lambda _: time.sleep(LOOKS_EVERY_S) is None)
        for reading in islice(readings(live, Fraction(1)), LOOKS):
            told = {each["function"]: each for each in reading}
            if told.get("vital_output", {"accepted": 1})["accepted"]:
                break
    assert {name: each["address"] for name, each in told.items()} == {
        block.name: base for base, block in top.map.blocks.items()
    }
    if "odometer" in told:
        train = told["odometer"]["train"]
        assert train["speed_low_kmh"] < 200 < train["speed_high_kmh"]
        assert [axle["direction"] for axle in told["odometer"]["axles"]] == ["forward"] * 2
    if "position_link" in told:
        link = told["position_link"]
        assert (link["status"], link["causes"]) == ("fresh", [])
        assert link["values"]["speed"] == pytest.approx(200, abs=0.2)
    if "vital_output" in told:
        channel = told["vital_output"]
        assert (channel["trusted"], channel["linked"]) == (True, False)
        assert (channel["accepted"] > 0, channel["start"]) == (True, 1)
        # The command that begins a sequence only begins it; the others meet no other channel.
        assert channel["causes"]["time"] == channel["start"]
        assert channel["causes"].keys() <= {"time", "skew"}


@pytest.mark.parametrize("target", TARGETS)
def test_the_pins_of_a_top_are_those_that_a_file_can_name(target) -> None:
    top = Top(UNIT, target)
    assert set(top.signature.members) <= set(PINS)
    for name, member in top.signature.members.items():
        assert set(member.signature.members) == set(PINS[name])
    assert (top.configurations.keys()) == {block.name for block in top.map.blocks.values()}


def test_a_target_that_is_not_there_is_told() -> None:
    with pytest.raises(ValueError, match=r'one of odometer, .*, fpga_2, not "fpga_3"'):
        Top(UNIT, "fpga_3")
