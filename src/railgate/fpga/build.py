"""From a target to a board's bitstream: netlist, synthesis, place and route, packing.

The same sources, tools, seed and pins give the same bitstream, byte for byte, wherever it is built.
"""

from __future__ import annotations

import importlib.metadata
import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

from amaranth.build import Attrs, Pins, Resource

from railgate.fpga.boards import Pin, board, builtin_pins, read_pins
from railgate.fpga.flow import check_fits, taken
from railgate.fpga.gateware.on_board import OnBoard, clock_nets, resource
from railgate.fpga.gateware.top import Top
from railgate.fpga.parts import Area, Part, part
from railgate.fpga.pll import setting
from railgate.fpga.scratch import scratch
from railgate.fpga.tools import UnplacedError, nextpnr, pack, versions, yosys
from railgate.unit.config import unit_named
from railgate.waves import replacing

__all__ = ["STEPS", "Built", "build", "plan", "reached"]

STEPS = ("netlist", "synthesis", "place and route", "packing")
TOP, PLACED, BITSTREAM = "top", "placed", "bitstream"
MHZ = 1_000_000

SYNTHESIS = """
read_rtlil top.il
{synthesis} -top top
tee -q -o cells.json stat -json
write_json netlist.json
"""


@dataclass(frozen=True)
class Files:
    """What a family's tools call theirs: constraints of Amaranth's plan, nextpnr's option for them
    and for its output, the packer's arguments before output and input, the bitstream's suffix;
    further options of nextpnr."""

    constraints: str
    given: str
    placed: str
    pack: Callable[[str, str], tuple[str, ...]]
    suffix: str
    options: tuple[str, ...] = ()


FILES: Mapping[str, Files] = {
    "ecp5": Files(
        "lpf",
        "--lpf={}",
        "--textcfg",
        lambda i, o: ("--compress", i, o),
        "bit",
        # The default one rips up a whole unit's nets without an end.
        ("--router", "router2"),
    ),
    "ice40": Files("pcf", "--pcf={}", "--asc", lambda i, o: (i, o), "bin"),
    "himbaechel-gowin": Files(
        "cst",
        "--vopt=cst={}",
        "--write",
        lambda i, o: ("-d", "GW1N-9C", "--sspi_as_gpio", "--mspi_as_gpio", "-o", o, i),
        "fs",
    ),
}
"""By nextpnr's name of the architecture."""


@dataclass(frozen=True)
class Built:
    """A bitstream and the facts about it, as the JSON file beside it has them."""

    bitstream: Path
    facts: Mapping[str, Any]

    @property
    def told(self) -> Path:
        """The file of facts."""
        return self.bitstream.with_suffix(".json")


def build(
    target: str,
    on: str,
    *,
    unit: str = "metro",
    seed: int = 1,
    pins: Path | None = None,
    limit_s: float = 1800.0,
    folder: Path = Path("build/boards"),
    begins: Callable[[str], None] = lambda _: None,
) -> Built:
    """Build a target for a board into `folder`; what is there of it before is replaced at the end.

    unit: by name. pins: a file of them; None: the board's own. limit_s: the longest time for one
    call of a tool. begins: called with each of STEPS. Raises UnplacedError where the target is too
    big for the board, misses a clock, or a tool takes too long; ValueError.
    """
    its_unit = unit_named(unit)
    if not 0 <= seed < 1 << 31:
        raise ValueError(f"seed must be between 0 and {(1 << 31) - 1}, not {seed}")
    its_board = board(on)
    its_part = part(its_board.part)
    tools = _versions(its_part.nextpnr)
    begins(STEPS[0])
    top = Top(its_unit, target)
    if len(top.clocks) > its_part.plls:
        raise UnplacedError(
            f"{target} must take at most {its_part.plls} PLL of {its_board.part}, "
            f"not {len(top.clocks)}"
        )
    wired, files = plan(top, on, pins)
    with scratch(folder, "build") as at:
        for name, content in files.items():
            (at / name).write_bytes(content)
        begins(STEPS[1])
        yosys(SYNTHESIS.format(synthesis=its_part.synthesis), at, limit_s)
        area = sum(taken(at / "cells.json", its_part).values(), Area())
        check_fits(target, area, its_board.part)
        begins(STEPS[2])
        fmax_mhz = _place(top, its_part, seed, at, limit_s)
        for domain, mhz in fmax_mhz.items():
            _check_clock(f"{target} on {on}", domain, top.clocks[domain] / MHZ, mhz)
        begins(STEPS[3])
        pack(its_part.nextpnr, FILES[its_part.nextpnr].pack(PLACED, BITSTREAM), at, limit_s)
        bitstream = (at / BITSTREAM).read_bytes()
    facts = {
        "target": target,
        "board": on,
        "part": its_board.part,
        "unit": unit,
        "seed": seed,
        "bitstream": f"{target}-{on}.{FILES[its_part.nextpnr].suffix}",
        "sha256": sha256(bitstream).hexdigest(),
        "clocks": [
            {"domain": domain, "mhz": top.clocks[domain] / MHZ, "fmax_mhz": round(mhz, 2)}
            for domain, mhz in fmax_mhz.items()
        ],
        "takes": {
            what: {"used": used, "of": getattr(its_part.has, what)}
            for what, used in asdict(area).items()
        },
        "configurations": {
            name: f"{config.digest:#010x}" for name, config in top.configurations.items()
        },
        "pins": {".".join(pin.path): list(pin.package) for pin in wired},
        "tools": tools,
    }
    return _keep(folder, bitstream, facts)


