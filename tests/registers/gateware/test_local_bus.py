"""The bridge from a processor's local bus: by a processor that keeps its timing and no more."""

import gc
import random

import pytest
from amaranth.hdl import Module
from amaranth.lib import wiring

from railgate.registers.gateware import Bank, LocalBus, address_bits
from registers.gateware.requester import simulated
from registers.gateware.two_blocks import IDENTITY, SEEN, TRIGGER, WORDS, block

BLOCK = block("local")
TICK = 1e-6
BANK_TICKS = 3
LATEST_TICKS = 6 + BANK_TICKS
RELEASED_TICKS = 3
NEVER = 100


class Board(wiring.Component):
    """A bank on a local bus; `pins` are the bridge's own."""

    def __init__(self, data_bits):
        self.pins = LocalBus(address_bits(BLOCK.size), data_bits)
        self.bank = Bank(BLOCK)
        super().__init__({})

    def elaborate(self, _platform):
        m = Module()
        m.submodules.bridge = self.pins
        m.submodules.bank = self.bank
        wiring.connect(m, self.pins.bus, self.bank.bus)
        return m


class Processor:
    """Makes accesses with edges anywhere between two ticks, every lane a little apart."""

    def __init__(self, ctx, pins, data_bits):
        self._ctx, self._pins, self._bits = ctx, pins, data_bits
        self.ticks = []

    async def wait(self, ticks):
        await self._ctx.delay(ticks * TICK)

    async def access(self, address, data=None, lanes=None):
        """Data and error of one access of the bus's width."""
        ctx, pins = self._ctx, self._pins
        await self.wait(random.random())
        ctx.set(pins.address, address)
        ctx.set(pins.cs_n, 0)
        await self.wait(random.random())
        if data is None:
            ctx.set(pins.oe_n, 0)
        else:
            ctx.set(pins.data_in, data)
            for lane in range(self._bits // 8):
                if lanes is None or lanes >> lane & 1:
                    ctx.set(pins.we_n[lane], 0)
                    await self.wait(0.9 / (self._bits // 8) * random.random())
        ticks = 0.0
        while ctx.get(pins.ready_n):
            await self.wait(0.1)
            ticks += 0.1
            assert ticks < NEVER
        self.ticks.append(ticks)
        assert ctx.get(pins.data_oe) == (data is None)
        told = ctx.get(pins.data_out), 1 - ctx.get(pins.error_n)
        ctx.set(pins.oe_n, 1)
        ctx.set(pins.we_n, ~0)
        assert not ctx.get(pins.data_oe)
        ctx.set(pins.cs_n, 1)
        ctx.set(pins.data_in, random.getrandbits(self._bits))
        ctx.set(pins.address, random.getrandbits(5))
        await self.wait(RELEASED_TICKS)
        assert ctx.get(pins.ready_n)
        assert ctx.get(pins.error_n)
        return told

    async def read(self, address):
        """A word and its errors."""
        if self._bits == 32:
            return await self.access(address)
        high, error = await self.access(address)
        low, second = await self.access(address + 2)
        return high << 16 | low, error | second

    async def write(self, address, data, lanes=15):
        if self._bits == 32:
            return (await self.access(address, data, lanes))[1]
        error = 0
        halves = [(address, data >> 16, lanes >> 2), (address + 2, data & 0xFFFF, lanes & 3)]
        for half, part, enabled in halves:
            error |= (await self.access(half, part, enabled))[1]
        return error


def run(data_bits, uses, seed=1):
    random.seed(seed)
    board = Board(data_bits)

    async def bench(ctx):
        await uses(ctx, board, Processor(ctx, board.pins, data_bits))

    simulated(board, bench)


@pytest.mark.parametrize("data_bits", [16, 32])
def test_words_are_written_by_lanes_and_read_whole(data_bits):
    async def uses(_ctx, _board, cpu):
        for at, word in enumerate(IDENTITY):
            assert await cpu.read(4 * at) == (int.from_bytes(word, "little"), 0)
        shadow = dict.fromkeys(WORDS, 0)
        for _ in range(30):
            address = random.choice(list(WORDS))
            # Without a lane there is no access.
            lanes = random.choice([15, 5, 6, 9, 10, 7, 14])
            data = random.getrandbits(32)
            mask = sum(0xFF << 8 * lane for lane in range(4) if lanes >> lane & 1)
            shadow[address] = (shadow[address] & ~mask) | (data & mask)
            assert not await cpu.write(address, data, lanes)
            address = random.choice(list(WORDS))
            assert await cpu.read(address) == (shadow[address], 0)

    run(data_bits, uses)


@pytest.mark.parametrize("data_bits", [16, 32])
def test_it_is_ready_within_the_declared_ticks(data_bits):
    async def uses(_ctx, _board, cpu):
        for _ in range(40):
            await cpu.read(WORDS[0])
            await cpu.write(WORDS[1], 5)
        slowest = max(cpu.ticks)
        assert LATEST_TICKS - 1 < slowest <= LATEST_TICKS + 0.1

    run(data_bits, uses)


@pytest.mark.parametrize("data_bits", [16, 32])
def test_a_read_clears_once_and_what_comes_between_two_halves_is_not_lost(data_bits):
    async def uses(ctx, board, cpu):
        async def happens(events):
            ctx.set(board.bank.local_events, events)
            await ctx.tick()
            ctx.set(board.bank.local_events, 0)

        await happens(0x81)
        if data_bits == 16:
            assert await cpu.access(SEEN) == (0, 0)
            await happens(0x02)
            assert await cpu.access(SEEN + 2) == (0x81, 0)
            assert await cpu.access(SEEN + 2) == (0x81, 0)
        else:
            assert await cpu.read(SEEN) == (0x81, 0)
            await happens(0x02)
        assert await cpu.read(SEEN) == (0x02, 0)
        assert await cpu.read(SEEN) == (0, 0)

    run(data_bits, uses)


@pytest.mark.parametrize("data_bits", [16, 32])
def test_what_the_bank_refuses_is_an_error(data_bits):
    async def uses(_ctx, _board, cpu):
        assert (await cpu.access(TRIGGER))[1]
        assert await cpu.write(0, 1)
        assert not await cpu.write(TRIGGER, 1)

    run(data_bits, uses)


def test_a_second_half_that_does_not_follow_its_own_first_one_is_an_error():
    first, second = WORDS[0], WORDS[1]

    async def uses(_ctx, _board, cpu):
        assert (await cpu.access(first + 2))[1]
        assert await cpu.read(first) == (0, 0)
        assert (await cpu.access(second + 2))[1]
        assert (await cpu.access(first + 2, 7))[1]
        assert not (await cpu.access(first, 3))[1]
        assert (await cpu.access(first + 2))[1]
        assert (await cpu.access(second + 2, 7))[1]
        assert not (await cpu.access(first + 2, 7))[1]
        assert (await cpu.access(first + 2, 7))[1]
        assert await cpu.read(first) == (0x0003_0007, 0)
        assert await cpu.read(second) == (0, 0)

    run(16, uses)


def test_any_other_width_is_refused():
    with pytest.raises(ValueError, match="data_bits must be 16 or 32, not 8"):
        LocalBus(8, 8)
    gc.collect()
