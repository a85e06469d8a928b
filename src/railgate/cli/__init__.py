"""The command line: parses, calls one function, prints."""

from __future__ import annotations

import sys

import typer
from rich.console import Console

from railgate import doctor as checkup
from railgate.cli import (
    attach,
    build,
    evidence,
    export,
    fpga,
    odometer,
    position_link,
    proofs,
    registers,
    residual,
    unit,
    vital_output,
)

__all__ = ["app", "main"]

app = typer.Typer(no_args_is_help=True, add_completion=False)
simulations = typer.Typer(no_args_is_help=True)
app.command("run")(unit.run_)
app.command("scenarios")(unit.scenarios_)
app.command("measure")(odometer.measure_)
app.command("decode")(position_link.decode_)
app.add_typer(simulations, name="simulate", help="Run a function against its simulated plant.")
simulations.command("odometer")(odometer.simulate_odometer)
simulations.command("link")(position_link.simulate_link)
simulations.command("vital")(vital_output.simulate_vital)
app.command("attach")(attach.attach_)
app.command("build")(build.build_)
app.command("registers")(registers.registers_)
app.command("export")(export.export_)
app.command("residual")(residual.residual_)
app.command("prove")(proofs.prove_)
app.command("evidence")(evidence.evidence_)
placing = typer.Typer(no_args_is_help=True)
app.add_typer(placing, name="fpga", help="Place and route for real FPGAs.")
placing.command("report")(fpga.report_)


@app.callback()
def _railgate() -> None:
    """On-board train functions as open, proven gateware, and a workbench for them."""


@app.command()
def doctor() -> None:
    """What is installed, which engines can run, what is missing and how to get it."""
    raise typer.Exit(checkup.examine(Console()))


def main() -> None:
    """Run the command line; every error a user can provoke is one line and exit code 2."""
    try:
        sys.exit(app(standalone_mode=False) or 0)
    except typer.BadParameter as error:
        _fail(error.format_message())
    except (typer.TyperException, ValueError) as error:
        _fail(str(error))
    except (KeyboardInterrupt, typer.Abort):
        print("railgate: interrupted", file=sys.stderr)
        sys.exit(130)


def _fail(message: str) -> None:
    if message:  # empty after the help that stands for a missing command
        print(f"railgate: {' '.join(message.split())}", file=sys.stderr)
    sys.exit(2)
