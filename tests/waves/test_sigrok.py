"""sigrok sessions: real captures against sigrok's own decoders, and every way to be damaged."""

import json
import re
import shutil
import struct
import subprocess
import time
import zipfile
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railgate.waves import Limits, Trace, read
from waves.drawn import assert_reads_or_is_refused, damaged

DATA = Path(__file__).parents[1] / "data" / "sigrok"
GOLDEN = json.loads((DATA / "golden.json").read_text())
CAPTURES = sorted(path.name for path in DATA.glob("*.sr"))
CHANNELS = ["SCLK", "XA", "XB", "YB", "YA", "XY_LED", "PD", "SDIO"]
PAIRS = [("XA", "XB"), ("YA", "YB")]
METADATA = """[device 1]
capturefile=logic-1
total probes={probes}
samplerate={rate}
{names}
unitsize={unitsize}
"""


def metadata(unitsize=1, rate="1 MHz", names=("A", "B")):
    listed = "\n".join(f"probe{index}={name}" for index, name in enumerate(names, 1))
    return METADATA.format(probes=len(names), rate=rate, names=listed, unitsize=unitsize)


def session(
    path: Path,
    data: bytes | list[bytes],
    about: str | None = None,
    packing: int = zipfile.ZIP_DEFLATED,
) -> Path:
    """A session file; of a list, each item is a chunk (None: the chunk is missing)."""
    with zipfile.ZipFile(path, "w", packing) as archive:
        archive.writestr("version", "2")
        archive.writestr("metadata", about or metadata())
        if isinstance(data, bytes):
            archive.writestr("logic-1", data)
        else:
            for number, chunk in enumerate(data, 1):
                if chunk is not None:
                    archive.writestr(f"logic-1-{number}", chunk)
    return path


def sigrok(capture: str, *options: str) -> list[tuple[int, int, int]]:
    """(first sample, last sample, number) of each annotation of sigrok's decoder."""
    command = ["sigrok-cli", "-i", DATA / capture, "--protocol-decoder-samplenum", *options]
    output = subprocess.run(command, capture_output=True, text=True, check=False).stdout
    found = re.findall(r"^(\d+)-(\d+) [a-z]+-1: (-?\d+)$", output, re.MULTILINE)
    return [(int(first), int(last), int(number)) for first, last, number in found]


def judged(capture: str) -> dict[str, object]:
    """What sigrok's `counter` and `graycode` say about a capture."""
    answer: dict[str, object] = {}
    for channel in CHANNELS:
        edges = sigrok(
            capture, "-P", f"counter:data={channel}:data_edge=rising", "-A", "counter=edge_count"
        )
        answer[channel] = edges[-1][2] if edges else 0
    for a, b in PAIRS:
        spans = sigrok(capture, "-P", f"graycode:d0={a}:d1={b}", "-A", "graycode=count")
        answer[f"{a}/{b}"] = {
            "spans": len(spans),
            "last_change": spans[-1][1] if spans else 0,
            "count_before": spans[-1][2] if spans else 0,
            "sum_of_changes": sum(last for _, last, _ in spans),
        }
    return answer


def steps(trace: Trace, a: str, b: str) -> tuple[np.ndarray, np.ndarray]:
    """Ticks at which a pair changes and its ×4 steps, two-bit changes counting none."""
    ticks = np.unique(np.concatenate([trace[a].ticks, trace[b].ticks]))
    high_a, high_b = trace[a].at(ticks).astype(int), trace[b].at(ticks).astype(int)
    turn = np.diff((high_a ^ high_b) + 2 * high_b) % 4
    return ticks[1:], np.array([0, 1, 0, -1])[turn]


@pytest.mark.skipif(not shutil.which("sigrok-cli"), reason="sigrok-cli is not installed")
@pytest.mark.parametrize("capture", CAPTURES)
def test_golden_answers_are_those_of_sigrok(capture):
    assert judged(capture) == GOLDEN[capture]


@pytest.mark.parametrize("capture", CAPTURES)
def test_rising_edges_are_those_that_sigrok_counts(capture):
    trace = read(DATA / capture)
    assert {name: len(trace[name].rising()) for name in CHANNELS} == {
        name: GOLDEN[capture][name] for name in CHANNELS
    }
    assert trace.period == Fraction(1, 1_000_000)


@pytest.mark.parametrize("capture", CAPTURES)
@pytest.mark.parametrize(("a", "b"), PAIRS)
def test_quadrature_counts_are_those_of_sigrok(capture, a, b):
    ticks, turns = steps(read(DATA / capture, [a, b]), a, b)
    moved = turns != 0
    expected = GOLDEN[capture][f"{a}/{b}"]
    assert np.count_nonzero(moved) == expected["spans"]
    if moved.any():
        assert ticks[moved][-1] == expected["last_change"]
        assert turns[moved][:-1].sum() == expected["count_before"]
    assert ticks[moved].sum() == expected["sum_of_changes"]


