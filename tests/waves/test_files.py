"""The one way in, and the way out that leaves nothing half-written."""

import re
import stat
from fractions import Fraction

import pytest

from railgate.waves import Limits, Trace, Waveform, read, replacing, write_parquet, write_vcd

TRACE = Trace({"a": Waveform.of([0, 3], [0, 1])}, Fraction(1, 1000), 0, 5)


def test_the_content_rules_over_the_suffix(tmp_path):
    write_parquet(tmp_path / "a.csv", TRACE)
    write_vcd(tmp_path / "b.sr", TRACE)
    assert read(tmp_path / "a.csv") == TRACE
    assert read(str(tmp_path / "b.sr")) == TRACE


@pytest.mark.parametrize("suffix", ["", ".txt", ".ghw"])
def test_other_files_are_refused(tmp_path, suffix):
    (tmp_path / f"a{suffix}").write_bytes(b"hello")
    with pytest.raises(
        ValueError,
        match=re.escape(
            f'must be a sigrok session (.sr), VCD, FST, CSV or Parquet file, not "{suffix}"'
        ),
    ):
        read(tmp_path / f"a{suffix}")


@pytest.mark.parametrize("suffix", [".sr", ".vcd", ".fst", ".csv", ".parquet"])
@pytest.mark.parametrize("content", [b"", b"\0\1\2 garbage", b"PK\3\4", b"PAR1PAR1"])
def test_garbage_is_refused_in_one_line(tmp_path, suffix, content):
    path = tmp_path / f"a{suffix}"
    path.write_bytes(content)
    with pytest.raises(ValueError, match=re.escape(str(path))) as caught:
        read(path)
    assert "\n" not in str(caught.value)


def test_what_is_no_file_is_refused(tmp_path):
    with pytest.raises(ValueError, match="no such file"):
        read(tmp_path / "a.sr")
    with pytest.raises(ValueError, match="no such file"):
        read(tmp_path)


def test_a_channel_wanted_twice_is_refused(tmp_path):
    write_parquet(tmp_path / "a.parquet", TRACE)
    with pytest.raises(ValueError, match="each channel may be wanted once, not a, a"):
        read(tmp_path / "a.parquet", ["a", "a"])


def test_a_limit_below_one_is_refused():
    with pytest.raises(ValueError, match="transitions must be at least 1, not 0"):
        Limits(transitions=0)


def test_a_replacement_takes_the_place_when_it_is_whole(tmp_path):
    path = tmp_path / "a"
    path.write_text("old")
    with replacing(path) as unfinished:
        unfinished.write_text("new")
        assert path.read_text() == "old"
    assert path.read_text() == "new"
    assert list(tmp_path.iterdir()) == [path]
    ordinary = tmp_path / "b"
    ordinary.write_text("")
    assert stat.S_IMODE(path.stat().st_mode) == stat.S_IMODE(ordinary.stat().st_mode)


def interrupted(path):
    with replacing(path) as unfinished:
        unfinished.write_text("half")
        raise KeyboardInterrupt


def test_a_failed_replacement_leaves_the_old_file_and_nothing_else(tmp_path):
    path = tmp_path / "a"
    path.write_text("old")
    with pytest.raises(KeyboardInterrupt):
        interrupted(path)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_place_that_cannot_be_written_is_refused(tmp_path):
    with (
        pytest.raises(ValueError, match="cannot be written: No such file"),
        replacing(tmp_path / "no" / "a"),
    ):
        pass
    with pytest.raises(ValueError, match="cannot be written: Is a directory"), replacing(tmp_path):
        pass


def test_no_control_sequence_of_a_file_reaches_the_terminal(tmp_path):
    (tmp_path / "a.csv").write_text("t,\x1b[2J\u202eevil\n0,1\n")
    with pytest.raises(
        ValueError, match=re.escape('no channel "x"; there are: ?[2J?evil')
    ) as caught:
        read(tmp_path / "a.csv", ["x"])
    assert str(caught.value).isprintable()
