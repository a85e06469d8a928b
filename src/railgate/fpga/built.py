"""What was built, and what can be, as a person reads it."""

from __future__ import annotations

from typing import Any

from rich.table import Table

from railgate.fpga.boards import BOARDS, board
from railgate.fpga.build import Built
from railgate.fpga.gateware.top import TARGETS

__all__ = ["boards", "show", "show_boards"]


def boards() -> list[dict[str, Any]]:
    """Of each board `board`, `title`, `part`, `fits`, a list of targets, and `loader`."""
    return [
        {
            "board": name,
            "title": each.title,
            "part": each.part,
            "fits": list(each.fits),
            "loader": each.loader,
        }
        for name, each in BOARDS.items()
    ]


def show_boards() -> Table:
    """Which target fits which board."""
    table = Table(header_style="bold")
    for name in ("board", "part", *TARGETS):
        table.add_column(name, no_wrap=True)
    for name, each in BOARDS.items():
        table.add_row(name, each.part, *("fits" if t in each.fits else "-" for t in TARGETS))
    return table


def show(built: Built) -> Table:
    """What a bitstream takes of its part, and how fast it could be."""
    facts = built.facts
    table = Table(show_header=False, box=None, pad_edge=False)
    table.add_row("target", f"{facts['target']} of {facts['unit']}, seed {facts['seed']}")
    table.add_row("board", f"{facts['board']}, {facts['part']}")
    for clock in facts["clocks"]:
        reached = f"{clock['mhz']:g} MHz, reaches {clock['fmax_mhz']:g} MHz"
        table.add_row(f"clock {clock['domain']}", reached)
    for what, told in facts["takes"].items():
        share = f", {told['used'] / told['of']:.0%}" if told["of"] else ""
        table.add_row(what.upper(), f"{told['used']} of {told['of']}{share}")
    table.add_row("SHA-256", facts["sha256"])
    table.add_row("load it by", f"{board(facts['board']).loader} {built.bitstream}")
    return table
