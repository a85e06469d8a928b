"""The vital output's commands."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import typer

from railgate import quantity
from railgate.cli.options import finite, option, whole_hz, with_setup
from railgate.cli.output import present, running
from railgate.engines import ENGINES
from railgate.vital_output.plant.cpu import Command
from railgate.vital_output.plant.faults import FAULTS
from railgate.vital_output.plant.faults import fault as parse_fault
from railgate.vital_output.plant.relay import RelayTimes
from railgate.vital_output.plant.scenario import Scenario
from railgate.vital_output.simulate import Run, simulate
from railgate.vital_output.situations import SITUATIONS, on_and_off
from railgate.vital_output.spec import Config
from railgate.vital_output.table import show, show_situations

__all__ = ["Pair", "simulate_vital"]

COMMAND = re.compile(r"\s*(0x[0-9a-fA-F]+|\d+)(?::(0x[0-9a-fA-F]+|\d+))?@(.*)", re.ASCII)


@dataclass(frozen=True)
class Pair:
    """Two channels and the relays, the engine and where the result goes, as the user gave them."""

    clock: Annotated[str, option("Reference clock of each FPGA.")] = "16MHz"
    outputs: Annotated[int, option("Outputs, each with a relay.")] = 16
    cycle: Annotated[str, option("System cycle: from command frame to command frame.")] = "50ms"
    margin: Annotated[str, option("So far frames and time may be off a cycle.")] = "1ms"
    slew: Annotated[int, option("Ticks by which a cycle may be longer or shorter.")] = 400
    holdover: Annotated[int, option("Cycles that time is trusted without an update.")] = 100
    tau0: Annotated[str, option("The other CPU's frame comes within this.")] = "5ms"
    tau1: Annotated[str, option("The peer is about to drive within this.")] = "5ms"
    life: Annotated[int, option("Cycles that a command lives on without a new one.")] = 3
    pulse: Annotated[str, option("Frequency of the pulse trains.")] = "1kHz"
    pick_up: Annotated[str, option("A contact has closed within this, else alarm.")] = "50ms"
    release: Annotated[str, option("A contact has opened within this, else alarm.")] = "50ms"
    release_min: Annotated[str, option("No contact opens in less than this.")] = "3ms"
    relay_pick_up: Annotated[str, option("What the simulated relays take to close.")] = "30ms"
    relay_release: Annotated[str, option("What the simulated relays take to open.")] = "20ms"
    error_interval: Annotated[
        str | None, option("Two rejected frames within this latch all outputs off.")
    ] = None
    zero_at_once: Annotated[
        bool, option("A valid 0 of either CPU is obeyed at once.", "--zero-at-once")
    ] = False
    engine: Annotated[
        str, option(f"{', '.join(ENGINES)}: leap is the model, the others the gateware.")
    ] = "leap"
    json: Annotated[bool, option("Print one JSON object and nothing else.", "--json")] = False
    out: Annotated[Path | None, option("Write tables, waves and pictures there.")] = None

    def config(self) -> Config:
        """Both channels' configuration. Raises ValueError."""
        latched = self.error_interval
        return Config(
            clock_hz=whole_hz("--clock", self.clock),
            outputs=self.outputs,
            cycle_s=quantity.time_s(self.cycle),
            margin_s=quantity.time_s(self.margin),
            slew_ticks=self.slew,
            holdover_cycles=self.holdover,
            tau0_s=quantity.time_s(self.tau0),
            tau1_s=quantity.time_s(self.tau1),
            life_cycles=self.life,
            pulse_hz=whole_hz("--pulse", self.pulse),
            pick_up_s=quantity.time_s(self.pick_up),
            release_s=quantity.time_s(self.release),
            release_min_s=quantity.time_s(self.release_min),
            error_interval_s=None if latched is None else quantity.time_s(latched),
            zero_at_once=self.zero_at_once,
        )

    def relay(self) -> RelayTimes:
        """The relays that are simulated. Raises ValueError."""
        return RelayTimes(
            pick_up_s=quantity.time_s(self.relay_pick_up),
            release_s=quantity.time_s(self.relay_release),
        )


