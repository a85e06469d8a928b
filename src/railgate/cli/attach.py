"""The command that looks at a board."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext, suppress
from fractions import Fraction
from itertools import islice
from json import dumps
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console
from rich.live import Live as Screen

from railgate import quantity
from railgate.cli.output import present

if TYPE_CHECKING:
    from railgate.attach import Live

__all__ = ["attach_"]

SIMULATION = "sim:"

Reading = list[dict[str, Any]]


def attach_(
    port: Annotated[
        str,
        typer.Argument(help="A serial port, as /dev/ttyUSB0, or sim:, or sim: and a scenario."),
    ],
    baud: Annotated[int, typer.Option(min=1, help="Bits a second on a serial port.")] = 115_200,
    unit: Annotated[
        str, typer.Option(help="What the board is configured as: metro, maglev.")
    ] = "metro",
    every: Annotated[str, typer.Option(help="Time from reading to reading.")] = "200ms",
    skip: Annotated[str, typer.Option(help="So much of a scenario is not shown.")] = "0s",
    once: Annotated[bool, typer.Option("--once", help="One reading, then end.")] = False,
    json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object a reading and nothing else.")
    ] = False,
) -> None:
    """Live values of a board, or of a simulated FPGA 1, until ctrl-C."""
    # Here, since no other command needs them.
    from railgate.attach import readings

    every_s, skip_s = quantity.time_s(every), quantity.time_s(skip)
    told = 0
    with suppress(KeyboardInterrupt), _failing_in_one_line(port):
        with _opened(port, baud, unit, skip_s, paced=not once) as live, _printer(json) as print_one:
            for reading in islice(readings(live, every_s), 1 if once else None):
                print_one(reading)
                told += 1
        if not told:
            raise ValueError(f"{port} must go on for {every}, for a reading")


def _opened(
    port: str, baud: int, unit: str, skip_s: Fraction, *, paced: bool
) -> AbstractContextManager[Live]:
    from railgate.attach import on_port, on_simulation

    if not port.startswith(SIMULATION):
        return on_port(port, baud, unit)
    scenario = port.removeprefix(SIMULATION) or unit
    return nullcontext(on_simulation(scenario, skip_s, paced=paced))


@contextmanager
def _printer(as_json: bool) -> Iterator[Callable[[Reading], None]]:
    """What shows a reading: in place on a terminal, else one after the other."""
    from railgate.attach import show

    console = Console()
    if as_json:
        yield lambda reading: print(dumps({"functions": reading}, allow_nan=False), flush=True)
    elif console.is_terminal:
        with Screen(console=console, auto_refresh=False) as screen:
            yield lambda reading: screen.update(show(reading), refresh=True)
    else:
        yield lambda reading: present(show(reading), [])


@contextmanager
def _failing_in_one_line(port: str) -> Iterator[None]:
    from railgate.registers.host import BusError

    try:
        yield
    except BusError as error:
        raise ValueError(f"{port}: {error}") from None
