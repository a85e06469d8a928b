"""The peers do what they are held against for."""

import sys
from random import Random
from zlib import crc32

import pytest
from amaranth.hdl import Shape
from amaranth.sim import Simulator

from railgate.fpga.gateware import Counter, Crc32, Lfsr, LiteEthMac, Ssi
from railgate.fpga.gateware.mac import MODULE, _converted, verilog
from railgate.fpga.report import report
from railgate.fpga.targets import chosen


def run(component, bench) -> None:
    simulator = Simulator(component)
    simulator.add_clock(1e-6)
    simulator.add_testbench(bench)
    simulator.run()


def test_the_ceiling_never_rests() -> None:
    lfsr = Lfsr()
    states = []

    async def bench(ctx) -> None:
        for _ in range(2000):
            states.append(ctx.get(lfsr.state))
            await ctx.tick()

    run(lfsr, bench)
    assert len(set(states)) == 2000
    assert 0 not in states


def test_the_counter_counts_four_steps_a_period_both_ways() -> None:
    counter = Counter()

    async def bench(ctx) -> None:
        async def turn(steps, at: int) -> int:
            for a, b in steps:
                ctx.set(counter.a, a)
                ctx.set(counter.b, b)
                await ctx.tick().repeat(at)
            ctx.set(counter.strobe, 1)
            await ctx.tick().repeat(4)
            ctx.set(counter.strobe, 0)
            return ctx.get(counter.position)

        period = [(1, 0), (1, 1), (0, 1), (0, 0)]
        assert await turn(period * 3, 10) == 12
        assert ctx.get(counter.period) == 40
        assert await turn([(0, 1), (1, 1), (1, 0), (0, 0)] * 3, 10) == 0

    run(counter, bench)


def test_the_ssi_reader_reads_a_word() -> None:
    reader, word = Ssi(), 0x155_A5C3

    async def bench(ctx) -> None:
        ctx.set(reader.start, 1)
        await ctx.tick()
        ctx.set(reader.start, 0)
        bits, before = iter(f"{word:025b}"), 1
        while not ctx.get(reader.done):
            clock = ctx.get(reader.clock)
            if before and not clock:
                ctx.set(reader.data, int(next(bits)))
            before = clock
            await ctx.tick()
        assert ctx.get(reader.word) == word
        assert ctx.get(reader.clock) == 1

    run(reader, bench)


def test_the_crc_is_that_of_zlib() -> None:
    crc, message = Crc32(), Random(2).randbytes(40)

    async def bench(ctx) -> None:
        ctx.set(crc.start, 1)
        await ctx.tick()
        ctx.set(crc.start, 0)
        ctx.set(crc.valid, 1)
        for byte in message:
            ctx.set(crc.byte, byte)
            await ctx.tick()
        assert ctx.get(crc.crc) == crc32(message)

    run(crc, bench)


def test_liteeths_mac_has_four_streams_and_no_clock_among_its_members() -> None:
    members = LiteEthMac().signature.members
    streams = {name.partition("_")[0] for name in members}
    assert streams == {"sink", "source"}
    assert sum(Shape.cast(member.shape).width == 8 for member in members.values()) == 4
    assert f"module {MODULE}(" in verilog()


def test_without_liteeth_its_figures_alone_are_missing(monkeypatch, tmp_path) -> None:
    monkeypatch.setitem(sys.modules, "liteeth.common", None)
    _converted.cache_clear()
    with pytest.raises(ValueError, match=r"^liteeth is needed: pip install liteeth$"):
        LiteEthMac()
    (row,) = report(chosen(["liteeth"]), folder=tmp_path)
    assert (row.failed, row.area) == ("liteeth is needed: pip install liteeth", None)
