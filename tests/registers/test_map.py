"""The map's types: packing, places, and what they refuse; the blocks of the three functions."""

import subprocess
import sys
from dataclasses import replace
from enum import IntEnum, IntFlag

import pytest
from hypothesis import given
from hypothesis import strategies as st

from railgate.digest import digest
from railgate.field import Field
from railgate.odometer.registers import registers as odometer
from railgate.odometer.spec import Config as OdometerConfig
from railgate.position_link.registers import registers as position_link
from railgate.position_link.spec import Config as LinkConfig
from railgate.registers import Access, Block, Gate, Group, Map, Register, gather, identity
from railgate.vital_output.registers import registers as vital_output
from railgate.vital_output.spec import Config as VitalConfig


class Colour(IntEnum):
    RED = 0
    GREEN = 2


class Mark(IntFlag):
    ONE = 1
    FOUR = 4


def register(name="r", width=8, access=Access.READ, **more):
    return Register(name=name, fields=(Field(name, width, ""),), access=access, **more)


def group(name, *registers, gate=Gate.LATCH):
    return Group(name=name, description="", registers=registers, gate=gate)


def block(*entries, name="b"):
    return Block(name=name, description="", entries=entries)


@st.composite
def registers_with_values(draw):
    fields, room = [], 32
    while room and (not fields or draw(st.booleans())):
        width = draw(st.integers(1, room))
        room -= width
        fields.append(Field(f"f{len(fields)}", width, "", signed=draw(st.booleans())))
    if len(fields) == 1 and draw(st.booleans()):
        fields = [replace(fields[0], width=draw(st.integers(33, 200)))]
    made = Register(name="r", fields=tuple(fields))
    values = {}
    for each in fields:
        low = -(1 << each.width - 1) if each.signed else 0
        values[each.name] = draw(st.integers(low, low + (1 << each.width) - 1))
    return made, values


