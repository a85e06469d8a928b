"""Judges claims: proof, cover, and every mutant's rejection."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

from railgate.proving.claim import Bounded, Claim, Induction, Mutant, Run, Search
from railgate.proving.mutation import elaborated
from railgate.proving.netlist import netlist
from railgate.proving.replay import fall, inputs, reached, stimulus, told
from railgate.proving.result import Rejection, Result
from railgate.proving.solving import Model, prepare
from railgate.proving.tools import Tools
from railgate.waves import Trace

__all__ = ["prove"]

REFUTE_TICKS = 25
"""How far from reset a counterexample is looked for where an induction does not close."""

CLAIM = "claim"


def prove(
    claims: Sequence[Claim],
    tools: Tools,
    *,
    mutants: bool = False,
    jobs: int = 1,
    done: Callable[[Result], None] | None = None,
) -> list[Result]:
    """Judge the claims, `jobs` at a time, each told to `done` as it ends; in the claims' order.

    mutants: try them too. Whatever a tool cannot answer fails the claim. On an interruption all
    tools that run are ended.
    """
    with ThreadPoolExecutor(jobs) as pool:
        futures = [pool.submit(_Proof(claim, tools).result, mutants) for claim in claims]
        try:
            for future in as_completed(futures):
                result = future.result()
                if done:
                    done(result)
        except BaseException:
            tools.stop()
            pool.shutdown(wait=False, cancel_futures=True)
            raise
        return [future.result() for future in futures]


@dataclass(frozen=True)
class _Proof:
    """One claim's proof. A step without an answer raises ValueError or TimeoutError."""

    claim: Claim
    tools: Tools

    def result(self, mutants: bool) -> Result:
        """Proof, cover and, where asked for, mutants."""
        begun = time.monotonic()
        untried = tuple(Rejection(mutant.name) for mutant in self.claim.mutants)
        result = Result(claim=self.claim, status="failed", reason="", seconds=0.0, mutants=untried)
        try:
            with tempfile.TemporaryDirectory(prefix="railgate-") as folder:
                models = self._models(Path(folder), mutants)
                result = self._proven(result, models[CLAIM])
                if mutants:
                    result = self._tested(result, models)
        except (ValueError, TimeoutError) as error:
            result = replace(result, status="failed", reason=str(error))
        return replace(result, seconds=time.monotonic() - begun)

    def _models(self, folder: Path, mutants: bool) -> dict[str, Model]:
        texts = {CLAIM: netlist(elaborated(self.claim), helped=True)}
        for index, mutant in enumerate(self.claim.mutants if mutants else ()):
            if isinstance(mutant.rejected, Search):
                texts[_name(index)] = netlist(elaborated(self.claim, mutant), helped=False)
        return prepare(self.tools, folder, texts)

    def _proven(self, result: Result, model: Model) -> Result:
        if model.strays and not elaborated(self.claim).domains:
            return replace(result, reason=f"{model.strays} registers are not clocked by clk")
        if not model.asserts or not model.clocked:
            return replace(result, reason="depends on no clocked register: nothing is shown")
        method = self.claim.method
        if found := self._falsified(model, method.depth):
            return self._refuted(result, found)
        if isinstance(method, Induction) and (step := model.inductive(method.k)) is not None:
            with suppress(TimeoutError):
                if found := self._falsified(model, REFUTE_TICKS):
                    return self._refuted(result, found)
            return replace(result, reason=_open(method.k), step=step)
        if not self._covered(model):
            return replace(result, reason="its cover is not reached: nothing is shown")
        if isinstance(method, Bounded):
            return replace(result, status="bounded", reason=method.because)
        return replace(result, status="proven")

    def _falsified(self, model: Model, depth: int) -> Trace | None:
        return model.falsified(depth, inputs(elaborated(self.claim)))

    def _refuted(self, result: Result, found: Trace) -> Result:
        """A solver's counterexample counts once the simulator has shown it too."""
        seen = fall(told(self.claim, None, found, "pysim"))
        if seen is None:
            return replace(result, reason="the solver's counterexample does not fail in pysim")
        shown = None if elaborated(self.claim).domains else found  # no engine makes waves of them
        return replace(result, reason=str(seen), counterexample=shown)

    def _covered(self, model: Model) -> bool:
        cover = self.claim.cover
        if isinstance(cover, Search):
            return model.reached(cover.depth)
        given = stimulus(cover, elaborated(self.claim))
        return reached(told(self.claim, None, given, "cxxrtl"))

    def _tested(self, result: Result, models: dict[str, Model]) -> Result:
        """The result with the mutants tried; one that is not rejected spoils it."""
        found = []
        for index, mutant in enumerate(self.claim.mutants):
            try:
                found.append(self._rejection(mutant, models.get(_name(index))))
            except (ValueError, TimeoutError) as error:
                found.append(Rejection(mutant.name, False, str(error)))
        missed = [each.name for each in found if not each.rejected]
        if missed and not result.failed:
            reason = f"counts as unproven: {', '.join(missed)} not rejected"
            result = replace(result, status="failed", reason=reason)
        return replace(result, mutants=tuple(found))

    def _rejection(self, mutant: Mutant, model: Model | None) -> Rejection:
        """Rejected is a mutant by a stimulus that fails the claim of it but not of the original."""
        self.tools.go_on()
        how = mutant.rejected
        if isinstance(how, Run):
            given, engine = stimulus(how, elaborated(self.claim)), "cxxrtl"
        else:
            assert model is not None
            found, engine = self._falsified(model, how.depth), "pysim"
            if found is None:
                return Rejection(mutant.name, False, f"holds for {how.depth} ticks")
            given = found
        broken = fall(told(self.claim, mutant, given, engine), helped=False)
        if broken is None:
            return Rejection(mutant.name, False, f"holds for {given.end} ticks of {engine}")
        same = given.slice(0, broken.tick + 1)
        if fall(told(self.claim, None, same, engine), helped=False):
            return Rejection(mutant.name, False, "fails without the mutant too")
        return Rejection(mutant.name, True, str(broken))


def _name(index: int) -> str:
    return f"mutant_{index}"


def _open(k: int) -> str:
    return (
        f"the induction does not close at k = {k}, and no counterexample was found in the first "
        f"{REFUTE_TICKS} ticks"
    )
