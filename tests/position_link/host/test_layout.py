"""Layouts against words taken apart as texts of bits."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from railgate.position_link.host.layout import Bits, Layout, WordField, guarantee
from railgate.position_link.host.words import pack, parted, sound
from railgate.position_link.spec import EVEN, Check, Config

pytestmark = pytest.mark.shows("LNK-8")

CRC8 = Check(width=8, polynomial=0x2F, initial=0xFF, final=0xFF)


def field(name: str, bits: str, **settings: object) -> WordField:
    return WordField(name=name, bits=Bits.of(bits), **settings)  # type: ignore[arg-type]


def word(*fields: WordField, word_bits: int = 16, **settings: object) -> Layout:
    return Layout(word_bits=word_bits, fields=fields, **settings)  # type: ignore[arg-type]


scales = st.sampled_from(
    [Fraction(1), Fraction(1, 1000), Fraction(-1, 4), Fraction(10**9), Fraction(360, 2**24)]
)
offsets = st.sampled_from([Fraction(0), Fraction(-40), Fraction(1, 3)])


@st.composite
def layouts(draw: st.DrawFn) -> Layout:
    """Words of any length, cut at random into fields, unused bits and a check."""
    word_bits = draw(st.sampled_from([8, 31, 64, 65, 100, 512]))
    check = draw(st.sampled_from([None, EVEN, Check(width=5, polynomial=5, initial=3, final=9)]))
    low = check.width if check else 0
    fields, unused = [], []
    while low < word_bits:
        bits = Bits(min(low + draw(st.integers(1, 64)), word_bits) - 1, low)
        low = bits.msb + 1
        if low < word_bits and draw(st.integers(0, 4)) == 0:
            unused.append(bits)
            continue
        signed, gray = draw(st.booleans()), draw(st.booleans())
        fields.append(
            WordField(
                name=f"f{low}",
                bits=bits,
                signed=signed,
                gray=gray,
                scale=draw(scales),
                offset=draw(offsets),
            )
        )
    order = draw(st.permutations(fields))
    return Layout(word_bits=word_bits, fields=tuple(order), unused=tuple(unused), check=check)


def drawn(bits: int) -> st.SearchStrategy[int]:
    """Numbers of so many bits, the high ones as often 1 as the low ones."""
    size = -(-bits // 8)
    return st.binary(min_size=size, max_size=size).map(
        lambda raw: int.from_bytes(raw, "big") >> 8 * size - bits
    )


def raw_of(one: WordField, number: int, word_bits: int) -> int:
    """The raw number of a field, from the word's text, first bit on the line first."""
    text = f"{number:0{word_bits}b}"[word_bits - 1 - one.bits.msb : word_bits - one.bits.lsb]
    bits = [int(bit) for bit in text]
    if one.gray:
        for i in range(1, len(bits)):
            bits[i] ^= bits[i - 1]
    raw = sum(bit << i for i, bit in enumerate(reversed(bits)))
    return raw - (bits[0] << len(bits)) if one.signed else raw


@given(layouts(), st.data())
def test_every_field_is_its_bits_scaled_exactly(layout: Layout, data: st.DataObject) -> None:
    number = data.draw(drawn(layout.word_bits))
    values = layout.decode(number)
    assert list(values) == [one.name for one in layout.fields]
    for one in layout.fields:
        exact = raw_of(one, number, layout.word_bits) * one.scale + one.offset
        value = values[one.name]
        assert value == (exact if isinstance(value, int) else float(exact))
        assert isinstance(value, int) == (one.scale == 1 and one.offset == 0)


@given(layouts(), st.data())
def test_many_words_are_decoded_as_each_is(layout: Layout, data: st.DataObject) -> None:
    numbers = data.draw(st.lists(drawn(layout.word_bits), max_size=6))
    columns = layout.columns(pack(numbers, layout.word_bits))
    for name, column in columns.items():
        assert column.shape == (len(numbers),)
        assert column.tolist() == [layout.decode(number)[name] for number in numbers]


