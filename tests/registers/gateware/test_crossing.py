"""The crossing: every request once, whatever the two clocks; a reset of a side ends nothing."""

import pytest
from amaranth.hdl import ClockDomain, DomainRenamer, Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In

from railgate.registers.gateware import Bank, BusCrossing, address_bits, bus_signature
from registers.gateware.requester import Requester, simulated
from registers.gateware.two_blocks import IDENTITY, TRIGGER, WORDS, block

BLOCK = block("far")
BITS = address_bits(BLOCK.size)
CLOCKS = {
    "alike": (1.0, 1.0),
    "odometer to link": (1 / 16, 1 / 40),
    "link to odometer": (1 / 40, 1 / 16),
    "nearly alike": (1.0, 1.0002),
    "fast to slow": (0.05, 1.0),
    "slow to fast": (1.0, 0.053),
}


class Far(wiring.Component):
    """A bank behind a crossing, from domain near to domain far, whose resets are inputs."""

    def __init__(self):
        super().__init__({"bus": In(bus_signature(BITS)), "near_rst": In(1), "far_rst": In(1)})
        self.bank = Bank(BLOCK)

    def elaborate(self, _platform):
        m = Module()
        for name in ("near", "far"):
            domain = ClockDomain(name)
            m.domains += domain
            m.d.comb += domain.rst.eq(getattr(self, f"{name}_rst"))
        m.submodules.crossing = crossing = BusCrossing(BITS, "near", "far")
        m.submodules.bank = DomainRenamer("far")(self.bank)
        wiring.connect(m, wiring.flipped(self.bus), crossing.bus)
        wiring.connect(m, crossing.served, self.bank.bus)
        return m


def run(far, clocks, *testbenches, background=()):
    domains = dict(zip(("near", "far"), (period * 1e-6 for period in clocks), strict=True))
    simulated(far, *testbenches, background=background, domains=domains)


@pytest.mark.parametrize("clocks", CLOCKS.values(), ids=CLOCKS)
def test_each_request_is_made_once_and_answered_with_its_own_answer(clocks):
    far = Far()
    started = []

    async def asks(ctx):
        bus = Requester(ctx, far.bus, "near")
        for number in range(6):
            for at, offset in enumerate(WORDS):
                await bus.write(offset, number << 8 | at)
            await bus.write(TRIGGER, 1)
            for at, offset in enumerate(WORDS):
                assert await bus.read(offset) == [number << 8 | at]
            assert (await bus.access(TRIGGER)).error
            assert (await bus.access(0, 1)).error
        assert await bus.read(0) == [int.from_bytes(IDENTITY[0], "little")]
        assert len(started) == 6

    async def counts(ctx):
        while True:
            *_, starts = await ctx.tick("far").sample(far.bank.far_starts)
            if starts:
                started.append(starts)

    run(far, clocks, asks, background=[counts])


@pytest.mark.parametrize("side", ["near", "far"])
@pytest.mark.parametrize("clocks", [(1.0, 1.0), (1.0, 0.3), (0.3, 1.0)], ids=str)
def test_after_a_reset_of_either_side_at_any_time_it_serves_on(clocks, side):
    far = Far()

    async def asks(ctx):
        bus = Requester(ctx, far.bus, "near")
        for late in range(1, 16):
            ctx.set(far.bus.request.payload, {"address": 4, "write": 0, "data": 0, "strobes": 0})
            ctx.set(far.bus.request.valid, 1)
            await bus.tick().until(far.bus.request.ready)
            ctx.set(far.bus.request.valid, 0)
            for _ in range(late):
                await ctx.tick("near")
            reset = getattr(far, f"{side}_rst")
            ctx.set(reset, 1)
            await ctx.tick(side)
            await ctx.tick(side)
            ctx.set(reset, 0)
            for _ in range(40):
                await ctx.tick("near")
            assert await bus.read(0) == [int.from_bytes(IDENTITY[0], "little")]
            await bus.write(WORDS[0], late)
            assert await bus.read(WORDS[0]) == [late]

    run(far, clocks, asks)
