"""What counts in a monitor's outputs, and what random stimuli drive it with."""

import numpy as np
import pytest

from proving.counting import Signed, claim
from railgate.proving import TICK, Run
from railgate.proving.mutation import elaborated
from railgate.proving.replay import fall, reached, stimulus
from railgate.waves import Trace, Waveform

TICKS = 10
SIGNED = elaborated(claim(Signed))


def outputs(**falls_at: int) -> Trace:
    """Outputs that are 1 and become 0 in the tick given; `reached` is 0 and becomes 1."""
    at = {"holds": TICKS, "assumed": TICKS, "lemma.one": TICKS, "reached": TICKS} | falls_at
    waves = {}
    for name, tick in at.items():
        ticks = [t for t in (0, tick) if t < TICKS]
        values = [int(name != "reached"), int(name == "reached")]
        waves[name] = Waveform.of(ticks, values[: len(ticks)])
    return Trace(waves, TICK, 0, TICKS)


@pytest.mark.parametrize(
    ("falls_at", "says"),
    [
        ({}, "None"),
        ({"holds": 0}, "holds is 0 in tick 0"),
        ({"holds": 4}, "holds is 0 in tick 4"),
        ({"holds": 4, "assumed": 5}, "holds is 0 in tick 4"),
        ({"holds": 4, "assumed": 4}, "None"),
        ({"holds": 4, "assumed": 0}, "None"),
        ({"assumed": 3}, "None"),
        ({"holds": 4, "lemma.one": 3}, "lemma.one is 0 in tick 3"),
        ({"holds": 4, "lemma.one": 4}, "holds is 0 in tick 4"),
    ],
)
def test_a_fall_counts_while_all_was_as_assumed(falls_at: dict[str, int], says: str) -> None:
    assert str(fall(outputs(**falls_at))) == says


def test_a_lemma_does_not_count_where_only_the_claim_is_asked_for() -> None:
    assert fall(outputs(**{"lemma.one": 3}), helped=False) is None


@pytest.mark.parametrize(
    ("at", "assumed", "counts"), [(3, 10, True), (3, 4, True), (3, 3, False), (10, 10, False)]
)
def test_a_cover_counts_while_all_was_as_assumed(at: int, assumed: int, counts: bool) -> None:
    assert reached(outputs(reached=at, assumed=assumed)) is counts


def test_random_stimuli_drive_each_input_over_its_whole_range_but_never_rst() -> None:
    driven = stimulus(Run(20_000), SIGNED)
    assert driven == stimulus(Run(20_000), SIGNED)
    assert (driven.end, list(driven.signals)) == (20_000, ["pair.value", "pair.sure", "go"])
    value = driven["pair.value"]
    assert (value.values.min(), value.values.max()) == (-8, 7)
    assert (driven["pair.sure"].values.max(), driven["go"].values.max()) == (3, 1)
    lengths = np.diff(value.ticks)
    assert lengths.min() == 1
    assert lengths.max() > 128


def test_a_stimulus_that_is_too_short_is_refused() -> None:
    short = Trace({"go": Waveform.of([0], [1])}, TICK, 0, 5)
    assert stimulus(Run(4, lambda: short), SIGNED).end == 4
    with pytest.raises(ValueError, match=r"inside ticks 0\.\.5, not 0\.\.6"):
        stimulus(Run(6, lambda: short), SIGNED)
