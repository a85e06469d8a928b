"""A component behind registered pins."""

from random import Random

import pytest
from amaranth.hdl import Cat, DomainRenamer, Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out
from amaranth.sim import Simulator

from railgate.fpga.gateware import Lfsr, netlist
from railgate.fpga.gateware.pins import Pins

WIDTH = 5


class Through(wiring.Component):
    """Tells without a register what it is fed, in another order."""

    def __init__(self) -> None:
        pair = wiring.Signature({"y": In(2)})
        super().__init__({"x": In(3), "pair": Out(pair), "z": Out(WIDTH)})
        self.count = Signal(8)

    def elaborate(self, _platform):
        m = Module()
        m.d.sync += self.count.eq(self.count + 1)
        m.d.comb += self.z.eq(Cat(self.pair.y, self.x))
        return m


def run(bench) -> None:
    inside = Through()
    top = Pins(inside)
    simulator = Simulator(top)

    async def started(ctx) -> None:
        async def tick() -> None:
            for level in (1, 0):
                ctx.set(top.clk, level)
                await ctx.delay(1e-6)

        await bench(ctx, top, inside, tick)

    simulator.add_testbench(started)
    simulator.run()


def test_each_input_is_fed_and_each_output_is_seen() -> None:
    random = Random(1)
    seen = []

    async def bench(ctx, top, inside, tick) -> None:
        fed, taken, chain = 0, 0, 0
        for _ in range(200):
            bit = random.getrandbits(1)
            told = fed >> 3 | (fed & 7) << 2
            ctx.set(top.shift_in, bit)
            await tick()
            chain, taken = (chain << 1 ^ taken) & (1 << WIDTH) - 1, told
            fed = (fed << 1 | bit) & (1 << WIDTH) - 1
            assert ctx.get(Cat(inside.x, inside.pair.y)) == fed
            assert ctx.get(top.shift_out) == chain >> WIDTH - 1
            seen.append(fed)

    run(bench)
    assert len(set(seen)) == 1 << WIDTH


def test_no_path_leads_through_without_a_register() -> None:
    async def bench(ctx, top, inside, tick) -> None:
        await tick()
        before = ctx.get(inside.x), ctx.get(top.shift_out), ctx.get(inside.count)
        ctx.set(top.shift_in, 1)
        ctx.set(top.rst, 1)
        await ctx.delay(1e-6)
        assert (ctx.get(inside.x), ctx.get(top.shift_out), ctx.get(inside.count)) == before
        await tick()
        assert ctx.get(inside.x) == 1

    run(bench)


def test_the_component_is_reset_two_registers_after_the_pin() -> None:
    async def bench(ctx, top, inside, tick) -> None:
        counts = []
        for reset in (0, 0, 0, 1, 0, 0, 0):
            ctx.set(top.rst, reset)
            await tick()
            counts.append(ctx.get(inside.count))
        assert counts == [1, 2, 3, 4, 5, 0, 1]

    run(bench)


def test_a_netlist_is_the_same_each_time() -> None:
    assert netlist(Lfsr()) == netlist(Lfsr())


def test_a_component_of_another_domain_is_refused() -> None:
    with pytest.raises(ValueError, match="in domain sync alone, not in link too"):
        netlist(DomainRenamer("link")(Lfsr()))
