"""The three functions with their banks: gates, bursts of one tick, sticky causes, triggers."""

import gc
import itertools
from dataclasses import replace
from fractions import Fraction

import pytest

from railgate.odometer.gateware import Odometer
from railgate.odometer.registers import registers as odometer_registers
from railgate.odometer.spec import Config as OdometerConfig
from railgate.position_link.gateware import PositionLink
from railgate.position_link.registers import registers as link_registers
from railgate.position_link.spec import Config as LinkConfig
from railgate.position_link.spec import Health, Status
from railgate.registers import Block, Map
from railgate.registers.gateware import Mapped
from railgate.vital_output.gateware import Channel
from railgate.vital_output.registers import registers as vital_registers
from registers.gateware.requester import Requester, simulated
from vital_output.small import SMALL as VITAL

ODOMETER = OdometerConfig(stamp_depth=3, period_bits=24, window_pulses=15, count_bits=16)
LINK = LinkConfig(
    clock_hz=8_000,
    bit_rate_hz=Fraction(1_000),
    cycle_s=Fraction(100, 1000),
    word_bits=40,
    request_bits=2,
    timeout_bits=5,
    filter_ticks=0,
    guard_ticks=0,
    bare=True,
)


def unpacked(block: Block, group: str, words: list[int]) -> dict[str, int]:
    """The fields of a group's burst."""
    registers = next(each for each in block.groups if each.name == group).registers
    words = iter(words)
    values = {}
    for register in registers:
        values |= register.unpack([next(words) for _ in range(register.words)])
    return values


async def burst(bus: Requester, block: Block, group: str, again: bool = False) -> dict[str, int]:
    place = block.place(group)
    words = await bus.read(place.again if again else place.offset, place.group.words)
    return unpacked(block, group, words)


FIRST = 10
"""The tick of the wheels' first step."""


def odometer(pause: int):
    """An odometer whose wheels turn, sensor 1 backwards, a step each `pause` ticks."""
    block = odometer_registers(ODOMETER)
    mapped = Mapped(Odometer(ODOMETER), block)

    async def wheels(ctx):
        for _ in range(FIRST):
            await ctx.tick()
        for a, b in itertools.cycle([(1, 0), (1, 1), (0, 1), (0, 0)]):
            ctx.set(mapped.sensor[0].a, a)
            ctx.set(mapped.sensor[0].b, b)
            ctx.set(mapped.sensor[1].a, b)
            ctx.set(mapped.sensor[1].b, a)
            for _ in range(pause):
                await ctx.tick()

    return block, mapped, wheels