@pytest.mark.parametrize(("a", "b"), PAIRS)
def test_the_unplugged_capture_holds_one_illegal_transition(a, b):
    _, turns = steps(read(DATA / "avago_adns_2051_remove_and_readd_usb.sr", [a, b]), a, b)
    assert np.count_nonzero(turns == 0) == 1


@given(st.data())
@settings(deadline=None, max_examples=60)
def test_each_sample_is_the_bit_that_was_stored(tmp_path_factory, data):
    unitsize = data.draw(st.integers(1, 8))
    samples = data.draw(st.lists(st.integers(0, (1 << 8 * unitsize) - 1), min_size=1, max_size=40))
    raw = b"".join(sample.to_bytes(unitsize, "little") for sample in samples)
    cut = data.draw(st.integers(0, len(samples))) * unitsize
    names = [f"D{index}" for index in range(8 * unitsize)]
    path = tmp_path_factory.mktemp("sr") / "a.sr"
    session(
        path,
        data.draw(st.sampled_from([raw, [raw[:cut], raw[cut:]]])),
        metadata(unitsize, names=names),
    )
    wanted = data.draw(st.lists(st.sampled_from(names), min_size=1, max_size=5, unique=True))
    trace = read(path, wanted)
    assert list(trace.signals) == wanted
    assert (trace.start, trace.end) == (0, len(samples))
    for name in wanted:
        bits = [sample >> int(name[1:]) & 1 for sample in samples]
        assert trace[name].at(range(len(samples))).tolist() == bits


def test_a_change_between_two_pieces_of_a_stream_is_kept(tmp_path):
    piece = 1 << 22
    data = bytes(piece) + b"\1" * piece + b"\3" * 3
    trace = read(session(tmp_path / "a.sr", data))
    assert trace["A"].ticks.tolist() == [0, piece]
    assert trace["B"].ticks.tolist() == [0, 2 * piece]


def test_a_sample_may_straddle_two_pieces_of_a_stream(tmp_path):
    samples = np.zeros((1_500_000, 3), np.uint8)
    samples[1_398_101:, 2] = 1  # this sample begins in the last byte of the first 4 MiB
    names = [f"D{index}" for index in range(24)]
    trace = read(session(tmp_path / "a.sr", samples.tobytes(), metadata(3, names=names)), ["D16"])
    assert trace["D16"].ticks.tolist() == [0, 1_398_101]


@pytest.mark.parametrize(
    ("text", "hertz"),
    [
        ("24 MHz", 24_000_000),
        ("1.5 kHz", 1500),
        ("200000", 200_000),
        ("1 GHz", 10**9),
        ("0.1 Hz", Fraction(1, 10)),
    ],
)
def test_the_tick_is_exactly_one_sample(tmp_path, text, hertz):
    assert read(session(tmp_path / "a.sr", b"\0", metadata(rate=text))).period == 1 / Fraction(
        hertz
    )


@pytest.mark.parametrize(
    ("about", "reason"),
    [
        (metadata(unitsize=0), 'unitsize must be between 1 and 8, not "0"'),
        (metadata(unitsize=9), 'unitsize must be between 1 and 8, not "9"'),
        (metadata(unitsize="²"), "unitsize must be between 1 and 8"),
        (metadata(rate="0 Hz"), "samplerate must be a frequency such as 24 MHz"),
        (metadata(rate="fast"), 'such as 24 MHz, not "fast"'),
        (metadata(names="ABCDEFGHI"), "probes must be numbered 1 to 8, not 9"),
        (metadata(names="AA"), "each probe needs its own name"),
        (metadata(names=""), "at least one probe"),
        ("no section", 'sections of key=value, not "no section" in line 1'),
        ("[device 1]\nunitsize\n", 'sections of key=value, not "unitsize" in line 2'),
        ("unitsize=1\n[device 1]\n", 'sections of key=value, not "unitsize=1" in line 1'),
        ("[device 1]\nunitsize=1\nUnitsize=2\n", 'must not repeat "unitsize" in line 3'),
        ("[global]\n", 'a section "device 1"'),
    ],
)
def test_damaged_metadata_are_refused(tmp_path, about, reason):
    refused(session(tmp_path / "a.sr", b"\0\1", about), reason)


def refused(path: Path, reason: str, channels=None, limits=None) -> None:
    with pytest.raises(ValueError, match=re.escape(reason)) as caught:
        read(path, channels, limits)
    assert "\n" not in str(caught.value)
    assert str(caught.value).startswith(f"{path}: ")


