"""One way in for every file of signals.

A reader of one format has the same contract as `read` and may leave it by any exception that its
library throws: `read` makes one ValueError of it. The formats are imported when they are needed,
since their libraries take longer to load than a small capture takes to read.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from railgate.waves.limits import Limits
from railgate.waves.trace import Trace

__all__ = ["read"]

Reader = Callable[[Path, Sequence[str] | None, Limits], Trace]

SUFFIXES = {
    ".sr": "sigrok",
    ".vcd": "vcd",
    ".fst": "fst",
    ".csv": "csv",
    ".parquet": "parquet",
    ".pq": "parquet",
}


def read(
    path: str | Path, channels: Sequence[str] | None = None, limits: Limits | None = None
) -> Trace:
    """The signals of a sigrok session, VCD, FST, CSV or Parquet file.

    path: its content tells the format, its suffix where the content leaves it open.
    channels: the names wanted, in that order; None: all that fit a Waveform.
    Raises ValueError, in one line, for whatever is wrong with the file or the names.
    """
    path = Path(path)
    limits = limits or Limits()
    if channels is not None and len(set(channels)) < len(channels):
        raise ValueError(f"each channel may be wanted once, not {', '.join(channels)}")
    try:
        if not path.is_file():
            raise ValueError("no such file")
        limits.check("file_bytes", path.stat().st_size, "the file's size in bytes")
        return _reader(_format(path))(path, channels, limits)
    except Exception as error:  # the formats' libraries throw errors of many kinds
        reason = (" ".join(str(error).split()) or type(error).__name__)[:500]
        # Names in a file may hold a terminal's control sequences.
        reason = "".join(c if c.isprintable() else "?" for c in reason)
        raise ValueError(f"{path}: {reason}") from error


def _format(path: Path) -> str:
    with path.open("rb") as file:
        head = file.read(4096)
    if head.startswith(b"PK"):
        return "sigrok"
    if head.startswith(b"PAR1"):
        return "parquet"
    if head[:1] == b"\0" and head[1:9] == (329).to_bytes(8, "big"):  # an FST header block
        return "fst"
    if head.lstrip().startswith(b"$"):
        return "vcd"
    if (suffix := path.suffix.lower()) in SUFFIXES:
        return SUFFIXES[suffix]
    raise ValueError(
        f"the file must be a sigrok session (.sr), VCD, FST, CSV or Parquet file, "
        f'not "{path.suffix}" of unknown content'
    )


def _reader(name: str) -> Reader:
    if name == "sigrok":
        from railgate.waves.sigrok import read_sigrok as reader
    elif name == "csv":
        from railgate.waves.csv import read_csv as reader
    elif name == "parquet":
        from railgate.waves.parquet import read_parquet as reader
    else:
        from railgate.waves.wellen import read_wellen as reader
    return reader
