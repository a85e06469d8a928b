"""What the functions are driven with."""

from __future__ import annotations

from importlib import resources
from pathlib import Path

import numpy as np

from railgate.fpga.export import core
from railgate.fpga.export.vectors import FIRST_TICKS, vectors
from railgate.odometer.spec import Flag
from railgate.position_link.spec import Status
from railgate.vital_output.spec import State
from railgate.waves import read
from vital_output.equality import assert_same

CAPTURE = Path(__file__).parents[2] / "data/sigrok/avago_adns_2051_move_mouse_fast.sr"
FROM, SAMPLES = 3_474_000, 20_000


def test_the_wheel_is_a_piece_of_the_real_capture() -> None:
    piece = read(CAPTURE, ["XA", "XB", "YA", "YB"]).slice(FROM, FROM + SAMPLES).shift(-FROM)
    with resources.as_file(resources.files("railgate.fpga.export.stimuli") / "wheel.vcd") as path:
        assert_same(piece, read(path))


def test_the_vectors_of_the_odometer_have_edges_a_reversal_and_a_reset() -> None:
    trace = vectors(core("odometer")).trace
    assert len(trace["number"]) > 8
    assert trace["sensor.0.a_rising"].values[-1] >= 10
    assert trace["sensor.1.direction_changes"].values[-1] >= 1
    assert trace["rst"].rising().tolist() == [FIRST_TICKS - 1]


def test_the_vectors_of_the_odometer_raise_each_flag_that_comes_soon() -> None:
    trace = vectors(core("odometer")).trace
    apart = Flag.GLITCH | Flag.SATURATED | Flag.WINDOW_OVERFLOW | Flag.STAMP_OVERFLOW
    for sensor in (0, 1):
        flags = trace[f"sensor.{sensor}.flags"].values
        assert Flag(int(np.bitwise_or.reduce(flags))) == ~apart & Flag((1 << len(Flag)) - 1)


def test_the_vectors_of_the_link_have_a_word_one_that_is_held_and_a_word_again() -> None:
    status = vectors(core("position_link")).trace["status"]
    found = [Status(value) for value in status.values.tolist()]
    assert found == [Status.FAULT, Status.FRESH, Status.HELD, Status.FRESH]


def test_the_vectors_of_a_channel_test_drive_and_release(exported) -> None:
    made = exported("vital_output", small=True)
    states = vectors(core("vital_output", config=str(made.path.with_name("small.toml"))))
    bits = (states.trace["states"].width) // 2
    found = [State(value & (1 << bits) - 1) for value in states.trace["states"].values.tolist()]
    unique = [now for before, now in zip([None, *found], found, strict=False) if now != before]
    assert unique[-5:] == [State.IDLE, State.PRE_DRIVE, State.DRIVE, State.WAIT, State.IDLE]
    assert State.TEST in unique
    assert not {State.HANDSHAKE_ALARM, State.FEEDBACK_ALARM} & set(unique)
