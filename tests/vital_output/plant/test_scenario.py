"""A whole scenario: its clocks, and the inputs of a closed loop that it makes."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from railgate.engines import Clock
from railgate.vital_output.plant.cpu import Command
from railgate.vital_output.plant.edges import FEMTOSECOND
from railgate.vital_output.plant.relay import RelayTimes
from railgate.vital_output.plant.scenario import Scenario
from railgate.vital_output.spec import Config
from railgate.waves import Waveform
from vital_output.plant.received import SECONDS, edges, scenario
from vital_output.small import SMALL

WIDTHS = {
    "command.payload": 10, "command.valid": 1, "time.index": 32, "time.phase": 14, "time.valid": 1,
    "boot": 16, "test": 1, "stopped": 1,
}  # fmt: skip


def test_the_inputs_are_all_of_a_loops_from_the_start_to_the_end() -> None:
    found = scenario().controls(SMALL)
    assert (found.start, found.end, found.period) == (0, SECONDS / FEMTOSECOND, FEMTOSECOND)
    widths = {f"fpga_{c}.{name}": width for c in (1, 2) for name, width in WIDTHS.items()}
    widths |= {f"fpga_{c}_rst": 1 for c in (1, 2)}
    widths |= {f"line_{c}.{what}": 1 for c in (1, 2) for what in ("flip", "low", "high")}
    relay = ("welded", "broken", "contact_open", "contact_stuck")
    both = [f"{name}_{c}" for name in ("rogue", "open", "stuck") for c in (1, 2)]
    widths |= {f"relay.{name}": 2 for name in (*relay, *both)}
    assert {name: wave.width for name, wave in found.signals.items()} == widths


def test_without_faults_only_frames_time_and_boot_number_are_not_0() -> None:
    found = scenario().controls(SMALL)
    quiet = {
        name for name, wave in found.signals.items() if wave == Waveform.of([0], [0], wave.width)
    }
    busy = ("command.payload", "command.valid", "time.index", "time.phase", "time.valid", "boot")
    assert found.signals.keys() - quiet == {f"fpga_{c}.{name}" for c in (1, 2) for name in busy}


def test_a_tests_demand_is_one_tick_of_both() -> None:
    told = scenario(tests_s=(Fraction(1, 100), Fraction(5, 100)), ppm_2=Fraction(90))
    found = told.controls(SMALL)
    for fpga in (1, 2):
        clock, wave = edges(told, fpga), found[f"fpga_{fpga}.test"]
        first, behind, second, end = clock.during(wave.ticks[1:]).tolist()
        assert (behind - first, end - second) == (1, 1)
        assert clock.begin(first) >= 10**13 > clock.begin(first - 1)
        assert clock.begin(second) >= 5 * 10**13 > clock.begin(second - 1)


def test_the_clocks_are_those_of_configuration_and_relay() -> None:
    told = Scenario(
        ppm_1=Fraction(3), ppm_2=Fraction(-4), phase_1=Fraction(1, 5), phase_2=Fraction(2, 5),
        relay=RelayTimes(clock_hz=50_000),
    )  # fmt: skip
    fpga = Fraction(16_000_000)
    assert told.clocks(Config()) == (
        Clock(frequency_hz=fpga, domain="fpga_1", ppm=Fraction(3), phase=Fraction(1, 5)),
        Clock(frequency_hz=fpga, domain="fpga_2", ppm=Fraction(-4), phase=Fraction(2, 5)),
        Clock(frequency_hz=Fraction(50_000), domain="relay"),
    )


def test_the_same_seed_makes_the_same_run() -> None:
    one, again, other = (scenario("link-noise@0s", seed=seed).controls(SMALL) for seed in (1, 1, 2))
    assert one == again
    assert one != other


def test_a_run_may_be_as_short_as_a_femtosecond() -> None:
    found = Scenario(seconds=FEMTOSECOND).controls(SMALL)
    assert (found.end, {len(wave) for wave in found.signals.values()}) == (1, {1})


@pytest.mark.parametrize(
    ("settings", "error"),
    [
        ({"seconds": 0}, "seconds must be between 1/1000000000000000 and 8000, not 0"),
        ({"ppm_1": 10**6}, "ppm_1 must be between -100000 and 100000, not 1000000"),
        ({"first_index": -1}, "first_index must be between 0 and 4294967295, not -1"),
        ({"update_cycles": 0}, "update_cycles must be between 1 and 1000000, not 0"),
        ({"seed": -1}, "seed must be between 0 and 9223372036854775807, not -1"),
        ({"phase_2": 1}, "phase must be at least 0 and below 1 period, not 1"),
        (
            {"commands": (Command(start_s=Fraction(1), image=0),) * 2},
            "commands must be in order of time, not 1 s after 1 s",
        ),
    ],
)
def test_what_is_no_scenario_is_refused(settings: dict[str, Any], error: str) -> None:
    with pytest.raises(ValueError, match=error):
        Scenario(**settings).controls(SMALL)
