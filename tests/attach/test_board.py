"""What is on a board is found by its identities; what is not the unit's is refused."""

from collections.abc import Sequence
from fractions import Fraction

import pytest

from railgate.attach.board import find
from railgate.engines import Clock, Design
from railgate.registers import Block, identity
from railgate.registers.host import AccessError, ModelledBus, Running, SimulatedBus
from railgate.unit.config import UNITS, Unit
from railgate.unit.gateware import LINK_DOMAIN, Fpga
from railgate.unit.registers import registers
from registers.host.designs import ALONE

pytestmark = pytest.mark.shows("SYS-1", "SYS-5")


def fpga(number: int) -> SimulatedBus:
    """The gateware of one FPGA, just out of reset."""
    unit = Unit()
    clocks = [Clock(frequency_hz=Fraction(unit.odometer.clock_hz))]
    if number == 1:
        clocks.append(Clock(frequency_hz=Fraction(unit.link.clock_hz), domain=LINK_DOMAIN))
    design = Design(
        name=f"fpga-{number}", component=lambda: Fpga(unit, number), clocks=tuple(clocks)
    )
    return SimulatedBus(Running(design, "pysim"), registers(unit, number).size)


@pytest.mark.parametrize("number", [1, 2])
def test_all_functions_of_an_fpga_are_found_at_their_addresses(number) -> None:
    found = find(fpga(number), Unit())
    there = {gauge.registers.base: gauge.registers.block.name for gauge in found}
    blocks = registers(Unit(), number).blocks
    assert there == {base: block.name for base, block in blocks.items()}
    told = [gauge.read() for gauge in found]
    assert told[0]["number"] == 1
    assert told[1]["states"] == ["idle"] * Unit().vital.outputs
    if number == 1:
        assert told[2] == {"number": 0, "seen": []}


class Nothing:
    """A bus without a board."""

    def read(self, address: int, count: int = 1) -> list[int]:
        raise AccessError(address, f"there are no {count} words")

    def write(self, address: int, words: Sequence[int]) -> None:
        raise AccessError(address, f"there are no {len(words)} words")


def described(letters: str, version: int, digest: int) -> ModelledBus:
    """A board with one block, of nothing but this identity."""
    block = Block(name="other", description="", entries=identity(letters, version, digest))
    return ModelledBus(block, Running(ALONE["position_link"][0], "leap"))


@pytest.mark.parametrize(
    ("bus", "says"),
    [
        (Nothing(), "must have a function at address 0"),
        (described("XYZ", 1, 2), "identity at 0x0 must be of ODO, LNK, DRV, not 0x58595a"),
        (described("LNK", 9, 2), "version of the position_link at 0x0 must be 0x1, not 0x9"),
        (
            described("ODO", 1, 0x1234),
            "digest of the odometer at 0x0 must be 0x[0-9a-f]{8}, not 0x1234",
        ),
    ],
    ids=["nothing", "unknown", "version", "configuration"],
)
def test_what_is_not_the_units_is_refused_in_one_line(bus, says) -> None:
    with pytest.raises(ValueError, match=says) as refused:
        find(bus, UNITS["metro"]())
    assert "\n" not in str(refused.value)
