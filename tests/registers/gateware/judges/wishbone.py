"""What cocotbext-wishbone's pipelined master sees of the bridge."""

import random

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, ReadOnly, RisingEdge
from cocotbext.wishbone.driver import WBOp, WishboneMaster

from registers.gateware.two_blocks import IDENTITY, SEEN, TRIGGER, WORDS

ACK, ERR = 1, 2
NAMES = {
    **{name: name for name in ("cyc", "stb", "we", "adr", "ack", "sel", "err", "stall")},
    "datwr": "dat_w",
    "datrd": "dat_r",
}
LONGEST = 100


async def started(dut, seed):
    """A master after reset."""
    random.seed(seed)
    cocotb.start_soon(Clock(dut.clk, 10, unit="ns").start())
    master = WishboneMaster(dut, "wb", dut.clk, timeout=LONGEST, signals_dict=NAMES)
    dut.events.value = 0
    dut.rst.value = 1
    await ClockCycles(dut.clk, 3)
    dut.rst.value = 0
    cocotb.start_soon(answers_only_what_was_asked(dut))
    return master


async def answers_only_what_was_asked(dut):
    """One of ack and err for each request taken, inside the cycle."""
    asked = 0
    while True:
        await RisingEdge(dut.clk)
        await ReadOnly()
        ended = int(dut.wb_ack.value) + int(dut.wb_err.value)
        assert ended <= asked, "an answer to nothing"
        assert not ended or int(dut.wb_cyc.value)
        asked -= ended
        if not int(dut.wb_cyc.value):
            asked = 0
        elif int(dut.wb_stb.value) and not int(dut.wb_stall.value):
            asked += 1


async def cycle(master, *operations):
    """What each operation of one cycle got, as (ACK or ERR, data)."""
    results = await master.send_cycle(list(operations))
    return [(result.ack, int(result.datrd)) for result in results]


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def identities_are_read(dut):
    master = await started(dut, 1)
    for base in (0, 0x40):
        told = await cycle(master, WBOp(base >> 2), WBOp((base >> 2) + 1))
        assert told == [(ACK, int.from_bytes(word, "little")) for word in IDENTITY]


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def what_is_written_by_bytes_is_read(dut):
    master = await started(dut, 2)
    shadow = {base + offset: 0 for base in (0, 0x40) for offset in WORDS}
    for _ in range(40):
        operations, expected = [], []
        for _ in range(random.randint(1, 5)):
            address = random.choice(list(shadow))
            idle = random.choice((0, 0, 1, 5))
            if random.random() < 0.5:
                data, sel = random.getrandbits(32), random.randrange(16)
                mask = sum(0xFF << 8 * lane for lane in range(4) if sel >> lane & 1)
                shadow[address] = (shadow[address] & ~mask) | (data & mask)
                operations.append(WBOp(address >> 2, data, idle=idle, sel=sel))
                expected.append(None)
            else:
                operations.append(WBOp(address >> 2, idle=idle))
                expected.append(shadow[address])
        told = await cycle(master, *operations)
        assert [ack for ack, _ in told] == [ACK] * len(operations)
        for (_, data), wanted in zip(told, expected, strict=True):
            assert wanted is None or data == wanted


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def what_cannot_be_accessed_is_an_error(dut):
    master = await started(dut, 3)
    for operation in (WBOp(0x20 >> 2), WBOp(0x3C >> 2, 5), WBOp(0, 5), WBOp(TRIGGER >> 2)):
        assert [ack for ack, _ in await cycle(master, operation)] == [ERR]
    assert [ack for ack, _ in await cycle(master, WBOp(TRIGGER >> 2, 1))] == [ACK]


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def each_event_is_read_once(dut):
    master = await started(dut, 4)
    for event in (1, 2, 0x80, 0xFF):
        dut.events.value = event
        await RisingEdge(dut.clk)
        dut.events.value = 0
        await RisingEdge(dut.clk)
        assert await cycle(master, WBOp(SEEN >> 2), WBOp(SEEN >> 2)) == [(ACK, event), (ACK, 0)]


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def the_answer_to_a_cycle_given_up_is_no_other_ones(dut):
    """A master that drops cyc after its request, and asks anew at once, gets its own answer."""
    master = await started(dut, 5)
    for pause in (0, 1, 2, 3, 4):
        dut.wb_cyc.value = dut.wb_stb.value = 1
        dut.wb_adr.value = 0
        await RisingEdge(dut.clk)
        dut.wb_cyc.value = dut.wb_stb.value = 0
        await ClockCycles(dut.clk, 1 + pause)
        told = await cycle(master, WBOp(1))
        assert told == [(ACK, int.from_bytes(IDENTITY[1], "little"))]
