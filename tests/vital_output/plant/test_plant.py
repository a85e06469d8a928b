"""Cross-link and feedback in the closed loop's plant, femtosecond for femtosecond."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railgate.vital_output.plant.edges import Edges
from railgate.waves import Waveform
from vital_output.plant.stimuli import (
    DELAY_TICKS,
    TIMES,
    levels,
    plant_clocks,
    through,
    trace,
)
from vital_output.small import SMALL

END = 10**11
"""100 µs, as many ticks of an FPGA."""

changes = st.lists(st.integers(1, END - 1), unique=True, max_size=20).map(levels)


def sent(c: int, link_tx: Waveform, stopped: Waveform) -> Waveform:
    """What comes out of the flip-flops of FPGA c's line, tick by tick."""
    edges = Edges(plant_clocks(TIMES)[c - 1])
    bits, stops = edges.sampled(link_tx), edges.sampled(stopped)
    line, values = [1] * DELAY_TICKS, []
    for tick in range(edges.count(END)):
        values.append(line[-1])
        if not stops.at(tick):
            line = [int(bits.at(tick)), *line[:-1]]
    return edges.wave(np.arange(len(values)), values, 1, END)


@pytest.mark.parametrize(("c", "other"), [(1, 2), (2, 1)])
@given(st.lists(changes, min_size=5, max_size=5))
@settings(max_examples=40, deadline=None)
def test_a_line_is_delayed_by_its_senders_clock_and_disturbed(
    c: int, other: int, waves: list[Waveform]
) -> None:
    link_tx, stopped, flip, low, high = waves
    names = (f"fpga_{c}.link_tx", f"fpga_{c}.stopped")
    names += tuple(f"line_{c}.{what}" for what in ("flip", "low", "high"))
    found = through("cxxrtl", TIMES, trace(dict(zip(names, waves, strict=True)), END))
    delayed = sent(c, link_tx, stopped)
    ticks = np.unique(np.concatenate([wave.ticks for wave in (delayed, flip, low, high)]))
    level = [
        1 if high.at(k) else 0 if low.at(k) else int(delayed.at(k) ^ flip.at(k)) for k in ticks
    ]
    assert found[f"fpga_{other}.link_rx"] == Waveform.of(ticks, level)
    assert found[f"fpga_{c}.link_rx"].values[-1] == 0  # nothing is sent the other way
    before = Edges(plant_clocks(TIMES)[other - 1]).begin(DELAY_TICKS)
    assert found[f"fpga_{c}.link_rx"].falling().tolist() == [before]


FEEDBACK = {
    "fpga_1.pulse_feedback": ("fpga_1.pulses", "relay.open_1", "relay.stuck_1"),
    "fpga_2.pulse_feedback": ("fpga_2.pulses", "relay.open_2", "relay.stuck_2"),
}


@given(
    st.lists(
        st.lists(st.integers(0, (1 << SMALL.outputs) - 1), min_size=5, max_size=5),
        min_size=6,
        max_size=6,
    )
)
@settings(max_examples=40, deadline=None)
def test_feedback_is_each_outputs_own_and_stuck_counts_before_open(rows: list[list[int]]) -> None:
    names = [name for inputs in FEEDBACK.values() for name in inputs]
    step = END // 5
    waves = [Waveform.of(np.arange(5) * step, row, SMALL.outputs) for row in rows]
    found = through("cxxrtl", TIMES, trace(dict(zip(names, waves, strict=True)), END))
    for told, inputs in FEEDBACK.items():
        pulses, opened, stuck = (rows[names.index(name)] for name in inputs)
        for i in range(5):
            expected = pulses[i] & ~opened[i] | stuck[i]
            assert found[told].at(i * step) == expected


def test_the_contact_is_fed_back_to_both_and_can_be_open_or_stuck() -> None:
    rogue = Waveform.of([0], [3], SMALL.outputs)
    whole, part = 4 * 10**12, 3 * 10**12
    inputs = {
        "relay.rogue_1": rogue,
        "relay.rogue_2": rogue,
        "relay.contact_open": Waveform.of([0, part], [0, 1], SMALL.outputs),
        "relay.contact_stuck": Waveform.of([0, 10**9, 2 * 10**9], [0, 2, 0], SMALL.outputs),
    }
    found = through("cxxrtl", TIMES, trace(inputs, whole))
    assert found["contact"].values.tolist() == [0, 3]
    closes = found["contact"].ticks[1]
    assert found["contact_feedback"] == Waveform.of(
        [0, 10**9, 2 * 10**9, closes, part], [0, 2, 0, 3, 2], SMALL.outputs
    )