@with_setup
def simulate_vital(
    situation: Annotated[
        str, typer.Option(help=f"{', '.join(SITUATIONS)}; list: what happens in each.")
    ] = "good",
    fault: Annotated[
        list[str] | None,
        typer.Option(
            help="KIND[:VALUE]@TIME or @T0..T1, again for each fault, of these: "
            f"{', '.join(FAULTS)}."
        ),
    ] = None,
    command: Annotated[
        list[str] | None,
        typer.Option(
            help="IMAGE[:ACKNOWLEDGE]@TIME, as 0x1@300ms, again for each change; "
            "None: the situation's."
        ),
    ] = None,
    test: Annotated[
        list[str] | None,
        typer.Option(help="When the shut-off paths are to be tested, again for each time."),
    ] = None,
    seconds: Annotated[
        str | None, typer.Option(help="Length of the run; None: the situation's.")
    ] = None,
    ppm_1: Annotated[
        float | None, typer.Option(help="Offset of FPGA 1's clock, ppm; None: the situation's.")
    ] = None,
    ppm_2: Annotated[
        float | None, typer.Option(help="Offset of FPGA 2's clock, ppm; None: the situation's.")
    ] = None,
    seed: Annotated[int, typer.Option(help="Of all that is random.")] = 0,
    waves: Annotated[
        str | None,
        typer.Option(help="T0..T1: the waves are of this part, pulses and cross-link too."),
    ] = None,
    *,
    setup: Pair,
) -> None:
    """Both channels of a vital output against simulated CPUs and relays: what happens, and when."""
    if situation == "list":
        present(
            {name: each.does for name, each in SITUATIONS.items()}
            if setup.json
            else show_situations(),
            [],
        )
        return
    config = setup.config()
    scenario = _situation(situation, config, seconds)
    scenario = replace(
        scenario,
        commands=_commands(command, config) if command else scenario.commands,
        ppm_1=scenario.ppm_1 if ppm_1 is None else finite("--ppm-1", ppm_1),
        ppm_2=scenario.ppm_2 if ppm_2 is None else finite("--ppm-2", ppm_2),
        relay=setup.relay(),
        tests_s=tuple(sorted(quantity.time_s(time) for time in test or ())),
        faults=(*scenario.faults, *(parse_fault(text) for text in fault or ())),
        seed=seed,
    )
    span = None if waves is None else quantity.span_s(waves)
    with running(setup.engine) as progress:
        run = simulate(scenario, config, setup.engine, progress, span)
    _present(run, setup)
    raise typer.Exit(int(bool(run.verdict.violations)))


def _situation(name: str, config: Config, seconds: str | None) -> Scenario:
    """The scenario, of another length where one is given. Raises ValueError."""
    if name not in SITUATIONS:
        raise ValueError(f'a situation must be one of {", ".join(SITUATIONS)}, not "{name}"')
    scenario = SITUATIONS[name].make(config)
    if seconds is None:
        return scenario
    length = quantity.time_s(seconds)
    commands = on_and_off(config, length) if name == "good" else scenario.commands
    return replace(scenario, seconds=length, commands=commands)


def _commands(texts: Sequence[str], config: Config) -> tuple[Command, ...]:
    """What is commanded from when on. Raises ValueError."""
    most = (1 << config.outputs) - 1
    found = []
    for text in texts:
        parts = COMMAND.fullmatch(text)
        if not parts:
            raise ValueError(
                f"--command must be IMAGE[:ACKNOWLEDGE]@TIME, as 0x1@300ms, not {text!r}"
            )
        image, acknowledge = (int(digits, 0) for digits in (parts[1], parts[2] or "0"))
        if max(image, acknowledge) > most:
            raise ValueError(
                f"--command must be at most {most:#x} with {config.outputs} outputs, not {text!r}"
            )
        start = quantity.time_s(parts[3])
        found.append(Command(start_s=start, image=image, acknowledge=acknowledge))
    return tuple(sorted(found, key=lambda each: each.start_s))


def _present(run: Run, setup: Pair) -> None:
    paths = []
    if setup.out:
        from railgate.vital_output.record import record  # matplotlib doubles the time to start

        paths = record(run, setup.out)
    present(run.as_json() if setup.json else show(run), paths)
