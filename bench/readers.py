"""How fast the files of signals are read, and how much memory the largest of them takes.

A session of 200 million samples at 24 MHz: two quadrature channels of a wheel at 5 kHz, an SPI
clock in bursts, a slow status line, four idle probes; packed in chunks as sigrok packs them. Every
measurement runs in a process of its own, so that its peak memory is its own.
"""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from bench.row import Row, row
from railgate.waves import Trace, Waveform, write_parquet, write_vcd

__all__ = ["run"]

SAMPLES = 200_000_000
CHUNK = 1 << 22
STEPS = 500_000
REPEATS = 5
GOAL_SAMPLES_PER_S = 50e6
GOAL_PEAK_BYTES = float(1 << 30)
METADATA = """[global]
sigrok version=0.5.2

[device 1]
capturefile=logic-1
total probes=8
samplerate=24 MHz
total analog=0
probe1=A
probe2=B
probe3=SCLK
probe4=STATUS
probe5=D4
probe6=D5
probe7=D6
probe8=D7
unitsize=1
"""
CHILD = """
import json, resource, sys, time
from railgate.waves import read
path, channels, repeats = json.load(sys.stdin)
seconds = []
for _ in range(repeats):
    wall, cpu = time.perf_counter(), time.process_time()
    trace = read(path, channels)
    seconds.append([time.perf_counter() - wall, time.process_time() - cpu])
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
print(json.dumps({"seconds": seconds, "peak": peak, "samples": trace.end - trace.start}))
"""


def run() -> list[Row]:
    """One row a figure: name, value, unit, goal (None: informational), met."""
    with tempfile.TemporaryDirectory() as folder:
        session = Path(folder) / "session.sr"
        _write_session(session)
        found = _measure(session, ["A", "B"], REPEATS)
        rate = SAMPLES / statistics.median(cpu for _, cpu in found["seconds"])
        peak = float(found["peak"])
        session_of = "sigrok session of 200 million samples, one core:"
        rows = [
            row(f"{session_of} 2 of 8 channels", rate, "samples/s", least=GOAL_SAMPLES_PER_S),
            row(f"{session_of} peak memory", peak, "B", most=GOAL_PEAK_BYTES),
        ]
        return rows + [_values(Path(folder), kind, write) for kind, write in WRITERS.items()]


def _measure(path: Path, channels: list[str] | None, repeats: int) -> Any:
    done = subprocess.run(
        [sys.executable, "-c", CHILD],
        input=json.dumps([str(path), channels, repeats]),
        capture_output=True,
        text=True,
        check=True,
    )
    return json.loads(done.stdout)


def _write_session(path: Path) -> None:
    """SAMPLES samples of the wheel's quadrature and its neighbours, chunk by chunk."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("version", "2")
        archive.writestr("metadata", METADATA)
        for number, first in enumerate(range(0, SAMPLES, CHUNK), 1):
            at = np.arange(first, min(first + CHUNK, SAMPLES), dtype=np.int64)
            quarter = at * 4 // 4801 & 3  # 4801 samples a period: 5 kHz, off the chunks' grid
            samples = (quarter + 1 >> 1 & 1) | (quarter >> 1) << 1
            samples |= (at % 240_000 < 2_400) * (at // 12 & 1) << 2
            samples |= (at // 6_000_000 & 1) << 3
            archive.writestr(f"logic-1-{number}", samples.astype(np.uint8).tobytes())


def _quadrature() -> Trace:
    """STEPS quarter periods of two channels, with jitter, and their running count."""
    rng = np.random.default_rng(1)
    ticks = np.cumsum(rng.integers(900, 1_100, STEPS))
    count = np.arange(STEPS)
    signals = {
        "wheel.a": Waveform.of(ticks, count + 1 >> 1 & 1),
        "wheel.b": Waveform.of(ticks, count >> 1 & 1),
        "wheel.count": Waveform.of(ticks, count, 32),
    }
    return Trace(signals, Fraction(1, 16_000_000), int(ticks[0]), int(ticks[-1]) + 1)


def _write_csv(path: Path, trace: Trace) -> None:
    ticks = np.unique(np.concatenate([wave.ticks for wave in trace.signals.values()]))
    columns = [wave.at(ticks).tolist() for wave in trace.signals.values()]
    with path.open("w") as file:
        file.write(",".join(["Time [s]", *trace.signals]) + "\n")
        for tick, *values in zip((ticks * 625).tolist(), *columns, strict=True):
            whole, part = divmod(tick, 10**10)  # a tick of 16 MHz is 625 · 10⁻¹⁰ s
            file.write(f"{whole}.{part:010d}," + ",".join(map(str, values)) + "\n")


WRITERS: dict[str, Callable[[Path, Trace], None]] = {
    "vcd": write_vcd,
    "csv": _write_csv,
    "parquet": write_parquet,
}


def _values(folder: Path, kind: str, write: Callable[[Path, Trace], None]) -> Row:
    trace, path = _quadrature(), folder / f"wheel.{kind}"
    write(path, trace)
    found = _measure(path, None, 1)
    values = sum(len(wave) for wave in trace.signals.values())
    wall = found["seconds"][0][0]  # VCD is read by a process of its own: its time counts too
    return row(f"{kind}, values read per second", values / wall, "1/s")


if __name__ == "__main__":
    print(json.dumps(run(), indent=1))
