"""The decoder: each address is in its block, or an error."""

from amaranth.hdl import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In

from railgate.registers.gateware import Bank, Decoder, address_bits, bus_signature
from registers.gateware.requester import Requester, simulated
from registers.gateware.two_blocks import IDENTITY, MAP, WORDS


class Served(wiring.Component):
    """The map's banks behind its decoder."""

    def __init__(self):
        super().__init__({"bus": In(bus_signature(address_bits(MAP.size)))})

    def elaborate(self, _platform):
        m = Module()
        m.submodules.decoder = decoder = Decoder(MAP)
        wiring.connect(m, wiring.flipped(self.bus), decoder.bus)
        for block in MAP.blocks.values():
            m.submodules[block.name] = bank = Bank(block)
            wiring.connect(m, getattr(decoder.served, block.name), bank.bus)
        return m


def test_each_address_is_its_blocks_or_an_error_and_a_write_goes_nowhere_else():
    served = Served()
    ends = {base + 4 * block.words for base, block in MAP.blocks.items()}

    async def asks(ctx):
        bus = Requester(ctx, served.bus)
        words = [base + offset for base in MAP.blocks for offset in WORDS]
        for address in words:
            await bus.write(address, address * 3)
        assert [word for each in words for word in await bus.read(each)] == [3 * a for a in words]
        for address in range(0, 1 << address_bits(MAP.size), 4):
            inside = any(end - 4 * 8 <= address < end for end in ends)
            answer = await bus.access(address)
            assert answer.error == (not inside or address % 0x40 == 0xC)
            if address in MAP.blocks:
                assert answer.data == int.from_bytes(IDENTITY[0], "little")

    simulated(served, asks)
