"""Questions to a solver about netlists: can it fail, does it stay true, can it be reached."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from railgate.engines.border import flat
from railgate.engines.signals import Port
from railgate.proving.claim import TICK
from railgate.proving.tools import Tools
from railgate.waves import Trace, Waveform

__all__ = ["Model", "prepare"]

# The passes that sby runs before its engine smtbmc; one call serves all netlists of a claim.
_PASSES = """
read_rtlil {name}.il
hierarchy -top top
proc
flatten
opt_clean
select -set registers t:$*dff* t:$memwr* t:$memrd* r:CLK_ENABLE=1 %i %u %u
tee -q -o {name}.strays select -count @registers i:clk %co1:+[CLK] %d
prep -top top
scc -select; simplemap; select -clear
memory_nordff
select -set others t:$*dff* i:clk %co1:+[CLK] %d
clk2fflogic @others
async2sync
chformal -assume -early
opt_clean
tee -q -o {name}.clocked select -count w:holds %ci* i:clk %co1:+[CLK] %i t:$*dff* %i
formalff -setundef -clk2ff -ff2anyinit
chformal -live -fair -remove
opt_clean
check -assert
setundef -undriven -anyseq
opt -fast
tee -q -o {name}.asserts select -count t:$assert
rename -witness
opt_clean
formalff -assume
dffunmap
write_smt2 -wires {name}.smt2
chformal -assert -remove
opt_clean
write_smt2 -wires {name}_cover.smt2
design -reset
"""

_STATUS = re.compile(r"Status: (\w+)\s*$")


@dataclass(frozen=True)
class Model:
    """A netlist made ready for the solver.

    clocked: registers on which `holds` depends. strays: registers, and ports of memories, that
    clk does not clock; they take their edges where their own clock has them, which must not depend
    on clk. asserts: what is left to assert.
    """

    tools: Tools
    folder: Path
    name: str
    clocked: int
    strays: int
    asserts: int

    def falsified(self, depth: int, inputs: Sequence[Port]) -> Trace | None:
        """A stimulus from reset that fails an assertion in the first `depth` ticks, if any does."""
        told = ["--presat", "-t", str(depth), "--dump-yw", f"{self.name}.yw"]
        if self._passed([*told, f"{self.name}.smt2"]):
            return None
        return _stimulus(self.folder / f"{self.name}.yw", inputs)

    def inductive(self, k: int) -> str | None:
        """None where k ticks without a failed assertion are always followed by another, else the
        VCD of ticks that are not."""
        vcd = self.folder / f"{self.name}_step.vcd"
        if self._passed(["-i", "-t", str(k), "--dump-vcd", vcd.name, f"{self.name}.smt2"]):
            return None
        return vcd.read_text(encoding="utf-8")

    def reached(self, depth: int) -> bool:
        """Whether the cover is reached from reset in the first `depth` ticks."""
        return self._passed(["-c", "-t", str(depth), f"{self.name}_cover.smt2"])

    def _passed(self, arguments: list[str]) -> bool:
        """Raises ValueError for every end but a passed or a failed check."""
        code, said = self.tools.smtbmc(arguments, self.folder)
        last = said.strip().splitlines()[-1:] or [""]
        status = found[1] if (found := _STATUS.search(last[0])) else ""
        if status == "PREUNSAT":
            raise ValueError("no stimulus keeps to what is assumed")
        if (code, status) not in ((0, "PASSED"), (1, "FAILED")):
            raise ValueError(f"{self.tools.solver} ended with code {code}: {last[0] or 'no word'}")
        return status == "PASSED"


def prepare(tools: Tools, folder: Path, netlists: Mapping[str, str]) -> dict[str, Model]:
    """A model for each netlist by name. Raises ValueError."""
    for name, text in netlists.items():
        (folder / f"{name}.il").write_text(text, encoding="utf-8")
    tools.yosys("".join(_PASSES.format(name=name) for name in netlists), folder)
    return {
        name: Model(
            tools,
            folder,
            name,
            *(_count(folder / f"{name}.{what}") for what in ("clocked", "strays", "asserts")),
        )
        for name in netlists
    }


def _count(path: Path) -> int:
    """What `select -count` said. Raises ValueError."""
    said = path.read_text(encoding="utf-8") if path.exists() else ""
    found = re.search(r"^(\d+) objects\.$", said, re.MULTILINE)
    if not found:
        raise ValueError(f"Yosys must tell the number of {path.suffix[1:]}, not {said!r}")
    return int(found[1])


def _stimulus(witness: Path, inputs: Sequence[Port]) -> Trace:
    """The values of the inputs in each tick of a Yosys witness; those it does not name are 0."""
    told = json.loads(witness.read_text(encoding="utf-8"))
    steps = [re.sub("[^01]", "0", step["bits"]) for step in told["steps"]]  # x: any value
    place, places = 0, {}
    for signal in told["signals"]:
        if signal["offset"]:
            raise ValueError(f"a witness must tell whole signals, not a part of {signal['path']}")
        places[".".join(signal["path"])] = place, signal["width"]
        place += signal["width"]
    waves = {}
    for port in inputs:
        first, width = places.get("\\" + flat(port.path), (0, 0))
        values = [
            int(bits[len(bits) - first - width : len(bits) - first] or "0", 2) for bits in steps
        ]
        if port.signed:
            values = [value - (value >> port.width - 1 << port.width) for value in values]
        waves[port.name] = Waveform.of(range(len(steps)), values, port.width, port.signed)
    return Trace(waves, TICK, 0, len(steps))
