"""A run of the link, whatever it is told about its progress."""

from fractions import Fraction

import pytest

from railgate.position_link.plant import Scenario, fault
from railgate.position_link.simulate import simulate
from railgate.position_link.spec import Config

LINK = Config(
    clock_hz=1_000_000,
    bit_rate_hz=Fraction(100_000),
    cycle_s=Fraction(1, 500),
    word_bits=8,
    filter_ticks=2,
    guard_ticks=1,
)


@pytest.mark.parametrize("wave_cycles", [0, 3, 9])
def test_progress_is_told_after_each_cycle_and_changes_nothing(wave_cycles) -> None:
    scenario = Scenario(faults=(fault("missing@4ms"), fault("noise@6ms..9ms")))
    told: list[float] = []
    watched = simulate(scenario, LINK, 7, wave_cycles=wave_cycles, progress=told.append)
    alone = simulate(scenario, LINK, 7, wave_cycles=wave_cycles)
    assert watched.as_json() == alone.as_json()
    assert watched.waves == alone.waves
    assert watched.waves.end == min(
        max(wave_cycles, 1) * LINK.cycle_ticks, 7 * LINK.cycle_ticks + 1
    )
    assert len(told) >= 7
    assert told == sorted(told)
    assert told[-1] == 1
