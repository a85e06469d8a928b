"""A requester on the internal bus, in Amaranth's simulator."""

from __future__ import annotations

from typing import Any, NamedTuple

from amaranth.hdl import Const
from amaranth.sim import Simulator

NEVER = 1000
"""Ticks that no answer takes."""


class Answer(NamedTuple):
    """What an access got, and after how many ticks."""

    data: int
    error: int
    ticks: int


class Requester:
    """Makes accesses on a component's `bus`, one after the other."""

    def __init__(self, ctx: Any, bus: Any, domain: str = "sync") -> None:
        self._ctx, self._bus, self._domain = ctx, bus, domain

    def tick(self) -> Any:
        return self._ctx.tick(self._domain)

    async def access(self, address: int, data: int | None = None, strobes: int = 15) -> Answer:
        """A write where there is data; else a read."""
        ctx, request, response = self._ctx, self._bus.request, self._bus.response
        write = data is not None
        asked = {"address": address, "write": write, "data": data or 0, "strobes": strobes * write}
        ctx.set(request.payload, asked)
        ctx.set(request.valid, 1)
        ready = 0
        while not ready:
            *_, ready, answers = await self.tick().sample(request.ready, response.valid)
            assert not answers, "an answer to no request"
        ctx.set(request.valid, 0)
        ticks = 0
        while True:
            ticks += 1
            assert ticks < NEVER, f"no answer to an access to {address:#x}"
            seen = await self.tick().sample(response.valid, response.data, response.error)
            valid, told, error = (int(Const.cast(each).value) for each in seen[-3:])
            if valid:
                return Answer(told, error, ticks)

    async def read(self, address: int, words: int = 1) -> list[int]:
        """These words; none of them may be an error."""
        answers = [await self.access(address + 4 * at) for at in range(words)]
        assert not any(answer.error for answer in answers)
        return [answer.data for answer in answers]

    async def write(self, address: int, data: int, strobes: int = 15) -> None:
        """It may be no error."""
        assert not (await self.access(address, data, strobes)).error


def simulated(component: Any, *testbenches: Any, background: Any = (), domains: Any = ()) -> None:
    """Runs test benches to their end; `domains`: the periods, sync alone by default."""
    simulator = Simulator(component)
    for domain, period in dict(domains or {"sync": 1e-6}).items():
        simulator.add_clock(period, domain=domain)
    for testbench in testbenches:
        simulator.add_testbench(testbench)
    for testbench in background:
        simulator.add_testbench(testbench, background=True)
    simulator.run()
