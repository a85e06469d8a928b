"""`railgate attach` and `railgate registers`: what they print, and how they fail."""

import json
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from attach.journey import FILE
from interrupts import heeds_interrupts
from railgate.unit.config import UNITS
from railgate.unit.registers import registers
from registers.host.desk import BAUD, answering, flipped, on_desk

FUNCTIONS = ("odometer", "position_link")


@pytest.fixture(scope="module")
def port() -> str:
    """A board on a desk: an odometer at 200 km/h, and a link that is answered."""
    with on_desk() as line:
        yield line.port


@pytest.fixture
def short(tmp_path) -> str:
    path = tmp_path / "short.toml"
    path.write_text(FILE)
    return f"sim:{path}"


def test_a_board_is_shown_once(railgate, port) -> None:
    code, out, err = railgate("attach", port, "--baud", str(BAUD), "--once")
    assert (code, err) == (0, "")
    for told in (*FUNCTIONS, "at 0x0", "at 0x200", "forward", "km/h in", "fresh", "200.16"):
        assert told in out


def test_a_board_is_told_as_one_object(railgate, port) -> None:
    code, out, err = railgate("attach", port, "--baud", str(BAUD), "--once", "--json")
    assert (code, err) == (0, "")
    odometer, link = json.loads(out)["functions"]
    assert (odometer["function"], link["function"]) == FUNCTIONS
    train = odometer["train"]
    assert train["speed_low_kmh"] < 200 < train["speed_high_kmh"]
    assert train["distance_m"] > 0
    assert [axle["direction"] for axle in odometer["axles"]] == ["forward"] * 2
    assert (link["status"], link["health"], link["causes"]) == ("fresh", "ok", [])


@pytest.mark.shows("SYS-5")
def test_another_configuration_is_refused_in_one_line(railgate, port) -> None:
    code, out, err = railgate("attach", port, "--baud", str(BAUD), "--unit", "maglev", "--once")
    metro, maglev = (UNITS[unit]().odometer.digest for unit in ("metro", "maglev"))
    assert (code, out) == (2, "")
    assert err == (f"railgate: digest of the odometer at 0x0 must be {maglev:#x}, not {metro:#x}\n")


def test_a_simulation_is_shown_once(railgate, short) -> None:
    code, out, err = railgate("attach", short, "--skip", "17s", "--once")
    assert (code, err) == (0, "")
    for told in (*FUNCTIONS, "vital_output", "0 idle, 1 idle", "forward", "adhering", "fresh"):
        assert told in out
    code, out, _ = railgate("attach", short, "--skip", "5s", "--once")
    assert code == 0
    for told in ("stands", "0 idle, 1 drive", "life 3"):
        assert told in out


def test_a_simulation_goes_on_in_real_time_to_its_end(railgate, short) -> None:
    begin = time.monotonic()
    code, out, err = railgate("attach", short, "--skip", "24s", "--every", "800ms", "--json")
    assert (code, err) == (0, "")
    readings = [json.loads(line)["functions"] for line in out.splitlines()]
    assert len(readings) > 3
    assert time.monotonic() - begin > 0.8 * len(readings)
    numbers = [functions[0]["number"] for functions in readings]
    assert numbers == list(range(2, 2 + len(readings)))
    times = [functions[0]["time_s"] for functions in readings]
    assert np.diff(times) == pytest.approx(0.8, abs=0.01)
    assert readings[-1][0]["train"]["standstill"]


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--skip", "100s"), "--skip must leave something of "),
        (("--every", "0s"), "every so many seconds, above 0, not 0"),
        (("--every", "100s"), "must go on for 100s, for a reading"),
    ],
)
def test_a_simulation_that_is_too_short_is_told(railgate, short, arguments, says) -> None:
    code, out, err = railgate("attach", short, *arguments)
    assert (code, out) == (2, "")
    assert says in err


def test_ctrl_c_ends_it_cleanly(port) -> None:
    command = [sys.executable, "-c", "from railgate.cli import main; main()"]
    arguments = ["attach", port, "--baud", str(BAUD), "--json"]
    with subprocess.Popen(
        [*command, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=heeds_interrupts,
    ) as process:
        assert json.loads(process.stdout.readline())["functions"]
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (0, "")


@pytest.mark.parametrize(
    ("answer", "says"),
    [(lambda _: b"", "no answer after"), (flipped, "the CRC is wrong after")],
    ids=["silent", "spoilt"],
)
def test_a_board_that_cannot_be_understood_is_one_line(railgate, answer, says) -> None:
    with answering(answer) as line:
        code, out, err = railgate("attach", line.port, "--once")
    assert (code, out) == (2, "")
    assert err.startswith(f"railgate: {line.port}: ")
    assert says in err
    assert err.count("\n") == 1


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("attach", "/dev/none"), "/dev/none cannot be opened at 115200 baud: No such file"),
        (
            ("attach", "/dev/none", "--unit", "tram"),
            'unit must be one of metro, maglev, not "tram"',
        ),
        (("attach", "sim:none.toml"), "none.toml"),
        (("attach", "/dev/none", "--baud", "0"), "--baud"),
        (("attach", "/dev/none", "--every", "soon"), "soon"),
        (("registers", "--unit", "tram"), 'unit must be one of metro, maglev, not "tram"'),
        (("registers", "--fpga", "3"), "fpga must be 1 or 2, not 3"),
    ],
)
def test_a_bad_call_is_one_clear_line_and_exit_code_2(railgate, arguments, says) -> None:
    code, out, err = railgate(*arguments)
    assert (code, out) == (2, "")
    assert says in err
    assert err.startswith("railgate: ")
    assert err.count("\n") == 1


@pytest.mark.shows("SYS-1")
def test_the_map_is_printed_field_by_field(railgate) -> None:
    code, out, _ = railgate("registers", "--json")
    assert code == 0
    rows = json.loads(out)
    map_ = registers(UNITS["metro"](), 1)
    blocks = map_.blocks.values()
    fields = [
        (block.name, name) for block in blocks for r in block.registers for name in r.field_names
    ]
    assert [(row["block"], row["field"]) for row in rows] == fields
    for row in rows:
        assert row["address"] == map_.address(row["block"], row["register"])
        if row["again"] is not None:
            assert row["again"] == map_.address(row["block"], row["register"], again=True)
    code, out, _ = railgate("registers", "--fpga", "2")
    assert code == 0
    assert "sensor_1_since_edge" in out
    assert "position_link" not in out