@given(layouts(), st.data())
def test_a_word_says_again_what_it_was_made_of(layout: Layout, data: st.DataObject) -> None:
    """Exact values of raw numbers give these numbers, and unused bits of 0."""
    raws = {one.name: one.raw_range[0] + data.draw(drawn(one.bits.width)) for one in layout.fields}
    values = {one.name: raws[one.name] * one.scale + one.offset for one in layout.fields}
    try:
        number = layout.encode(values)
    except ValueError as error:
        assert "no valid word" in str(error)  # noqa: PT017
        return
    for one in layout.fields:
        assert raw_of(one, number, layout.word_bits) == raws[one.name]
    for bits in layout.unused:
        assert number >> bits.lsb & (1 << bits.width) - 1 == 0
    if layout.check:
        width = layout.check.width
        stands = number & (1 << width) - 1
        assert stands == layout.check.of(number >> width, layout.word_bits - width)
    twice = layout.words({name: [value, value] for name, value in values.items()})
    assert layout.columns(twice)[layout.fields[0].name].size == 2
    assert (twice == pack([number, number], layout.word_bits)).all()


@given(st.integers(0, (1 << 40) - 1))
def test_a_float_finds_its_way_back(raw: int) -> None:
    """With 40 bits and any of these scales floats tell all raw numbers apart."""
    for scale in (Fraction(1, 1000), Fraction(-3, 7), Fraction(10**20)):
        layout = word(field("x", "39..0", scale=scale), field("y", "40"), word_bits=41)
        number = raw
        assert layout.encode(layout.decode(number)) == number


@pytest.mark.parametrize("scale", [Fraction(1, 1000), Fraction(10**9, 7)])
def test_values_beyond_the_floats_are_rounded_once(scale: Fraction) -> None:
    numbers = [(1 << 63) + 0x1234_5678_9ABC * i for i in range(1000)]
    layout = word(field("n", "63..0", scale=scale), word_bits=64)
    column = layout.columns(pack(numbers, 64))["n"]
    assert np.array_equal(column, [float(number * scale) for number in numbers])


def test_a_value_is_rounded_to_the_nearest() -> None:
    layout = word(field("v", "15..0", signed=True, scale=Fraction(1, 4)))
    for value, raw in ((1.12, 4), (1.13, 5), (1.125, 5), (-1.125, -4), (-1.13, -5), (2, 8)):
        assert layout.encode({"v": value}) == raw & 0xFFFF


def test_integer_arrays_take_no_detour_and_no_other_result() -> None:
    layout = word(field("a", "15..8", signed=True), field("b", "7..0", gray=True))
    a, b = np.arange(-128, 128), np.arange(256, dtype=np.uint8)[::-1]
    fast = layout.words({"a": a, "b": b})
    assert (fast == layout.words({"a": a.tolist(), "b": b.tolist()})).all()
    assert layout.columns(fast)["a"].tolist() == a.tolist()
    assert layout.columns(fast)["b"].tolist() == b.tolist()


def test_64_bits_stay_exact() -> None:
    number = (1 << 64) - 3
    layout = word(field("n", "63..0"), word_bits=64)
    assert layout.decode(number) == {"n": number}
    assert layout.encode({"n": number}) == number
    signed = word(field("n", "63..0", signed=True), word_bits=64)
    assert signed.decode(number) == {"n": -3}
    assert signed.encode({"n": -3}) == number


@pytest.mark.parametrize("value", [-0.6, 255.7, math.inf, math.nan, -math.inf, 1e300])
def test_a_value_that_does_not_fit_is_refused(value: float) -> None:
    layout = word(field("v", "7..0", unit="m", offset=Fraction(1, 10)), unused=(Bits(15, 8),))
    with pytest.raises(ValueError, match=r"v must be between 0\.1 and 255\.1 m, not "):
        layout.encode({"v": value})


@pytest.mark.parametrize("value", [-129, 128])
def test_a_whole_number_that_does_not_fit_is_refused(value: int) -> None:
    layout = word(field("v", "7..0", signed=True), unused=(Bits(15, 8),))
    for values in ([0, value], np.array([0, value])):
        with pytest.raises(ValueError, match=f"v must be between -128 and 127, not {value}"):
            layout.words({"v": values})


def test_values_must_be_those_of_the_fields() -> None:
    layout = word(field("a", "15..8"), field("b", "7..0"))
    with pytest.raises(ValueError, match="values must be of a, b, not differ in b"):
        layout.encode({"a": 1})
    with pytest.raises(ValueError, match="values must be of a, b, not differ in c"):
        layout.encode({"a": 1, "b": 2, "c": 3})
    with pytest.raises(ValueError, match="each field must have as many values as a, not"):
        layout.words({"a": [1], "b": [2, 3]})


def test_no_values_make_a_word_that_is_none() -> None:
    plain = word(field("a", "15..0"))
    assert plain.encode({"a": 0}) == 0
    with pytest.raises(ValueError, match="must not make 0xffff, which is no valid word"):
        plain.words({"a": [1, 0xFFFF, 2]})
    with pytest.raises(ValueError, match="must not make 0x0, which is no valid word"):
        replace(plain, zero_is_fault=True).encode({"a": 0})
    with pytest.raises(ValueError, match="must not make 0x12, which is no valid word"):
        replace(plain, fault_word=0x12).encode({"a": 0x12})