@given(registers_with_values())
def test_unpack_reads_what_pack_wrote_in_as_few_words_as_hold_it(case):
    made, values = case
    words = made.pack(values)
    assert len(words) == made.words == -(-sum(each.width for each in made.fields) // 32)
    assert all(0 <= word < 1 << 32 for word in words)
    assert made.unpack(words) == values


def test_fields_are_packed_from_bit_0_up_and_words_are_low_first():
    small = Register(name="r", fields=(Field("a", 3, ""), Field("b", 5, "", signed=True)))
    assert small.pack({"a": 5, "b": -2}) == (0b11110_101,)
    assert register(width=70).pack({"r": 0x3F_1234_5678_9ABC_DEF0}) == (
        0x9ABC_DEF0,
        0x1234_5678,
        0x3F,
    )


def test_a_group_stands_twice_and_every_place_is_used_once():
    made = block(
        register("one"),
        group("two", register("low"), register("wide", 40)),
        register("three"),
    )
    places = {each.register.name: (each.offset, each.again) for each in made.places}
    assert places == {"one": (0, None), "low": (4, 16), "wide": (8, 20), "three": (28, None)}
    assert made.words == 8
    assert made.size == 32
    assert made.place("two").register.name == "low"


@pytest.mark.shows("SYS-1")
@pytest.mark.parametrize(
    "block_",
    [odometer(OdometerConfig()), position_link(LinkConfig()), vital_output(VitalConfig())],
)
def test_a_functions_words_do_not_overlap_and_leave_no_hole(block_):
    used = sorted(
        first + 4 * word
        for place in block_.places
        for first in (place.offset, place.again)
        if first is not None
        for word in range(place.register.words)
    )
    assert used == list(range(0, 4 * block_.words, 4))


@pytest.mark.shows("SYS-1")
@pytest.mark.parametrize(
    ("made", "fields"),
    [
        (position_link(LinkConfig()), LinkConfig().fields),
        (vital_output(VitalConfig()), VitalConfig().fields),
        (odometer(OdometerConfig()), OdometerConfig().common_fields),
        (
            odometer(OdometerConfig(sensors=3)),
            [
                replace(each, name=f"sensor_{sensor}_{each.name}")
                for sensor in range(3)
                for each in OdometerConfig().sensor_fields
            ],
        ),
    ],
)
def test_every_field_of_the_specification_is_in_the_group_just_once(made, fields):
    there = [field for each in made.groups for own in each.registers for field in own.fields]
    for field in fields:
        assert there.count(field) == 1


@pytest.mark.shows("SYS-1")
def test_any_configuration_has_a_map():
    odometer(OdometerConfig(sensors=16, stamp_depth=16, count_bits=48, time_bits=63))
    position_link(LinkConfig(word_bits=512, age_bits=16, count_bits=48, age_ticks_bits=48))
    for outputs in (1, 8, 33):
        vital_output(VitalConfig(outputs=outputs, life_cycles=3, count_bits=48))


@pytest.mark.shows("SYS-5")
def test_each_parameter_of_a_configuration_changes_the_digest():
    assert digest(OdometerConfig()) == OdometerConfig().digest
    changed = {
        OdometerConfig().digest,
        OdometerConfig(filter_ticks=1).digest,
        OdometerConfig(sensors=1).digest,
        LinkConfig().digest,
        LinkConfig(bare=True).digest,
        VitalConfig().digest,
        VitalConfig(outputs=8).digest,
    }
    assert len(changed) == 7
    assert all(0 <= each < 1 << 32 for each in changed)


def test_blocks_are_placed_one_after_the_other_at_multiples_of_their_size():
    made = Map.of(
        "unit",
        "",
        [
            block(register("a"), name="small"),
            block(*(register(f"b{at}") for at in range(5)), name="large"),
            block(register("c"), name="last"),
        ],
    )
    assert {base: each.name for base, each in made.blocks.items()} == {
        0: "small",
        32: "large",
        64: "last",
    }
    assert made.size == 68
    assert made.address("large", "b3") == 44


def test_an_address_is_of_a_register_or_of_a_group_at_either_place():
    made = Map.of("unit", "", [block(register("a"), group("g", register("b"), register("c")))])
    assert made.address("b", "g") == made.address("b", "b") == 4
    assert made.address("b", "c", again=True) == 16
    for wrong, said in (
        (("x", "a"), 'no block "x" in unit; there are: b'),
        (("b", "x"), 'no register "x" in b; there are: a, b, c'),
    ):
        with pytest.raises(ValueError, match=said):
            made.address(*wrong)
    with pytest.raises(ValueError, match="a is in no group, it has no second place"):
        made.address("b", "a", again=True)


def test_values_of_a_wider_field_are_those_of_an_array():
    register("r", 6, values={"r": Colour})
    register("r", 3, values={"r": Mark})
    with pytest.raises(ValueError, match="r must be a multiple of Colour's 2 bits wide, not 3"):
        register("r", 3, values={"r": Colour})


def test_gathered_fields_keep_their_order_and_share_where_they_are_told_to():
    fields = [Field(name, 4, "") for name in "abcd"]
    made = gather(fields, {"both": ["b", "d"]}, {"d": Colour})
    assert [(each.name, each.field_names) for each in made] == [
        ("a", ("a",)),
        ("both", ("b", "d")),
        ("c", ("c",)),
    ]
    assert made[1].values == {"d": Colour}
    with pytest.raises(ValueError, match="no field x to make a register of"):
        gather(fields, {"both": ["x"]}, {})


def test_an_identity_is_letters_version_and_digest():
    first, second = identity("ODO", 3, 0x1234_5678)
    words = [each.pack({own.name: own.start for own in each.fields}) for each in (first, second)]
    assert words == [(0x4F44_4F03,), (0x1234_5678,)]


SHARED = (Field("a", 20, ""), Field("b", 13, ""))
BITS = (Field("x", 1, ""), Field("y", 1, ""))


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: register("Big"), 'a name must be lower case as "sum_a", not "Big"'),
        (lambda: Register(name="r", fields=()), "r must have at least one field"),
        (lambda: Register(name="r", fields=SHARED), "the fields of r must share 32 bits, not 33"),
        (lambda: register(values={"x": Colour}), 'r has no field "x" to name the values of'),
        (
            lambda: Register(name="r", fields=BITS, counters=("x", "y")),
            "r must be sticky, with a 1-bit field for each of its counters",
        ),
        (
            lambda: Register(name="r", fields=BITS, access=Access.READ_TO_CLEAR, counters=("x",)),
            "r must be sticky, with a 1-bit field for each of its counters",
        ),
        (lambda: register().pack({"r": 256}), "r must be between 0 and 255, not 256"),
        (lambda: register().pack({"x": 1}), 'no field "x" in r; there are: r'),
        (lambda: register().unpack([1, 2]), "r must have 1 words, not 2"),
        (lambda: group("g"), "g must have at least one register"),
        (
            lambda: group("g", register(access=Access.READ_WRITE)),
            "registers of a group must be for reading, not r for read, write",
        ),
        (
            lambda: block(register(width=33)),
            "r must be in a group, to have 2 words of one tick",
        ),
        (lambda: block(), "b must have at least one register"),
        (lambda: block(register(), register()), "names in b must differ, not be twice r"),
        (
            lambda: block(register("p"), Register(name="q", fields=(Field("p", 1, ""),))),
            "names in b must differ, not be twice p",
        ),
        (
            lambda: block(
                Register(
                    name="r",
                    fields=BITS,
                    access=Access.WRITE_ONE_TO_CLEAR,
                    counters=("c", "d"),
                )
            ),
            'b has no field "c" to set r by',
        ),
        (
            lambda: Map(name="m", description="", blocks={2: block(register())}),
            "the base of b must be a multiple of 0x4, not 0x2",
        ),
        (
            lambda: Map(
                name="m",
                description="",
                blocks={
                    0: block(*(register(f"r{at}") for at in range(3))),
                    8: block(register(), name="c"),
                },
            ),
            "c at 0x8 must be clear of b",
        ),
        (
            lambda: Map(
                name="m", description="", blocks={0: block(register()), 4: block(register())}
            ),
            "names in m must differ, not be twice b",
        ),
        (
            lambda: Map(name="m", description="", blocks={1 << 32: block(register())}),
            "m must end within 32 address bits",
        ),
    ],
)
def test_what_does_not_hold_is_refused_in_one_line(make, said):
    with pytest.raises(ValueError, match=said) as error:
        make()
    assert "\n" not in str(error.value)


def test_the_map_needs_no_amaranth():
    code = (
        "import sys, railgate.odometer.registers, railgate.position_link.registers, "
        "railgate.vital_output.registers\n"
        "sys.exit(any(name.split('.')[0] in ('amaranth', 'numpy') for name in sys.modules))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