def plan(top: Top, on: str, pins: Path | None) -> tuple[tuple[Pin, ...], dict[str, bytes]]:
    """A top's pins on a board, of a file or its own, and what the tools get: netlist, constraints.
    Raises ValueError."""
    its_board = board(on)
    platform, family = its_board.open(), part(its_board.part).nextpnr
    needed = top.signature
    if pins is None:
        wired = builtin_pins(on, needed, platform)
    else:
        wired = read_pins(pins, needed, platform)
    oscillator_hz = int(platform.default_clk_frequency)
    settings = {domain: setting(family, oscillator_hz, hz) for domain, hz in top.clocks.items()}
    platform.add_resources([_resource(pin) for pin in wired])
    design = OnBoard(top, settings, family, pad=its_board.pll_pad)
    made = platform.prepare(design, TOP, emit_src=False).files
    names = f"{TOP}.il", f"{TOP}.{FILES[family].constraints}"
    return wired, {name: _bytes(made[name]) for name in names}


def _place(top: Top, on: Part, seed: int, at: Path, limit_s: float) -> dict[str, float]:
    """Place and route the netlist there; the clock that each domain reaches, MHz."""
    files = FILES[on.nextpnr]
    arguments = (
        *on.options,
        *files.options,
        files.given.format(f"{TOP}.{files.constraints}"),
        *("--json", "netlist.json", files.placed, PLACED, "--report", "report.json"),
        # Of clocks without a constraint of their own. What a clock has missed is told below.
        *("--freq", f"{max(top.clocks.values()) / MHZ:g}", "--timing-allow-fail"),
        *("--seed", str(seed)),
    )
    nextpnr(on.nextpnr, arguments, at, limit_s)
    return reached(json.loads((at / "report.json").read_text("utf-8")), top.clocks)


def _resource(pin: Pin) -> Resource:
    direction = "o" if pin.out else "i"
    pins = Pins(" ".join(pin.package), dir=direction)
    return Resource(resource(pin.path), 0, pins, Attrs(**pin.attributes))


def _bytes(content: str | bytes) -> bytes:
    return content if isinstance(content, bytes) else content.encode()


def _versions(architecture: str) -> dict[str, str]:
    """Of all that has a part in a bitstream. Raises ValueError where a tool is missing."""
    ours = ("amaranth", "amaranth-boards", "railgate")
    return {
        **{name: importlib.metadata.version(name) for name in ours},
        **versions(architecture, packs=True),
    }


def reached(report: Mapping[str, Any], clocks: Mapping[str, int]) -> dict[str, float]:
    """Of each domain its clock in nextpnr's report, MHz. Raises ValueError unless it is held
    against the frequency that the domain needs."""
    nets = {
        net.removeprefix("$glbnet$").removesuffix("_$glb_clk"): told
        for net, told in report["fmax"].items()
    }
    found = {}
    for domain, hz in clocks.items():
        its = [told for net, told in nets.items() if net in clock_nets(domain)]
        if not its or its[0]["constraint"] < hz / MHZ - 0.01:
            told = ", ".join(f"{net} of {each['constraint']:g} MHz" for net, each in nets.items())
            raise ValueError(
                f"nextpnr must place for a clock {' or '.join(clock_nets(domain))} "
                f"of {hz / MHZ:g} MHz, not for {told}"
            )
        found[domain] = float(its[0]["achieved"])
    return found


def _check_clock(what: str, domain: str, wanted: float, mhz: float) -> None:
    if mhz < wanted:
        raise UnplacedError(
            f"{what}: the clock {domain} must reach {wanted:g} MHz, not {mhz:.2f} MHz, "
            f"{1 - mhz / wanted:.1%} less"
        )


def _keep(folder: Path, bitstream: bytes, facts: Mapping[str, Any]) -> Built:
    built = Built(folder / facts["bitstream"], facts)
    text = json.dumps(facts, ensure_ascii=False, indent=1) + "\n"
    with replacing(built.bitstream) as new, replacing(built.told) as told:
        new.write_bytes(bitstream)
        told.write_text(text, encoding="utf-8")
    return built
