"""Buses over simulations: the same drivers read the same of gateware with its bank, and of a model
whose bank is a model too."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from railgate.engines import Clock, Design, open_engine
from railgate.odometer.device import OdometerDevice
from railgate.position_link.design import design as link_design
from railgate.position_link.device import LinkDevice
from railgate.position_link.host import deliveries
from railgate.position_link.registers import registers as link_registers
from railgate.registers.host import AccessError, MemoryBus, ModelledBus, Running, SimulatedBus
from railgate.vital_output.device import ChannelDevice
from registers.host.designs import ALONE, CHANNEL, LINK, ODOMETER, PINS, line, mapped
from registers.maps import every_kind


def gateware(function: str, engine: str = "pysim") -> tuple[Running, SimulatedBus]:
    design, block = mapped(function)
    running = Running(design, engine, PINS[function]() if function in PINS else None)
    return running, SimulatedBus(running, block.size)


def model(function: str, engine: str = "leap") -> tuple[Running, ModelledBus]:
    design, block = ALONE[function]
    running = Running(design, engine, PINS[function]() if function in PINS else None)
    return running, ModelledBus(block, running)


@pytest.mark.shows("SYS-1", "ODO-6", "ODO-7")
@pytest.mark.parametrize("engine", ["leap", "pysim"])
def test_an_odometers_snapshots_are_the_same_through_the_bank_and_its_model(engine) -> None:
    real, bus = gateware("odometer")
    modelled, twin = model("odometer", engine)
    device, other = (OdometerDevice(each, ODOMETER) for each in (bus, twin))
    for each in (device, other):
        each.registers.require_same()
    for gap in (1, 700, 3000):
        real.run({}, gap, [])
        shots = device.snapshots()
        twin.run(shots[0].time - modelled.now)
        assert other.snapshots() == shots
        assert device.snapshots(again=True) == other.snapshots(again=True) == shots
    assert shots[0].number == 3
    assert shots[0].pulses > 10
    device.strobe()
    again = device.snapshots(again=True)
    assert again[0].number == 4
    twin.run(again[0].time - modelled.now)
    other.strobe()
    assert other.snapshots(again=True) == again


@pytest.mark.shows("SYS-1")
def test_a_driver_reads_the_same_of_memory(tmp_path) -> None:
    """Of a file that holds what a board's addresses held."""
    real, bus = gateware("odometer")
    real.run({}, 3000, [])
    shots = OdometerDevice(bus, ODOMETER).snapshots()
    block = ALONE["odometer"][1]
    words = np.zeros(block.size // 4, np.uint32)
    words[:2] = bus.read(0, 2)
    snapshot = block.place("snapshot")
    held = bus.read(snapshot.again, snapshot.group.words)
    for offset in (snapshot.offset, snapshot.again):
        words[offset // 4 :][: len(held)] = held
    file = tmp_path / "memory"
    file.write_bytes(words.tobytes())
    with MemoryBus(file, block.size) as memory:
        device = OdometerDevice(memory, ODOMETER)
        device.registers.require_same()
        assert device.snapshots() == device.snapshots(again=True) == shots


@pytest.mark.shows("SYS-1", "LNK-7")
def test_a_links_deliveries_and_causes_are_the_same_through_the_bank_and_its_model() -> None:
    real, bus = gateware("position_link")
    modelled, twin = model("position_link")
    device, other = (LinkDevice(each, LINK) for each in (bus, twin))
    assert device.delivery() is other.delivery() is None
    pins = line()
    there = deliveries(open_engine(ALONE["position_link"][0], "leap").advance(pins.end, pins), LINK)
    causes = []
    for cycle in range(1, 10):
        for running, run in ((real, lambda n: real.run({}, n, [])), (modelled, twin.run)):
            run((cycle - 1) * LINK.cycle_ticks + LINK.delivery_ticks + 10 - running.now)
        told = device.delivery()
        assert told == there[cycle - 1]
        assert other.delivery() == device.delivery(again=True) == told
        seen = device.seen(clear=cycle % 2 == 0)
        assert other.seen(clear=cycle % 2 == 0) == seen
        causes.append(seen)
    assert causes[1:7] == [(), ("check",), ("check",), (), ("timeout",), ()]


@pytest.mark.shows("SYS-1", "LNK-6")
@pytest.mark.parametrize("make", [gateware, model])
def test_what_is_read_without_a_gate_is_of_the_last_one(make) -> None:
    running, bus = make("position_link")
    device = LinkDevice(bus, LINK)
    fields = device.registers.read("delivery", again=True)
    assert set(fields.values()) == {0}, "nothing before the first gate"
    run = bus.run if make is model else lambda steps: running.run({}, steps, [])
    run(LINK.delivery_ticks + 10)
    first = device.registers.read("delivery")
    assert first["number"] == 1
    run(LINK.cycle_ticks)
    assert device.registers.read("delivery", again=True) == first
    assert device.registers.read("word") == {"word": first["word"]}
    assert device.registers.read("delivery")["number"] == 2
    assert device.registers.read("number", again=True) == {"number": 2}


@pytest.mark.shows("LNK-7")
@pytest.mark.parametrize("make", [gateware, model])
def test_only_the_causes_that_are_written_are_cleared(make) -> None:
    running, bus = make("position_link")
    device = LinkDevice(bus, LINK)
    run = bus.run if make is model else lambda steps: running.run({}, steps, [])
    run(5 * LINK.cycle_ticks + LINK.delivery_ticks + 10)
    assert device.seen() == ("timeout", "check")
    device.registers.write("seen", timeout_seen=1, early_seen=1)
    assert device.seen(clear=True) == ("check",)
    assert device.seen() == ()


def test_a_cause_is_seen_in_whatever_tick_it_comes() -> None:
    """Also where its counter steps right as a run begins, or comes round within one."""
    running, bus = model("position_link")
    device = LinkDevice(bus, LINK)
    bus.run(2 * LINK.cycle_ticks + 1 + LINK.delivery_ticks - running.now)
    assert device.seen() == ()
    bus.run(1)
    assert device.seen() == ("check",)
    small = replace(LINK, count_bits=8)
    running = Running(link_design(small), "leap")  # a line on which nothing ever comes
    device = LinkDevice(bus := ModelledBus(link_registers(small), running), small)
    assert device.seen() == ()
    bus.run(256 * LINK.cycle_ticks)
    assert device.registers.read("delivery")["timeout_cycles"] == 0
    assert device.seen() == ("timeout",)


@pytest.mark.shows("SYS-1")
def test_a_channels_status_and_test_are_the_same_through_the_bank_and_its_model() -> None:
    real, bus = gateware("vital_output")
    modelled, twin = model("vital_output")
    device, other = (ChannelDevice(each, CHANNEL) for each in (bus, twin))
    first = device.status()
    assert other.status() == first
    for each in (device, other):
        each.registers.require_same()
        each.test()
    for gap in (10, 900):
        real.run({}, gap, [])
        twin.run(real.now - modelled.now)
        assert other.status() == device.status()
        assert other.seen() == device.seen()


@pytest.mark.parametrize("make", [gateware, model])
def test_what_is_not_there_is_refused_with_its_address(make) -> None:
    _, bus = make("position_link")
    end = ALONE["position_link"][1].words * 4
    for access, address in (
        (lambda: bus.read(end), end),
        (lambda: bus.read(end - 4, 2), end),
        (lambda: bus.read(1 << 20), 1 << 20),
        (lambda: bus.write(0, [1]), 0),
        (lambda: bus.write(8, [1, 0]), 12),
    ):
        with pytest.raises(AccessError) as refused:
            access()
        assert refused.value.address == address


def test_the_end_of_the_pins_is_told() -> None:
    running, bus = model("odometer")
    left = running.steps(Fraction(running.left_s))
    bus.run(left + 100)
    assert running.left_s == 0
    with pytest.raises(ValueError, match="the simulation of odometer is at its end"):
        bus.read(0xC)


def test_a_step_is_from_edge_to_edge_of_its_own_clock() -> None:
    """With two clocks, of which one has a phase, time is in femtoseconds."""
    alone, block = mapped("position_link")
    clocks = (
        Clock(frequency_hz=Fraction(3_000_000), phase=Fraction(1, 3), ppm=Fraction(40)),
        Clock(frequency_hz=Fraction(7_000_000), domain="other"),
    )
    running = Running(Design(name="two-clocks", component=alone.component, clocks=clocks), "pysim")
    device = LinkDevice(SimulatedBus(running, block.size), LINK)
    device.registers.require_same()
    one, other = mapped("position_link")
    plain = Running(one, "pysim")
    assert LinkDevice(SimulatedBus(plain, other.size), LINK).delivery() == device.delivery()
    period = 1 / (3_000_000 * (1 + Fraction(40, 1_000_000)))
    assert running.steps(Fraction(1, 1000)) == 3001
    assert running.now * Fraction(1, 10**15) >= plain.now * period


def test_only_what_functions_declare_can_be_modelled() -> None:
    (block,) = every_kind().blocks.values()
    with pytest.raises(ValueError, match="events must be as functions have it, to be modelled"):
        ModelledBus(block, model("odometer")[0])
