"""The SystemRDL of a map, as systemrdl-compiler elaborates it, against the map."""

from dataclasses import replace

import pytest
from systemrdl import RDLCompiler
from systemrdl.node import AddrmapNode, FieldNode
from systemrdl.parser.SystemRDLLexer import SystemRDLLexer
from systemrdl.rdltypes import AccessType, OnReadType, OnWriteType

from railgate.field import Field
from railgate.registers import Access, Map, Place, Register
from railgate.registers.export import systemrdl
from railgate.registers.export.systemrdl import KEYWORDS
from registers.maps import Event, Mode, every_kind, unit

pytestmark = pytest.mark.shows("SYS-1")

MAPS = {"unit": unit, "every kind": every_kind}
SOFTWARE = {
    Access.CONSTANT: (AccessType.r, None, None),
    Access.READ: (AccessType.r, None, None),
    Access.READ_TO_CLEAR: (AccessType.r, OnReadType.rclr, None),
    Access.WRITE_ONE_TO_CLEAR: (AccessType.rw, None, OnWriteType.woclr),
    Access.READ_WRITE: (AccessType.rw, None, None),
    Access.TRIGGER: (AccessType.w, None, None),
}


def elaborated(map_: Map, folder) -> AddrmapNode:
    source = folder / "map.rdl"
    source.write_text(systemrdl(map_), encoding="utf-8")
    compiler = RDLCompiler()
    compiler.compile_file(str(source))
    return compiler.elaborate().top


def bits_of(top: AddrmapNode) -> dict[tuple[int, int], FieldNode]:
    """The field at each bit, by byte address of the word and bit; no two are at one."""
    found: dict[tuple[int, int], FieldNode] = {}
    for node in top.descendants():
        if isinstance(node, FieldNode):
            assert node.parent.get_property("regwidth") == 32
            assert node.parent.get_property("accesswidth") == 32
            for bit in range(node.low, node.high + 1):
                assert found.setdefault((node.parent.absolute_address, bit), node) is node
    return found


def addresses(base: int, place: Place) -> list[int]:
    return [base + offset for offset in (place.offset, place.again) if offset is not None]


@pytest.mark.parametrize("make", MAPS.values(), ids=MAPS)
def test_every_bit_of_every_field_is_where_the_map_has_it(make, tmp_path) -> None:
    map_ = make()
    found = bits_of(elaborated(map_, tmp_path))
    expected = 0
    for base, block in map_.blocks.items():
        for place in block.places:
            register = place.register
            for address in addresses(base, place):
                for field, shift in zip(register.fields, register.shifts, strict=True):
                    for bit in range(shift, shift + field.width):
                        if register.values.get(field.name) is Event and bit - shift == 2:
                            continue  # the bit of no flag
                        node = found[address + bit // 32 * 4, bit % 32]
                        compare(node, register, field, shift, bit)
                        expected += 1
    assert len(found) == expected, "nothing else is described"


def compare(node: FieldNode, register: Register, field: Field, shift: int, bit: int) -> None:
    """The field at one of the bits."""
    software = tuple(node.get_property(name) for name in ("sw", "onread", "onwrite"))
    assert software == SOFTWARE[register.access]
    assert node.inst_name.startswith(field.name)
    assert node.get_property("desc").startswith(field.meaning)
    assert bool(node.get_property("stickybit")) is register.access.sticky
    assert bool(node.get_property("singlepulse")) is (register.access is Access.TRIGGER)
    reset = node.get_property("reset") >> bit % 32 - node.low & 1
    assert reset == field.start >> bit - shift & 1
    top = bit - shift - (bit % 32 - node.low) + node.width == field.width
    assert bool(node.get_property("is_signed")) is (field.signed and top)


def test_names_are_those_of_the_map(tmp_path) -> None:
    top = elaborated(unit(), tmp_path)
    for path in (
        "odometer.identity.function",
        "odometer.snapshot.number.number",
        "odometer.snapshot_again.sensor_1_sum_b_1.sensor_1_sum_b_1",
        "odometer.snapshot.sensor_0_state.sensor_0_flags_reversal",
        "odometer.sensor_0_stamps.sensor_0_stamps_edge.sensor_0_stamps_lost",
        "position_link.delivery.word_2.word_2",
        "position_link.delivery.state.causes_timeout",
        "position_link.seen.zero_word_seen",
        "vital_output.status_again.states_2.states_2",
        "vital_output.control.test",
    ):
        assert top.find_by_path(path) is not None, path
    assert top.inst_name == "unit"
    assert top.get_property("desc") == 'a unit of "three"'


def test_values_have_their_names(tmp_path) -> None:
    top = elaborated(every_kind(), tmp_path)
    encode = top.find_by_path("field.setting.mode").get_property("encode")
    assert {each.name.upper(): each.value for each in encode} == dict(Mode.__members__)
    assert {node.inst_name for node in top.find_by_path("field.events").fields()} == {
        "gap",
        "events_hot",
        "events_cold",
        "events_wet",
    }
    assert "2 bits each: off 0, number 1, on 3" in top.find_by_path(
        "field.number.modes_1.modes_1"
    ).get_property("desc")


def test_every_word_that_is_no_name_is_known() -> None:
    """Those that the compiler's own lexer knows."""
    literals = {name.strip("'") for name in SystemRDLLexer.literalNames}
    assert {word for word in literals if word.isidentifier()} == KEYWORDS


def test_a_trigger_of_several_bits_is_refused() -> None:
    block = next(iter(every_kind().blocks.values()))
    wide = Register(name="wide", fields=(Field("wide", 2, "both"),), access=Access.TRIGGER)
    map_ = Map.of("all", "", [replace(block, entries=(wide,))])
    with pytest.raises(ValueError, match="wide must have 1 bit to be described, not 2"):
        systemrdl(map_)
