"""VCD and GTKWave save files as written: what stands in them, and what is refused."""

import re
import time
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railgate.waves import Limits, Trace, Waveform, write_gtkw, write_vcd
from railgate.waves.wellen import decode
from waves.drawn import signals

FS = Fraction(1, 10**15)


@st.composite
def traces(draw):
    """Any trace that VCD can hold."""
    period = draw(
        st.one_of(
            st.builds(lambda n, e: n * Fraction(10) ** -e, st.integers(1, 999), st.integers(0, 15)),
            st.fractions(FS, 1000),
        )
    )
    latest = min((1 << 62) * FS / period, 1 << 62)
    start = draw(st.integers(0, int(latest) // 2))
    end = start + draw(st.integers(0, min(1000, int(latest) // 2)))
    names = draw(
        st.lists(st.sampled_from(["a", "b", "a.b", "a.0.c", "x_1"]), min_size=1, unique=True)
    )
    return Trace(draw(signals(names, start, end)), period, start, max(end, start + 1))


@given(traces())
@settings(deadline=None, max_examples=150)
def test_a_trace_comes_back_as_it_went(tmp_path_factory, trace):
    path = tmp_path_factory.mktemp("vcd") / "a.vcd"
    write_vcd(path, trace)
    assert decode(path, None, Limits()) == trace


@pytest.mark.parametrize(
    ("hertz", "timescale", "stamps"),
    [
        (1_000_000, "1 us", [0, 3, 5]),
        (100, "10 ms", [0, 3, 5]),
        (16_000_000, "100 ps", [0, 1875, 3125]),
        (24_000_000, "1 fs", [0, 125_000_000, 208_333_334]),
    ],
)
def test_the_timescale_is_the_coarsest_that_is_exact(tmp_path, hertz, timescale, stamps):
    trace = Trace({"a": Waveform.of([0, 3], [0, 1])}, Fraction(1, hertz), 0, 5)
    write_vcd(tmp_path / "a.vcd", trace)
    text = (tmp_path / "a.vcd").read_text()
    assert f"$timescale {timescale} $end" in text
    assert [int(stamp) for stamp in re.findall(r"^#(\d+)$", text, re.MULTILINE)] == stamps


def test_equal_traces_make_equal_files(tmp_path):
    trace = Trace({"a b.c[0]": Waveform.of([0, 3], [0, 1])}, FS, 0, 5)
    for name in ("one", "two"):
        write_vcd(tmp_path / name, trace)
    assert (tmp_path / "one").read_bytes() == (tmp_path / "two").read_bytes()
    assert "$scope module a_b $end\n$var wire 1 ! c_0_ $end" in (tmp_path / "one").read_text()


@pytest.mark.parametrize(
    ("trace", "reason"),
    [
        (Trace({}, FS, -1, 5), "must not begin before tick 0, not at -1"),
        (Trace({}, FS / 2, 0, 5), "must last at least 1 fs"),
        (Trace({}, Fraction(1, 3), 0, 1 << 62), "must fit 63 bits of 1 fs"),
        (
            Trace({"a b": Waveform.of([0], [0]), "a_b": Waveform.of([0], [0])}, FS, 0, 5),
            'not be two of "top.a_b"',
        ),
    ],
)
def test_what_vcd_cannot_hold_is_refused(tmp_path, trace, reason):
    with pytest.raises(ValueError, match=re.escape(reason)):
        write_vcd(tmp_path / "a.vcd", trace)
    assert not list(tmp_path.iterdir())


SHOWN = Trace(
    {
        "clk": Waveform.of([0], [0]),
        "odometer.count": Waveform.of([0], [0], 32),
        "odometer.position": Waveform.of([0], [0], 32, True),
        "odometer.0.a": Waveform.of([0], [0]),
    },
    FS,
    0,
    5,
)


def test_a_save_file_groups_by_scope(tmp_path):
    write_gtkw(tmp_path / "a.gtkw", tmp_path / "a.vcd", SHOWN)
    lines = (tmp_path / "a.gtkw").read_text().splitlines()
    assert lines == [
        f'[dumpfile] "{tmp_path / "a.vcd"}"',
        *("@800200", "-top", "@28", "top.clk", "@1000200", "-top"),
        *("@800200", "-odometer", "@24", "top.odometer.count[31:0]"),
        *("@420", "top.odometer.position[31:0]", "@1000200", "-odometer"),
        *("@800200", "-odometer.0", "@28", "top.odometer.0.a", "@1000200", "-odometer.0"),
    ]


def test_a_save_file_takes_groups_and_formats(tmp_path):
    write_gtkw(
        tmp_path / "a.gtkw",
        "a.vcd",
        SHOWN,
        {"speed": ["odometer.count"]},
        {"odometer.count": "hex"},
    )
    lines = (tmp_path / "a.gtkw").read_text().splitlines()
    assert lines[1:] == [
        "@800200",
        "-speed",
        "@22",
        "top.odometer.count[31:0]",
        "@1000200",
        "-speed",
    ]


def test_a_save_file_of_other_signals_is_refused(tmp_path):
    for options in ({"groups": {"x": ["y"]}}, {"formats": {"y": "hex"}}):
        with pytest.raises(ValueError, match='no channel "y"; there are: clk'):
            write_gtkw(tmp_path / "a.gtkw", "a.vcd", SHOWN, **options)
    with pytest.raises(ValueError, match='must be one of bin, dec, hex, oct, signed, not "real"'):
        write_gtkw(tmp_path / "a.gtkw", "a.vcd", SHOWN, formats={"clk": "real"})
    assert not list(tmp_path.iterdir())


def test_the_names_of_many_signals_take_linear_time(tmp_path):
    wave = Waveform.of([0], [0])
    trace = Trace(
        {f"s{index}": wave for index in range(20_000)} | {"s_1": wave, "s.1": wave}, FS, 0, 5
    )
    twice = trace.merge(Trace({"s 1": wave}, FS, 0, 5))
    began = time.process_time()
    with pytest.raises(ValueError, match=re.escape('not be two of "top.s_1"')):
        write_vcd(tmp_path / "a.vcd", twice)
    assert time.process_time() - began < 1