@pytest.mark.parametrize(
    ("fields", "settings", "error"),
    [
        ([], {}, "a word must have at least one field, not none"),
        (
            [field("a", "15..8"), field("a", "7..0")],
            {},
            'fields must have different names, not two "a"',
        ),
        ([field("a", "16..0")], {}, r'field "a" must be in bits 15\.\.0, not 16\.\.0'),
        (
            [field("a", "15..8"), field("b", "8..0")],
            {},
            r'field "b" must not share bits with field "a" \(15\.\.8\), not be 8\.\.0',
        ),
        (
            [field("a", "15..0"), field("b", "9..3")],
            {},
            r'field "b" must not share bits with field "a" \(15\.\.0\), not be 9\.\.3',
        ),
        (
            [field("a", "15..0")],
            {"check": EVEN},
            r'the check must not share bits with field "a" \(15\.\.0\), not be 0',
        ),
        (
            [field("a", "15..8"), field("b", "6..0")],
            {},
            "each bit must be of a field, the check or unused, not bits 7",
        ),
        ([field("a", "14..0")], {}, r"or unused, not bits 15"),
        ([field("a", "15..4")], {}, r"or unused, not bits 3\.\.0"),
        (
            [field("a", "15..4")],
            {"unused": (Bits(4, 0),)},
            r"unused must not share bits with field",
        ),
        ([field("a", "15..0")], {"word_bits": 7}, "word_bits must be between 8 and 512, not 7"),
        ([field("a", "15..0")], {"fault_word": 1 << 16}, "fault_word must have 16 bits"),
        (
            [field("a", "15..0")],
            {"check": Check(width=16, polynomial=1)},
            "check must be narrower than the word's 16 bits, not 16",
        ),
    ],
)
def test_a_layout_that_cannot_be_is_refused(
    fields: list[WordField], settings: dict[str, object], error: str
) -> None:
    with pytest.raises(ValueError, match=error):
        word(*fields, **settings)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("bits", "settings", "error"),
    [
        ("64..0", {}, r"bits must be at most 64, not 65 \(64\.\.0\)"),
        ("7..0", {"name": "a b"}, 'name must be letters, digits and _, as speed_2, not "a b"'),
        ("7..0", {"scale": Fraction(0)}, "scale must be between 1e-30 and 1e30 in size, not 0"),
        ("7..0", {"scale": Fraction(10**31)}, "scale must be between 1e-30 and 1e30 in size"),
        ("7..0", {"offset": Fraction(-(10**31))}, "offset must be at most 1e30 in size"),
    ],
)
def test_a_field_that_cannot_be_is_refused(
    bits: str, settings: dict[str, object], error: str
) -> None:
    with pytest.raises(ValueError, match=error):
        field(**{"name": "a", "bits": bits, **settings})  # type: ignore[arg-type]


@pytest.mark.parametrize("text", ["24..63", "", "a", "3..", "1.5", "-1", "7...0", "99999", "٣"])
def test_bits_that_cannot_be_are_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"bits must be msb\.\.lsb, as 63\.\.24"):
        Bits.of(text)


def test_bits_are_written_as_they_are_read() -> None:
    for text in ("63..24", "7"):
        assert str(Bits.of(text)) == text


def test_a_layout_makes_the_links_configuration() -> None:
    layout = word(field("a", "15..8"), fault_word=7, zero_is_fault=True, check=CRC8)
    link = layout.applied_to(Config(tolerated_cycles=5))
    assert link == Config(
        tolerated_cycles=5, word_bits=16, fault_word=7, zero_is_fault=True, check=CRC8
    )


@pytest.mark.shows("LNK-7")
def test_what_the_check_says_of_data_is_said() -> None:
    assert guarantee(None) == "without a check field a fault of DATA alone is not seen"
    assert guarantee(CRC8) == "of words with random DATA one in 256 passes the check field"


@pytest.mark.shows("LNK-7")
def test_of_all_words_the_stated_part_passes_the_check() -> None:
    numbers = np.arange(1 << 16, dtype=np.uint64)
    layout = word(field("a", "15..8"), fault_word=0xFF, check=CRC8)
    passed = sound(parted(numbers, 16), replace(layout.config, fault_word=1)).sum()
    assert passed == (1 << 16) // 256
