"""The bridge from a serial line, byte by byte, by a host written from the protocol's text."""

import gc
import random
from functools import partial

import pytest
from amaranth.hdl import Module
from amaranth.lib import wiring
from hypothesis import given
from hypothesis import strategies as st

from railgate.registers.gateware import Bank, Decoder, Uart, address_bits
from registers.gateware.desk import HELLO, READ, WRITE, Answer, Host, frame, request, unframed
from registers.gateware.requester import simulated
from registers.gateware.two_blocks import IDENTITY, MAP, SEEN, TRIGGER, WORDS

BIT_TICKS = 8
MOST = 4
DONE, BUS_ERROR, REFUSED = 0, 1, 2
FIRST = WORDS[0]


class Board(wiring.Component):
    """Two banks on a serial line."""

    def __init__(self):
        self.pins = Uart(address_bits(MAP.size), BIT_TICKS, MOST)
        self.banks = [Bank(block) for block in MAP.blocks.values()]
        super().__init__({})

    def elaborate(self, _platform):
        m = Module()
        m.submodules.bridge = self.pins
        m.submodules.decoder = decoder = Decoder(MAP)
        wiring.connect(m, self.pins.bus, decoder.bus)
        for block, bank in zip(MAP.blocks.values(), self.banks, strict=True):
            m.submodules[block.name] = bank
            wiring.connect(m, getattr(decoder.served, block.name), bank.bus)
        return m


def run(uses, bit_ticks=BIT_TICKS, background=()):
    board = Board()
    host = Host(board.pins, bit_ticks)

    async def bench(ctx):
        await host.begins(ctx)
        await uses(ctx, board, host)

    listening = [host.listens, *(partial(each, board) for each in background)]
    simulated(board, bench, background=listening)


def test_hello_tells_how_many_words_a_request_may_have():
    async def uses(_ctx, _board, host):
        for number in (0, 0, 0xC0DB):
            assert await host.asks(request(number, HELLO)) == [Answer(number, DONE, MOST, ())]

    run(uses)


@pytest.mark.parametrize("off", [-0.02, 0, 0.02])
def test_words_are_written_and_read_also_by_a_host_two_percent_off(off):
    words = (0xC0DB_C0DC, 0xDBDB_DDC0, 0, 0xFFFF_FFFF)

    async def uses(_ctx, _board, host):
        wrote = await host.asks(request(1, WRITE, FIRST, words=words))
        assert wrote == [Answer(1, DONE, 4, ())]
        read = await host.asks(request(2, READ, FIRST, 4))
        assert read == [Answer(2, DONE, 4, words)]
        told = tuple(int.from_bytes(word, "little") for word in IDENTITY)
        assert await host.asks(request(4, READ, 0x40, 2)) == [Answer(4, DONE, 2, told)]

    run(uses, BIT_TICKS * (1 + off))


@pytest.mark.shows("ODO-7")
def test_a_retry_is_answered_with_the_same_and_accesses_nothing():
    async def uses(ctx, board, host):
        async def happens(events):
            ctx.set(board.banks[0].one_events, events)
            await ctx.tick()
            ctx.set(board.banks[0].one_events, 0)

        await happens(0x05)
        reads = request(7, READ, SEEN, 1)
        first = await host.asks(reads)
        assert first == [Answer(7, DONE, 1, (0x05,))]
        await happens(0x40)
        assert await host.asks(reads) == first
        assert await host.asks(reads) == first
        assert await host.asks(request(8, READ, SEEN, 1)) == [Answer(8, DONE, 1, (0x40,))]
        assert await host.asks(request(8, READ, FIRST, 1)) == [Answer(8, DONE, 1, (0,))]
        assert await host.asks(request(8, READ, SEEN, 1)) == [Answer(8, DONE, 1, (0,))]
        await happens(0x10)
        assert await host.asks(request(9, HELLO)) == [Answer(9, DONE, MOST, ())]
        assert await host.asks(request(8, READ, SEEN, 1)) == [Answer(8, DONE, 1, (0x10,))]

    run(uses)


def test_a_write_is_made_once_for_all_retries():
    started = []

    async def counts(board, ctx):
        while True:
            *_, starts = await ctx.tick().sample(board.banks[1].two_starts)
            started.extend([starts] if starts else [])

    async def uses(_ctx, _board, host):
        writes = request(3, WRITE, 0x40 + TRIGGER, words=(5,))
        for _ in range(3):
            assert await host.asks(writes) == [Answer(3, DONE, 1, ())]
        assert started == [5]

    run(uses, background=[counts])


