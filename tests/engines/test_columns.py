"""A table's columns are waveforms."""

import numpy as np

from railgate.engines.columns import Columns
from railgate.waves import Waveform


def test_columns_are_waveforms_of_their_width_and_sign_without_repeats() -> None:
    columns = Columns([("a", 64, False), ("b", 3, True), ("c", 9, False)])
    ticks = np.array([4, 6, 9])
    table = np.array([[-1, -4, 0], [-1, 3, 0], [5, 3, 0]])
    waves = columns.waves(ticks, table, ["x.b", "x.a", "other"], "x.")
    assert waves == {
        "x.a": Waveform([4, 9], [(1 << 64) - 1, 5], 64),
        "x.b": Waveform([4, 6], [-4, 3], 3, True),
    }
    assert waves["x.b"].values.dtype == np.int8
    assert columns.waves(ticks, table, []) == {}
