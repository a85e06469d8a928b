"""A simulated FPGA 1 as a bus: its functions at their addresses, all of one scenario."""

from fractions import Fraction

import pytest

from attach.journey import FILE, OPEN_S, RUNS_S, SHORT
from railgate.attach.board import find
from railgate.attach.simulation import SimulatedFpga
from railgate.registers.host import AccessError
from railgate.unit.registers import registers
from railgate.unit.run import run
from railgate.unit.scenario_file import parse_scenario
from railgate.vital_output.device import ChannelDevice
from railgate.vital_output.host import Status

MAP = registers(SHORT.config, 1)


@pytest.fixture(scope="module")
def fpga() -> SimulatedFpga:
    return SimulatedFpga(SHORT)


@pytest.mark.shows("SYS-1")
def test_what_is_read_is_what_the_scenario_has(fpga) -> None:
    """In their order: the doors at the platform, then the train on its way, then the end."""
    config = SHORT.config
    whole = run(SHORT)
    gauges = find(fpga, config)
    for gauge in gauges:
        gauge.read()
    assert fpga.run(Fraction(OPEN_S))
    odometer, channel, link = (gauge.read() for gauge in gauges)
    assert odometer["train"]["standstill"]
    assert (odometer["train"]["distance_m"], odometer["axles"][0]["pulses"]) == (0, 0)
    assert (channel["image"], channel["states"]) == (2, ["idle", "drive"])
    assert (link["status"], link["values"]["position"]) == ("fresh", 0)

    assert fpga.run(Fraction(RUNS_S - OPEN_S))
    for gauge in gauges:
        gauge.read()
    assert fpga.run(Fraction(1, 5))
    odometer, channel, link = (gauge.read() for gauge in gauges)
    time_s = odometer["time_s"]
    speed = float(whole.profile.speed_kmh(time_s))
    assert odometer["train"]["speed_low_kmh"] < speed < odometer["train"]["speed_high_kmh"]
    for axle in odometer["axles"]:
        assert (axle["direction"], axle["verdict"], axle["flags"]) == ("forward", "adhering", [])
        assert axle["position_m"] == pytest.approx(
            float(whole.profile.position_m(time_s)), rel=0.01
        )
    assert link["values"]["position"] == pytest.approx(axle["position_m"], abs=1)
    device = ChannelDevice(fpga, config.vital, MAP.address("vital_output", "identity"))
    status = device.status()
    trace = whole.vital.trace
    assert status == Status.at(config.vital, trace, int(time_s * 10**15), "fpga_1.")
    assert status.states[1] == 0
    assert not fpga.run(Fraction(60))


def test_what_is_in_no_block_is_refused(fpga) -> None:
    with pytest.raises(AccessError, match="there is no block, at address 0x"):
        fpga.read(MAP.size)
    with pytest.raises(AccessError, match="identity cannot be written, at address 0x0"):
        fpga.write(0, [1])


def test_the_file_is_the_scenario() -> None:
    assert parse_scenario(FILE, "short.toml") == SHORT