@pytest.mark.shows("ODO-7")
def test_a_lost_answer_loses_nothing_although_noise_comes_between():
    async def uses(ctx, board, host):
        ctx.set(board.banks[0].one_events, 0xFF)
        await ctx.tick()
        ctx.set(board.banks[0].one_events, 0)
        reads = request(0x1234, READ, SEEN, 1)
        await host.asks(reads)
        broken = bytearray(request(0x1235, WRITE, FIRST, words=(1, 2, 3, 4)))
        broken[9] ^= 4
        assert await host.asks(bytes(broken)) == []
        assert await host.asks(reads) == [Answer(0x1234, DONE, 1, (0xFF,))]
        assert await host.asks(request(1, READ, FIRST, 1)) == [Answer(1, DONE, 1, (0,))]

    run(uses)


def test_after_any_noise_the_next_frame_is_answered():
    random.seed(5)
    good = request(5, READ, 0, 1)
    noises = [
        b"\x00" * 3,
        b"\xdb",
        b"\xdb\xc0",
        b"\xc0\xc0\xc0",
        good[:7],
        good[1:],
        request(6, READ, 0, 1)[:-3] + b"\xc0",
        frame(b""),
        frame(bytes(60)),
        *(random.randbytes(random.randint(1, 30)) for _ in range(3)),
    ]

    async def uses(ctx, board, host):
        # A first byte that would be an escaped one, if an escape were left from before.
        for number, noise in zip(range(0xDC, 0x10000, 0x100), noises, strict=False):
            await host.send(noise)
            await host.hear()
            told = await host.asks(request(number, READ, 0, 1))
            assert [each.number for each in told] == [number], noise
        # The end that this one lacks is the next one's beginning, which is then not listened to.
        await host.send(good[:-1])
        assert [each.number for each in await host.asks(request(6, READ, 0, 1))] == [5]
        assert [each.number for each in await host.asks(request(6, READ, 0, 1))] == [6]
        # A line that is stuck, then released in the middle of a bit.
        ctx.set(board.pins.rx, 0)
        await ctx.tick().repeat(37 * BIT_TICKS + 3)
        ctx.set(board.pins.rx, 1)
        await ctx.tick().repeat(11)
        assert [each.number for each in await host.asks(request(9, READ, 0, 1))] == [9]

    run(uses)


def test_an_error_of_the_bus_ends_the_access_and_tells_how_far_it_came():
    async def uses(_ctx, _board, host):
        before, after = request(1, READ, TRIGGER - 4, 2), request(2, WRITE, 0x1C, words=(9, 8, 7))
        assert await host.asks(before) == [Answer(1, BUS_ERROR, 1, (0,))]
        assert await host.asks(after) == [Answer(2, BUS_ERROR, 1, ())]
        assert await host.asks(request(3, READ, 0x1C, 1)) == [Answer(3, DONE, 1, (9,))]
        assert await host.asks(request(4, READ, 0x20, 1)) == [Answer(4, BUS_ERROR, 0, ())]

    run(uses)


REFUSED_ONES = (
    (3, 0, 1, ()),
    (READ, 0, 0, ()),
    (READ, 0, MOST + 1, ()),
    (READ, 2, 1, ()),
    (READ, 0x80, 1, ()),
    (READ, 0x7C, 2, ()),
    (READ, 1 << 31, 1, ()),
    (READ, 0, 1, (1,)),
    (HELLO, 0, 1, (1,)),
    (WRITE, FIRST, 2, (1,)),
    (WRITE, FIRST, 1, (1, 2)),
    (WRITE, FIRST, 0, ()),
    (WRITE, FIRST, 0, (1, 2, 3, 4, 5)),
    (WRITE, FIRST, 4, tuple(range(20))),
)
"""Operation, address, count, words."""


def test_what_is_no_request_is_refused_and_nothing_is_accessed():
    async def uses(_ctx, _board, host):
        for number, asked in enumerate(REFUSED_ONES):
            assert await host.asks(request(number, *asked)) == [Answer(number, REFUSED, 0, ())]
        assert await host.asks(request(99, READ, FIRST, 4)) == [Answer(99, DONE, 4, (0, 0, 0, 0))]

    run(uses)


@given(st.lists(st.binary(min_size=1)))
def test_the_hosts_frames_are_taken_apart_as_they_were_put_together(contents):
    assert unframed(b"".join(frame(content) for content in contents)) == contents


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"bit_ticks": 7}, "bit_ticks must be at least 8, not 7"),
        ({"bit_ticks": 8, "words": 0}, "words must be between 1 and 255, not 0"),
        ({"bit_ticks": 8, "words": 256}, "words must be between 1 and 255, not 256"),
    ],
)
def test_what_cannot_be_built_is_refused_in_one_line(more, said):
    with pytest.raises(ValueError, match=said):
        Uart(8, **more)
    gc.collect()
