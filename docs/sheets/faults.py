"""Single faults: what finds each, and in what time, in runs of the models."""

from __future__ import annotations

import re
from dataclasses import replace
from fractions import Fraction

from railgate.position_link.host import example
from railgate.position_link.plant import FAULTS as LINK_FAULTS
from railgate.position_link.plant import Fault as LinkFault
from railgate.position_link.plant import Scenario as LinkScenario
from railgate.position_link.simulate import simulate as simulate_link
from railgate.vital_output.plant import FAULTS, Command, Fault
from railgate.vital_output.simulate import Run, simulate
from railgate.vital_output.situations import SITUATIONS
from railgate.vital_output.spec import Config
from railgate.vital_output.timeline import Event
from railgate.vital_output.verdict import Closing
from sheets.markdown import table

__all__ = ["found", "found_on_line"]

FINDS = re.compile(
    r".*(rejected|failed|lost|is reset|off its tolerance|not trusted|off by|does not pass|alarm"
    r"|upset|forced to 0|longer than declared|without a live 1)"
)
"""What an FPGA says of something wrong."""
CONFIG = Config(outputs=2)
LEFT_CYCLES = 10
"""Cycles after the command of 0, in which its feedback must be gone."""
LINE_FAULT_S = Fraction(1, 10)
"""When the line's fault comes: in its sixth cycle."""
LINE_CYCLES = 16
SECOND = 1e15
"""Femtoseconds."""


def found(_: str) -> str:
    """A row for each kind of fault of the vital output: what tells of it, when the contact opens.

    Output 0 is on, its contact closed, when the fault comes; long after, it is commanded off.
    """
    whole = SITUATIONS["time-lost"].make(CONFIG)
    start, off = whole.faults[0].start_s, whole.seconds
    ends = replace(
        whole,
        commands=(*whole.commands, Command(start_s=off, image=0)),
        seconds=off + LEFT_CYCLES * CONFIG.cycle_s,
    )
    rows = []
    for kind, told in FAULTS.items():
        if not kind.endswith("-2"):  # as that of the other
            run = simulate(replace(ends, faults=(Fault(kind, start),)), CONFIG)
            rows.append((f"`{kind}`", told.does, *_told(run, float(start), float(off))))
    return table(("fault", "what happens", "found first", "after", "the contact"), rows)


def _told(run: Run, begins: float, off: float) -> tuple[str, str, str]:
    after = [event for event in run.events if event.time_s >= begins and _finds(event)]
    opened = "; ".join(dict.fromkeys(_contact(run, each) for each in run.verdict.closings))
    if not after:
        return "not in this run", "", opened
    first = after[0]
    if first.time_s < off:
        return f"{first.source}: {first.what}", _time(first.time_s - begins), opened
    return (
        f"{first.source}: {first.what}",
        f"{_time(first.time_s - off)} from the next 0 on",
        opened,
    )


def _finds(event: Event) -> bool:
    return event.source.startswith("FPGA") and FINDS.match(event.what) is not None


def _contact(run: Run, each: Closing) -> str:
    """What became of a contact, and whether that is within what is declared."""
    if run.verdict.too_long(each):
        return "**stays closed**"
    if each.lasts:
        return "closed again, as commanded"
    if each.opened_by == "command":
        return "opens when commanded off"
    if each.since_live_s is None:
        return f"closes for {_time((each.opened - each.closed) / SECOND)} without a command"
    return f"opens {_time(float(each.since_live_s))} after the last live 1"


def _time(seconds: float) -> str:
    for unit, scale in (("s", 1.0), ("ms", 1e3), ("µs", 1e6)):
        if seconds * scale >= 1:
            return f"{seconds * scale:.3g} {unit}"
    return "at once"


def found_on_line(_: str) -> str:
    """A row for each kind of fault of the link, in one cycle: its causes, and what was sent."""
    layout = example()
    rows = []
    for kind, told in LINK_FAULTS.items():
        fault = LinkFault(kind, LINE_FAULT_S)
        run = simulate_link(
            LinkScenario(faults=(fault,)), layout.config, LINE_CYCLES, layout=layout
        )
        wrong = [each for each in run.deliveries if each.causes]
        causes = ", ".join(dict.fromkeys(c for each in wrong for c in each.causes)) or "none"
        sent = ", ".join(dict.fromkeys(each.status.name.lower() for each in wrong)) or "fresh"
        rows.append((f"`{kind}`", told.does, causes.replace("_", " "), sent))
    return table(("fault", "what happens", "causes told", "what the radio unit gets"), rows)
