from __future__ import annotations
from functools import partial
from amaranth.hdl import Module, Mux, Signal
from railgate.position_link.proofs.stimuli import NOTHING, Answer, answers
from railgate.position_link.proofs.supervised import Supervised
from railgate.position_link.spec import CRC16, EVEN, Config, Status, Cause
from railgate.proving import Claim, Induction, Mutant, Run, Search

class _Fresh(Supervised):
    """FRESH is the word of this cycle's answer, and the cycle has no cause."""

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.link(m)
        fresh = inner["status"] == Status.FRESH
        m.d.comb += [
            self.holds.eq(~fresh | ((self.found == 0) & self.good & (inner["word"] == self.read))),
            self.reached.eq(fresh),
        ]
        return m
G=("position_link.gateware.")
CLAIMS = (
    Claim(
        name="position_link.fresh",
        claim="x",
        requirements=("LNK-1",),
        monitor=partial(_Fresh, Config()),
        method=Induction(),
        cover=Run(820_000, partial(answers, Config(), [Answer(5)], [Answer(6)])),
        mutants=(
            Mutant("a", "railgate.primitives.divider", "remainder >= 0", "remainder > 0", Search(20)),
            Mutant("b", "railgate.position_link.gateware.timing", "if starts", "if", Search(20)),
        ),
    ),
    Claim(
        name="position_link.freshcrc",
        claim="x",
        requirements=("LNK-1",),
        monitor=partial(_Fresh, Config(check=CRC16)),
        method=Induction(),
        cover=Run(820_000, partial(answers, Config(), [Answer(5)], [Answer(6)])),
        mutants=(
            Mutant("a", "railgate.primitives.divider", "remainder >= 0", "remainder > 0", Search(20)),
            Mutant("b", "railgate.position_link.gateware.timing", "if starts", "if", Search(20)),
        ),
    ),
    )