def test_missing_things_are_named(tmp_path):
    refused(session(tmp_path / "a.sr", b"\0"), 'no channel "C"; there are: A, B', ["C"])
    refused(session(tmp_path / "b.sr", [b"\0", None, b"\0"]), 'chunk "logic-1-2" of 3 is missing')
    refused(session(tmp_path / "c.sr", []), "must hold logic data")
    refused(session(tmp_path / "d.sr", b""), "at least one sample")
    refused(tmp_path / "e.sr", "no such file")
    for missing in ("version", "metadata"):
        path = tmp_path / f"{missing}.sr"
        with zipfile.ZipFile(path, "w") as archive:
            for name in {"version": "2", "metadata": metadata(), "logic-1": "\0"}.items():
                if name[0] != missing:
                    archive.writestr(*name)
        refused(path, f'must hold a file "{missing}"')


def test_a_version_that_is_not_known_is_refused(tmp_path):
    with zipfile.ZipFile(tmp_path / "a.sr", "w") as archive:
        archive.writestr("version", "3")
    refused(tmp_path / "a.sr", 'version must be 1 or 2, not "3"')


def test_a_torn_sample_is_refused(tmp_path):
    path = session(tmp_path / "a.sr", b"\0\0\0", metadata(unitsize=2))
    refused(path, "must be a multiple of unitsize, 2, not 3")


@pytest.mark.parametrize("packing", [zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_other_packings_are_refused(tmp_path, packing):
    refused(session(tmp_path / "a.sr", b"\0" * 99, packing=packing), "must be stored or deflated")


def directory_field(path: Path, name: bytes, offset: int, form: str, value: int) -> None:
    """Overwrites one field of the archive's directory entry of `name`."""
    raw = bytearray(path.read_bytes())
    at = raw.rindex(name) - 46
    assert raw[at : at + 4] == b"PK\1\2"
    struct.pack_into(form, raw, at + offset, value)
    path.write_bytes(raw)


@pytest.mark.parametrize(
    ("offset", "form", "value", "reason"),
    [
        (16, "<I", 12345, "Bad CRC-32"),
        (24, "<I", 200, "must inflate to 200 bytes, not 100"),
        (24, "<I", 50, "Bad CRC-32"),
        (8, "<H", 1, "encrypted"),
        (10, "<H", 97, "must be stored or deflated, not packed by method 97"),
        (42, "<I", 1 << 30, "Truncated file header"),
    ],
)
def test_a_lying_directory_is_found_out(tmp_path, offset, form, value, reason):
    path = session(tmp_path / "a.sr", bytes(range(100)))
    directory_field(path, b"logic-1", offset, form, value)
    refused(path, reason)


@pytest.mark.parametrize(
    ("limits", "reason"),
    [
        (Limits(entries=2), "archive entries must be at most 2 (limit entries), not 3"),
        (Limits(ratio=10), "must inflate at most 10 times (limit ratio)"),
        (Limits(inflated_bytes=99_999), "at most 99999 (limit inflated_bytes), not 100000"),
        (Limits(signals=1), "probes must be at most 1 (limit signals), not 2"),
        (Limits(metadata_bytes=20), "bytes must be at most 20 (limit metadata_bytes)"),
        (Limits(transitions=9), "transitions must be at most 9 (limit transitions), not 10"),
        (Limits(file_bytes=100), "bytes must be at most 100 (limit file_bytes)"),
    ],
)
def test_limits_are_kept(tmp_path, limits, reason):
    path = session(tmp_path / "a.sr", bytes(99_990) + b"\1\0" * 5)
    refused(path, reason, limits=limits)


def test_the_default_limits_let_a_silent_capture_pass(tmp_path):
    assert read(session(tmp_path / "a.sr", bytes(50_000_000))).end == 50_000_000


def test_a_huge_directory_is_refused_before_it_is_read(tmp_path):
    path = session(tmp_path / "a.sr", b"\0")
    raw = bytearray(path.read_bytes())
    end = raw.rindex(b"PK\5\6")
    size = 5 << 20
    begin = struct.unpack_from("<I", raw, end + 16)[0]
    struct.pack_into("<I", raw, end + 12, size)
    path.write_bytes(raw[:begin] + bytes(size) + raw[end:])
    refused(path, "the archive's directory must take at most")


@given(st.data())
@settings(deadline=None, max_examples=150)
def test_a_damaged_session_reads_or_is_refused(tmp_path_factory, data):
    path = tmp_path_factory.mktemp("sr") / "a.sr"
    session(path, [bytes(range(200)), b"\1" * 300], metadata())
    path.write_bytes(data.draw(damaged(path.read_bytes())))
    assert_reads_or_is_refused(path)


def test_metadata_of_many_lines_take_linear_time(tmp_path):
    lines = "\n".join(f"key {index}" for index in range(60_000))
    path = session(tmp_path / "a.sr", b"\0", f"[device 1]\n{lines}\n")
    began = time.process_time()
    with pytest.raises(ValueError, match='not "key 0" in line 2'):
        read(path)
    assert time.process_time() - began < 1


def test_metadata_may_hold_comments_and_other_sections(tmp_path):
    about = "# by hand\n[global]\nsigrok version=0.5\n\n; so far\n" + metadata()
    assert list(read(session(tmp_path / "a.sr", b"\0", about)).signals) == ["A", "B"]
