"""The command that builds bitstreams."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from railgate.cli.options import limit_s
from railgate.cli.output import present

__all__ = ["build_"]


def build_(
    target: Annotated[
        str | None,
        typer.Argument(help="odometer, position_link, vital_output, fpga_1, fpga_2."),
    ] = None,
    board: Annotated[
        str | None,
        typer.Option(help="ulx3s-25f, ulx3s-85f, hx8k, icebreaker, tang-nano-9k."),
    ] = None,
    seed: Annotated[int, typer.Option(help="Of the placement.")] = 1,
    unit: Annotated[str, typer.Option(help="Whose: metro, maglev.")] = "metro",
    pins: Annotated[
        Path | None, typer.Option(help="Which pin is what, a TOML file; None: the board's own.")
    ] = None,
    limit: Annotated[str, typer.Option(help="The longest time for one tool.")] = "1800s",
    list: Annotated[
        bool, typer.Option("--list", help="Only tell which target fits which board.")
    ] = False,
    json: Annotated[bool, typer.Option("--json", help="Print JSON and nothing else.")] = False,
    out: Annotated[Path, typer.Option(help="Write the bitstream and its facts there.")] = Path(
        "build/boards"
    ),
) -> None:
    """Build a bitstream for a board: a function alone or a whole FPGA, with the UART bridge."""
    # Here, since no other command needs all gateware.
    from railgate.fpga.build import build
    from railgate.fpga.built import boards, show, show_boards
    from railgate.fpga.tools import UnplacedError

    if list:
        present(boards() if json else show_boards(), [])
        return
    if target is None or board is None:
        raise ValueError("TARGET and --board must be given, or --list")
    seconds = limit_s(limit)
    console = Console(stderr=True)
    try:
        with _status(console, f"{target} for {board}") as begins:
            built = build(
                target,
                board,
                unit=unit,
                seed=seed,
                pins=pins,
                limit_s=seconds,
                folder=out,
                begins=begins,
            )
    except UnplacedError as error:
        console.print(f"railgate: {error}", soft_wrap=True, markup=False, highlight=False)
        raise typer.Exit(1) from None
    present(dict(built.facts) if json else show(built), [built.bitstream, built.told])


@contextmanager
def _status(console: Console, what: str) -> Iterator[Callable[[str], None]]:
    """A line on the terminal that tells the step that is under way."""
    with console.status(what) as status:
        yield lambda step: status.update(f"{what}: {step}")
