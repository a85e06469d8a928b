"""One FPGA in a run: the frames that came, what its counters counted, what it stored."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from railgate.engines import Clock
from railgate.engines.signals import parts
from railgate.vital_output.observed import Observed
from railgate.vital_output.plant.edges import FEMTOSECOND, Edges
from railgate.vital_output.simulate import simulate
from railgate.vital_output.spec import Config, State
from railgate.waves import Trace, Waveform
from vital_output.runs import run_of, scenario_of
from vital_output.small import SMALL

CLOCK = Clock(frequency_hz=Fraction(SMALL.clock_hz), domain="fpga_1", phase=Fraction(1, 3))
END = 10**12
WIDE = Config(outputs=64, release_min_s=Fraction(5, 1000))


@pytest.mark.parametrize("fpga", [1, 2])
def test_the_frames_are_those_that_the_cpus_sent(fpga: int) -> None:
    channel = run_of("good").channels[fpga - 1]
    values = [frame.values for frame in channel.frames]
    assert all(values)
    assert [each["sequence"] for each in values if each] == list(range(len(values)))
    on, off = (command.start_s / SMALL.cycle_s for command in scenario_of("good").commands)
    assert [frame.image for frame in channel.frames] == (
        [int(on <= cycle < off) for cycle in range(2, 2 + len(values))]
    )
    gaps = np.diff([frame.at for frame in channel.frames]) * float(FEMTOSECOND)
    assert gaps == pytest.approx(float(SMALL.cycle_s), abs=2e-6)


@pytest.mark.parametrize("situation", ["good", "channel-restart", "cpu-switch-over", "skew"])
@pytest.mark.parametrize("fpga", [1, 2])
def test_what_is_judged_and_stored_is_what_the_registers_tell(situation: str, fpga: int) -> None:
    channel = run_of(situation).channels[fpga - 1]
    sequence, image = channel.wave("sequence"), channel.wave("image")
    for at, _ in channel.counted("accepted"):
        values = channel.judged(at).values
        assert values
        assert sequence.at(at) == values["sequence"]
    assert len(channel.stores) == channel.total("stored") > 5
    for at, frame in channel.stores:
        assert image.at(at) == frame.image
        assert frame.at < at


def test_a_frame_in_pieces_is_no_frame() -> None:
    """Its first bytes are lost with the clock, its last ones come."""
    scenario = scenario_of("good")
    start = 4 * SMALL.cycle_s + 2 * SMALL.margin_s
    told = replace(scenario, seconds=6 * SMALL.cycle_s, commands=())
    whole = simulate(told, SMALL).channels[0]
    stopped = Waveform.of(
        [0, *(int((start + Fraction(us, 10**6)) / FEMTOSECOND) for us in (-9, 5))], [0, 1, 0]
    )
    signals = {**whole.trace.signals, "fpga_1.stopped": stopped}
    cut = replace(whole, trace=replace(whole.trace, signals=signals))
    at = [frame.values is None for frame in cut.frames]
    assert at == [frame.tick == cut.frames[2].tick for frame in cut.frames]
    assert [frame.tick for frame in cut.frames] == [frame.tick for frame in whole.frames]
    assert cut.frames[2].image == 0


def test_a_reset_changes_nothing_and_counts_go_on_over_it() -> None:
    channel = run_of("channel-restart").channels[0]
    (reset,) = channel.resets.tolist()
    wave = channel.wave("accepted_count")
    assert 0 in wave.values[1:]
    assert channel.total("accepted") == len(channel.counted("accepted")) > int(wave.values[-1])
    tick = 10**9
    for name in ("accepted_count", "life", "image", "states"):
        assert all(not reset < at <= reset + tick for at, *_ in channel.changes(name))
    assert all(not reset < at <= reset + tick for at, *_ in channel.transitions(0))
    assert any(reset < at <= reset + tick for at in wave.ticks.tolist())


def traced(config: Config, signals: dict[str, Waveform]) -> Observed:
    told = {f"fpga_1.{name}": wave for name, wave in signals.items()}
    whole = {"fpga_1_rst": Waveform.of([0], [0]), **told}
    return Observed(config, CLOCK, Trace(whole, FEMTOSECOND, 0, END), 1)


def test_counters_are_read_over_their_end() -> None:
    last = (1 << SMALL.count_bits) - 1
    fields = {field.name: Waveform.of([0], [0], field.width) for field in SMALL.fields}
    fields["lost_count"] = Waveform.of([0, 5, 9], [last - 1, last, 2], SMALL.count_bits)
    channel = traced(SMALL, fields)
    assert channel.counted("lost") == [(5, 1), (9, 3)]
    assert channel.total("lost") == 4


@given(st.lists(st.lists(st.sampled_from(State), min_size=64, max_size=64), min_size=1, max_size=5))
def test_states_are_read_wherever_their_bits_are(states: list[list[State]]) -> None:
    packed = [sum(code << 3 * i for i, code in enumerate(each)) for each in states]
    ticks = [7 * i for i in range(len(states))]
    signals = {
        name: Waveform.of(ticks, [whole >> low & (1 << width) - 1 for whole in packed], width)
        for name, width, low in parts("states", 3 * 64)
    }
    channel = traced(WIDE, signals)
    for output in range(64):
        wave = channel.state(output)
        assert [wave.at(tick) for tick in ticks] == [each[output] for each in states]


def test_a_last_byte_is_where_the_tick_begins_in_which_it_is_transferred() -> None:
    run = run_of("good")
    for channel in run.channels:
        edges = Edges(channel.clock)
        for frame in channel.frames:
            assert edges.begin(frame.tick) == frame.at
            assert channel.wave("command.payload").at(frame.at) >> 9 == 1
