"""The shape of every claim's monitor: gateware, and what it is held to beside it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["CLAIM", "LEMMA", "Monitor"]

CLAIM = ("holds", "assumed", "reached")
LEMMA = "lemma"


class Monitor(wiring.Component):
    """A component that watches the gateware inside it; plain outputs, so that any engine runs it.

    inputs: name -> shape, in, what the gateware's surroundings are free to do. In domain sync, the
    only one but for `domains`; `rst` is as free as the inputs, and resets the monitor along with
    the gateware.
    holds: out, 1 bit, the claim holds in this tick.
    assumed: out, 1 bit, the inputs are legal in this tick; 1 where it is not driven.
    reached: out, 1 bit, what the claim speaks of happens in this tick.
    lemma.<name>: out, 1 bit, for each of `lemmas`: an invariant that helps the induction,
    proven along with the claim.
    domains: local ones inside it, without a reset, whose clocks are registers of sync: so true
    clocks, with edges where the monitor has them. What they clock takes what was there in the tick
    before the edge; so that a simulator has it likewise, it must not change with the edge.
    """

    def __init__(
        self,
        inputs: Mapping[str, Any],
        lemmas: Iterable[str] = (),
        domains: Iterable[str] = (),
    ) -> None:
        members = {name: In(shape) for name, shape in inputs.items()}
        outputs = {name: Out(1, init=name == "assumed") for name in CLAIM}
        if clash := {*CLAIM, LEMMA, "rst"} & members.keys():
            raise ValueError(f"a monitor's input must not be called {', '.join(sorted(clash))}")
        self.lemmas, self.domains = tuple(lemmas), tuple(domains)
        helping = wiring.Signature({name: Out(1) for name in self.lemmas})
        nested = {LEMMA: Out(helping)} if self.lemmas else {}
        super().__init__({**members, **outputs, **nested})
