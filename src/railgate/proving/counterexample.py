"""A stimulus that fails a claim: with all that happens inside, as waves, and run again."""

from __future__ import annotations

from pathlib import Path

from amaranth.hdl import Module, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.engines import Design
from railgate.engines.pysim import PySim
from railgate.proving.claim import Claim
from railgate.proving.internals import Internals
from railgate.proving.monitor import Monitor
from railgate.proving.mutation import elaborated
from railgate.proving.replay import CLOCK, Fall, fall, inputs, told
from railgate.waves import Trace, read
from railgate.waves.waveform import MAX_WIDTH

__all__ = ["replay", "waves"]


def waves(claim: Claim, stimulus: Trace) -> Trace:
    """The stimulus, the monitor's outputs, and every signal inside it, by its path."""
    shown = _Shown(elaborated(claim))
    design = Design(name=claim.name, component=lambda: shown, clocks=(CLOCK,))
    return stimulus.merge(PySim(design).advance(stimulus.end, stimulus).rename(shown.paths))


def replay(claim: Claim, path: Path) -> Fall | None:
    """Run the claim's monitor from reset in pysim, driven by a file's signals named as its inputs.

    Raises ValueError where the file lacks an input or was not recorded in ticks of a claim.
    """
    names = [port.name for port in inputs(elaborated(claim))]
    return fall(told(claim, None, read(path, names), "pysim"))


class _Shown(wiring.Component):
    """A monitor of which all that is named inside is an output; `paths` tells which is what."""

    def __init__(self, monitor: Monitor) -> None:
        self._monitor, self._inner = monitor, Internals(monitor)
        ports = {".".join(map(str, path)) for path, _, _ in monitor.signature.flatten(monitor)}
        values = {path: Value.cast(self._inner[path]) for path in self._inner.names}
        shown = [path for path in values.keys() - ports if 1 <= len(values[path]) <= MAX_WIDTH]
        self.paths = {f"inner_{index}": path for index, path in enumerate(sorted(shown))}
        self._values = values
        inner = {name: Out(values[path].shape()) for name, path in self.paths.items()}
        super().__init__({**monitor.signature.members, **inner})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        m.submodules.monitor = self._inner
        for path, member, inside in self._monitor.signature.flatten(self._monitor):
            outside = self
            for part in path:
                outside = outside[part] if isinstance(part, int) else getattr(outside, part)
            to, of = (inside, outside) if member.flow == In else (outside, inside)
            m.d.comb += Value.cast(to).eq(of)
        m.d.comb += [
            getattr(self, name).eq(self._values[path]) for name, path in self.paths.items()
        ]
        return m
