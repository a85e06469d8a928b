"""Timing diagrams of runs of the models, none of them drawn by hand."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from sheets.markdown import html
from sheets.timing import link, odometer, vital
from sheets.timing.lanes import Diagram, draw

__all__ = ["DIAGRAMS", "timing"]

DIAGRAMS: Mapping[str, Callable[[], Diagram]] = {
    "odometer-periods": odometer.periods,
    "odometer-snapshot": odometer.snapshot,
    "odometer-reversal": odometer.reversal,
    "link-request": link.request,
    "link-cycle": link.cycle,
    "link-faults": link.faults,
    "vital-on-and-off": vital.on_and_off,
    "vital-vote": vital.vote,
    "vital-start": vital.start,
    "vital-cpu-dead": vital.cpu_dead,
}


def timing(name: str) -> str:
    """The diagram of that name, as SVG in the page. Raises ValueError."""
    if name not in DIAGRAMS:
        raise ValueError(f'a diagram must be one of {", ".join(DIAGRAMS)}, not "{name}"')
    diagram = DIAGRAMS[name]()
    return html(f'<figure class="timing">\n{draw(diagram, name)}\n</figure>')