@pytest.mark.shows("ODO-6", "ODO-7")
def test_one_read_of_the_gate_gives_a_burst_of_one_tick_while_the_wheels_turn_on():
    block, mapped, wheels = odometer(pause=7)

    async def reads(ctx):
        bus = Requester(ctx, mapped.bus)
        pulses = [0, 0]
        for number in range(1, 8):
            fields = await burst(bus, block, "snapshot")
            assert fields["number"] == number
            assert fields["sensor_0_position"] == -fields["sensor_1_position"]
            for sensor in (0, 1):
                pulses[sensor] += fields[f"sensor_{sensor}_pulses"]
                assert pulses[sensor] == fields[f"sensor_{sensor}_a_rising"]
            since_first = fields["time"] - FIRST - ODOMETER.input_delay_ticks
            assert fields["sensor_0_position"] == max(0, since_first // 7 + 1)

    simulated(mapped, reads, background=[wheels])


@pytest.mark.shows("ODO-7")
def test_the_burst_is_read_again_without_a_gate_and_is_the_same_to_the_bit():
    block, mapped, wheels = odometer(pause=9)

    async def reads(ctx):
        bus = Requester(ctx, mapped.bus)
        for number in range(1, 4):
            first = await burst(bus, block, "snapshot")
            assert first["number"] == number
            await ctx.tick().repeat(50)
            assert await burst(bus, block, "snapshot", again=True) == first
            assert await burst(bus, block, "snapshot", again=True) == first

    simulated(mapped, reads, background=[wheels])


@pytest.mark.shows("ODO-7")
@pytest.mark.parametrize("by", ["register", "pin"])
def test_a_common_strobe_is_the_gate_too_and_its_burst_is_waited_for(by):
    block, mapped, wheels = odometer(pause=9)

    async def reads(ctx):
        bus = Requester(ctx, mapped.bus)
        for number in range(1, 4):
            if by == "register":
                await bus.write(block.place("control").offset, 1)
            else:
                ctx.set(mapped.strobe, 1)
                await ctx.tick()
                ctx.set(mapped.strobe, 0)
            fields = await burst(bus, block, "snapshot", again=True)
            assert fields["number"] == number
            assert fields["sensor_0_position"] == -fields["sensor_1_position"]

    simulated(mapped, reads, background=[wheels])


@pytest.mark.shows("ODO-6", "ODO-7")
def test_a_gate_that_meets_a_common_strobe_joins_it_or_is_the_next_one():
    """Whatever the tick of the strobe before the read: the burst is one of the two, whole."""
    block, mapped, wheels = odometer(pause=9)

    async def reads(ctx):
        bus = Requester(ctx, mapped.bus)
        number = 0
        for before in range(1, ODOMETER.snapshot_latency_ticks + 3):
            ctx.set(mapped.strobe, 1)
            await ctx.tick()
            ctx.set(mapped.strobe, 0)
            await ctx.tick().repeat(before)
            fields = await burst(bus, block, "snapshot")
            # The strobe was in tick 0, the request comes in tick before + 1, its gate one later.
            joins = before + 2 < ODOMETER.snapshot_latency_ticks
            number += 1 if joins else 2
            assert fields["number"] == number
            assert fields["sensor_0_position"] == -fields["sensor_1_position"]

    simulated(mapped, reads, background=[wheels])


@pytest.mark.shows("ODO-13")
def test_stamps_are_taken_one_by_one_none_twice_and_zero_when_there_is_none():
    block, mapped, _ = odometer(pause=1)
    times = [5, 50, 130]

    async def reads(ctx):
        bus = Requester(ctx, mapped.bus)
        await ctx.tick().repeat(times[0])
        for at, later in zip(times, [*times[1:], 200], strict=True):
            ctx.set(mapped.sensor[0].a, ~ctx.get(mapped.sensor[0].a))
            await ctx.tick().repeat(later - at)
        seen = []
        for _ in range(5):
            fields = await burst(bus, block, "sensor_0_stamps")
            assert await burst(bus, block, "sensor_0_stamps", again=True) == fields
            seen.append(fields)
        assert [each["sensor_0_stamps_valid"] for each in seen] == [1, 1, 1, 0, 0]
        ticks = [each["sensor_0_stamps_ticks"] for each in seen]
        assert [each - ticks[0] for each in ticks[:3]] == [0, 45, 125]
        assert [each["sensor_0_stamps_a"] for each in seen] == [1, 0, 1, 0, 0]
        assert not any(seen[-1].values())

    simulated(mapped, reads)


@pytest.mark.shows("ODO-8")
def test_each_sensor_adds_as_many_words_to_the_one_burst():
    sizes = [
        odometer_registers(replace(ODOMETER, sensors=sensors)).place("snapshot").group.words
        for sensors in (1, 2, 3, 16)
    ]
    own = sizes[1] - sizes[0]
    assert sizes == [sizes[0] + own * more for more in (0, 1, 2, 15)]


@pytest.mark.shows("SYS-5")
def test_identity_and_digest_lead_each_block():
    blocks = [
        (odometer_registers(ODOMETER), Odometer(ODOMETER), b"ODO", ODOMETER.digest),
        (link_registers(LINK), PositionLink(LINK), b"LNK", LINK.digest),
        (vital_registers(VITAL), Channel(VITAL, 0), b"DRV", VITAL.digest),
    ]
    for block, function, letters, digest in blocks:
        mapped = Mapped(function, block)

        async def reads(ctx, mapped=mapped, letters=letters, digest=digest):
            bus = Requester(ctx, mapped.bus)
            assert await bus.read(0, 2) == [int.from_bytes(letters, "big") << 8 | 1, digest]
            assert (await bus.access(0, 0)).error

        simulated(mapped, reads)


@pytest.mark.shows("LNK-6", "LNK-7")
def test_a_delivery_is_read_whole_while_the_next_one_comes():
    block = link_registers(LINK)
    mapped = Mapped(PositionLink(LINK), block)
    place = block.place("delivery")

    async def reads(ctx):
        bus = Requester(ctx, mapped.bus)
        await ctx.tick().until(mapped.delivery)
        await ctx.tick().repeat(LINK.cycle_ticks - 30)
        words = []
        for at in range(place.group.words):
            words += await bus.read(place.offset + 4 * at)
            await ctx.tick().repeat(11)
        first = unpacked(block, "delivery", words)
        assert ctx.get(mapped.number) > first["number"] == 1
        assert await burst(bus, block, "delivery", again=True) == first
        second = await burst(bus, block, "delivery")
        assert second["number"] == ctx.get(mapped.number)
        assert second["status"] == Status.FAULT
        assert second["health"] == Health.START
        assert second["word"] == LINK.invalid_word
        assert second["timeout_cycles"] == second["number"]

    simulated(mapped, reads)


@pytest.mark.shows("LNK-7")
def test_a_cause_stays_seen_until_a_one_is_written_and_comes_up_anew_with_the_next_cycle():
    block = link_registers(LINK)
    mapped = Mapped(PositionLink(LINK), block)
    seen = block.place("seen").offset

    async def reads(ctx):
        bus = Requester(ctx, mapped.bus)
        assert await bus.read(seen) == [0]
        for _ in range(2):
            await ctx.tick().until(mapped.delivery)
            await ctx.tick().repeat(3)
            assert await bus.read(seen) == [1] == await bus.read(seen)
            await bus.write(seen, 0x3FE)
            assert await bus.read(seen) == [1]
            await bus.write(seen, 1)
            assert await bus.read(seen) == [0]

    simulated(mapped, reads)


def test_the_only_registers_of_a_channel_that_can_be_written_are_seen_and_test():
    block = vital_registers(VITAL)
    assert [each.name for each in block.registers if each.access.writes] == ["seen", "control"]
    mapped = Mapped(Channel(VITAL, 0), block)
    map_ = Map.of("unit", "one channel", [block])

    async def writes(ctx):
        bus = Requester(ctx, mapped.bus)
        refused = [
            address
            for address in range(0, block.size, 4)
            if (await bus.access(address, 0xFFFF_FFFF)).error
        ]
        written = set(range(0, block.size, 4)) - set(refused)
        assert written == {map_.address("vital_output", name) for name in ("seen", "control")}

    simulated(mapped, writes)


def test_a_function_without_a_port_that_its_block_needs_is_refused():
    with pytest.raises(ValueError, match="odometer needs a port for busy, number, "):
        Mapped(Channel(VITAL, 0), odometer_registers(ODOMETER))
    gc.collect()
