"""What hypothesis draws for several formats: signals, and damage to a file."""

from pathlib import Path

from hypothesis import strategies as st

from railgate.waves import Trace, Waveform, read


@st.composite
def signals(draw: st.DrawFn, names: list[str], start: int, end: int) -> dict[str, Waveform]:
    """Any waves of these names over start ≤ tick < end: widths, signs, extremes."""
    drawn = {}
    for name in names:
        width, signed = draw(st.integers(1, 64)), draw(st.booleans())
        low, high = (-(1 << width - 1), (1 << width - 1) - 1) if signed else (0, (1 << width) - 1)
        later = (
            draw(st.sets(st.integers(start + 1, end - 1), max_size=5)) if end > start + 1 else []
        )
        ticks = [start, *sorted(later)]
        values = [
            draw(st.one_of(st.sampled_from([low, high]), st.integers(low, high))) for _ in ticks
        ]
        drawn[name] = Waveform.of(ticks, values, width, signed)
    return drawn


@st.composite
def damaged(draw: st.DrawFn, sound: bytes) -> bytes:
    """The content of a file cut short, or with a few other bytes in it."""
    raw = bytearray(sound)
    if draw(st.booleans()):
        return bytes(raw[: draw(st.integers(0, len(raw) - 1))])
    for _ in range(draw(st.integers(1, 4))):
        raw[draw(st.integers(0, len(raw) - 1))] = draw(st.integers(0, 255))
    return bytes(raw)


def assert_reads_or_is_refused(path: Path) -> None:
    """A trace, or a ValueError of one line; nothing else."""
    try:
        trace, message = read(path), ""
    except ValueError as error:
        trace, message = None, str(error)
    assert isinstance(trace, Trace) or "\n" not in message
