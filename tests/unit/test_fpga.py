"""Both FPGAs as one component each, read over their bus as a CPU does."""

from __future__ import annotations

from dataclasses import asdict
from fractions import Fraction
from functools import cache

import numpy as np
import pytest

from railgate.engines import Clock, Design, open_engine
from railgate.odometer.design import design as odometer_design
from railgate.odometer.device import OdometerDevice
from railgate.odometer.host import snapshots
from railgate.odometer.plant import Sensor, constant
from railgate.position_link.device import LinkDevice
from railgate.position_link.plant import Scenario as LinkScenario
from railgate.position_link.spec import Status
from railgate.registers import Map
from railgate.registers.host import AccessError, Running, SimulatedBus
from railgate.unit.config import AXLES, Unit
from railgate.unit.gateware import LINK_DOMAIN, Fpga
from railgate.unit.registers import registers
from railgate.vital_output.device import ChannelDevice
from railgate.vital_output.spec import TestPhase
from railgate.waves import Trace, Waveform

pytestmark = [pytest.mark.shows("SYS-1", "SYS-5", "ODO-7", "ODO-8")]

UNIT = Unit()
FEMTOSECOND = Fraction(1, 10**15)
LASTS_S = Fraction(4, 1000)
PLACE_M, SPEED_KMH = 1234.5, 200.0


def base(map_: Map, name: str) -> int:
    return next(at for at, block in map_.blocks.items() if block.name == name)


@cache
def wheels() -> Trace:
    """Both sensors' pins at 200 km/h, in ticks of the odometer."""
    profile = constant(SPEED_KMH, float(LASTS_S))
    signals = {
        f"sensor.{axle}.{name}": wave
        for axle in range(AXLES)
        for name, wave in Sensor(offset=0.3 * axle).drive(profile, UNIT.odometer).signals.items()
    }
    return Trace(signals, Fraction(1, UNIT.odometer.clock_hz), 0, int(LASTS_S * 16_000_000))


def pins(fpga: int) -> Trace:
    found = wheels().resample(FEMTOSECOND)
    if fpga == 1:
        words = UNIT.layout.words(
            {"position": [PLACE_M], "speed": [SPEED_KMH], "sequence": np.array([7])}
        )
        line = LinkScenario(words=words).plan(UNIT.link, 1).drive()
        line = line.slice(0, int(LASTS_S * UNIT.link.clock_hz)).resample(FEMTOSECOND)
        found = found.merge(line.rename({name: f"link.{name}" for name in line.signals}))
    boot = Trace({"channel.boot": Waveform.of([0], [5], 16)}, FEMTOSECOND, 0, found.end)
    return found.merge(boot)


def running(fpga: int) -> Running:
    clocks = [Clock(frequency_hz=Fraction(UNIT.odometer.clock_hz))]
    if fpga == 1:
        clocks.append(Clock(frequency_hz=Fraction(UNIT.link.clock_hz), domain=LINK_DOMAIN))
    else:
        clocks = [Clock(frequency_hz=clocks[0].frequency_hz, phase=Fraction(1, 3))]
    design = Design(name=f"fpga-{fpga}", component=lambda: Fpga(UNIT, fpga), clocks=tuple(clocks))
    return Running(design, "cxxrtl", pins(fpga))


@pytest.mark.parametrize("fpga", [1, 2])
def test_a_cpu_reads_all_of_an_fpga_over_its_bus(fpga: int) -> None:
    map_, runs = registers(UNIT, fpga), running(fpga)
    bus = SimulatedBus(runs, map_.size)
    runs.run({}, 40_000)
    odometer = OdometerDevice(bus, UNIT.odometer, base(map_, "odometer"))
    channel = ChannelDevice(bus, UNIT.vital, base(map_, "vital_output"))
    for device in (odometer, channel):
        device.registers.require_same()

    shots = odometer.snapshots()
    (strobed,) = {shot.time for shot in shots}
    assert odometer.snapshots(again=True) == shots
    strobe = Waveform.of([0, strobed, strobed + 1], [0, 1, 0])
    given = wheels().merge(Trace({"strobe": strobe}, wheels().period, 0, wheels().end))
    model = open_engine(odometer_design(UNIT.odometer), "leap").advance(given.end, given)
    for axle, shot in enumerate(shots):
        (expected,) = snapshots(model, UNIT.odometer, axle)
        if fpga == 1:  # both clocks begin with tick 0; FPGA 2's is a third of a tick later
            assert asdict(shot) == asdict(expected)
        assert abs(shot.pulses - expected.pulses) <= 1
        assert shot.pulses > 5

    status = channel.status()
    assert status.test_phase in (TestPhase.WANTED, TestPhase.RUNNING)
    assert not status.linked
    assert channel.seen() == ()
    if fpga == 2:
        with pytest.raises(AccessError):
            bus.read(map_.size - 4)
        return
    link = LinkDevice(bus, UNIT.link, base(map_, "position_link"), UNIT.layout)
    link.registers.require_same()
    delivery = link.delivery()
    assert delivery is not None
    assert delivery.status == Status.FRESH
    assert delivery.values == pytest.approx(
        {"position": PLACE_M, "speed": 200, "sequence": 7}, abs=0.2
    )
    assert link.seen() == ()


def test_there_is_no_third_fpga() -> None:
    with pytest.raises(ValueError, match="fpga must be 1 or 2, not 3"):
        registers(UNIT, 3)
