"""What cocotbext-axi's AXI4-Lite manager sees of the bridge."""

import itertools
import random

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, Combine, ReadOnly, RisingEdge
from cocotbext.axi import AxiLiteBus, AxiLiteMaster, AxiResp

from registers.gateware.two_blocks import IDENTITY, SEEN, TRIGGER, WORDS

HOLES = (0x20, 0x3C, 0x80 - 4)
BLOCKS = (0, 0x40)
ANSWERS = {"b": ("bresp",), "r": ("rdata", "rresp")}


async def started(dut, seed, pauses=(0, 1)):
    """A manager after reset, its channels pausing at random."""
    random.seed(seed)
    cocotb.start_soon(Clock(dut.clk, 10, unit="ns").start())
    master = AxiLiteMaster(AxiLiteBus.from_prefix(dut, "axi"), dut.clk, dut.rst)
    channels = master.write_if, master.read_if
    for part in (
        *(channels[0].aw_channel, channels[0].w_channel, channels[0].b_channel),
        *(channels[1].ar_channel, channels[1].r_channel),
    ):
        part.log.setLevel("WARNING")
        part.set_pause_generator(itertools.cycle(random.choices(pauses, k=37)))
    dut.events.value = 0
    dut.rst.value = 1
    await ClockCycles(dut.clk, 3)
    dut.rst.value = 0
    for channel in ANSWERS:
        cocotb.start_soon(stands_still(dut, channel))
    return master


async def stands_still(dut, channel):
    """What is valid stays so, and as it is, until it is ready; none is there after reset."""
    signals = [getattr(dut, f"axi_{name}") for name in (f"{channel}valid", *ANSWERS[channel])]
    ready = getattr(dut, f"axi_{channel}ready")
    before = None
    while True:
        await RisingEdge(dut.clk)
        await ReadOnly()
        now = [int(signal.value) for signal in signals]
        assert before is None or now == before, f"{channel} was {before}, is {now}"
        before = now if now[0] and not int(ready.value) else None


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def identities_are_read(dut):
    master = await started(dut, 1)
    for base in BLOCKS:
        told = await master.read(base, 8)
        assert (told.data, told.resp) == (b"".join(IDENTITY), AxiResp.OKAY)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def what_is_written_by_bytes_is_read(dut):
    """Reads and writes of any length and place, of two coroutines at once."""
    master = await started(dut, 2)

    async def uses(base):
        shadow = bytearray(4 * len(WORDS))
        for _ in range(40):
            first = random.randrange(len(shadow))
            length = random.randint(1, len(shadow) - first)
            if random.random() < 0.6:
                data = random.randbytes(length)
                shadow[first : first + length] = data
                told = await master.write(base + WORDS[0] + first, data)
            else:
                told = await master.read(base + WORDS[0] + first, length)
                assert told.data == shadow[first : first + length]
            assert told.resp == AxiResp.OKAY

    await Combine(*(cocotb.start_soon(uses(base)) for base in BLOCKS))


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def what_cannot_be_accessed_is_a_subordinates_error(dut):
    master = await started(dut, 3)
    for address in HOLES:
        assert (await master.write(address, b"1234")).resp == AxiResp.SLVERR
        assert (await master.read(address, 4)).resp == AxiResp.SLVERR
    assert (await master.write(0, b"1234")).resp == AxiResp.SLVERR
    assert (await master.read(TRIGGER, 4)).resp == AxiResp.SLVERR
    assert (await master.write(TRIGGER, b"\x0f")).resp == AxiResp.OKAY


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def each_event_is_read_once(dut):
    master = await started(dut, 4)
    told = 0

    async def happens():
        nonlocal told
        for _ in range(150):
            event = random.choice((0, 0, 1, 2, 3, 0x80))
            dut.events.value = event
            await RisingEdge(dut.clk)
            told |= event
        dut.events.value = 0
        await RisingEdge(dut.clk)

    for _ in range(10):
        seen, told = 0, 0
        happening = cocotb.start_soon(happens())
        while not happening.done():
            seen |= (await master.read(SEEN, 4)).data[0]
        seen |= (await master.read(SEEN, 4)).data[0]
        assert seen == told
        assert (await master.read(SEEN, 4)).data[0] == 0


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def neither_reads_nor_writes_wait_for_ever(dut):
    """While both are wanted all the time, they take turns."""
    master = await started(dut, 5, pauses=(0,))
    ended = []

    async def once(name, access, *arguments):
        await access(*arguments)
        ended.append(name)

    reads = [cocotb.start_soon(once("r", master.read, WORDS[0], 4)) for _ in range(20)]
    writes = [cocotb.start_soon(once("w", master.write, WORDS[1], b"abcd")) for _ in range(20)]
    await Combine(*reads, *writes)
    assert max(len(list(run)) for _, run in itertools.groupby(ended[:30])) <= 2
