"""Layout files: what an engineer writes, and what he is told where it is wrong."""

from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from railgate.position_link.host.layout import Bits, WordField
from railgate.position_link.host.layout_file import example, parse_layout, read_layout
from railgate.position_link.spec import EVEN, ODD, Check

pytestmark = pytest.mark.shows("LNK-8")

FIELD = '[[field]]\nname = "a"\nbits = "15..0"\n'
CHECKED = '[[field]]\nname = "a"\nbits = "15..{}"\n[check]\n{}\n'


def test_the_example_is_the_word_it_says_it_is() -> None:
    layout = example()
    assert layout.word_bits == 64
    assert layout.fault_word == (1 << 64) - 1
    assert layout.zero_is_fault
    assert layout.check
    assert layout.check.of(int.from_bytes(b"123456789", "big"), 72) == 0xDF
    position, speed, sequence = layout.fields
    assert position == WordField(
        name="position", bits=Bits(47, 8), scale=Fraction(1, 1000), unit="m"
    )
    assert speed == WordField(name="speed", bits=Bits(59, 48), scale=Fraction(9, 25), unit="km/h")
    assert sequence == WordField(name="sequence", bits=Bits(63, 60))


def test_a_word_of_the_example_reads_in_metres() -> None:
    layout = example()
    word = layout.encode({"position": 31_415.926, "speed": 430.2, "sequence": 9})
    assert word >> 8 & (1 << 40) - 1 == 31_415_926
    assert word >> 48 & 0xFFF == 1195
    assert word >> 60 == 9
    assert layout.decode(word) == {"position": 31_415.926, "speed": 430.2, "sequence": 9}


def test_what_is_left_out_has_the_links_defaults() -> None:
    layout = parse_layout("word_bits = 16\n" + FIELD, "x")
    assert (layout.fault_word, layout.zero_is_fault, layout.check) == (None, False, None)
    assert layout.fields == (WordField(name="a", bits=Bits(15, 0)),)


@pytest.mark.parametrize(
    ("lines", "check"),
    [
        ('kind = "even"', EVEN),
        ('kind = "odd"', ODD),
        ('kind = "crc"\nwidth = 8\npolynomial = "0x07"', Check(width=8, polynomial=7)),
        (
            'kind = "crc"\nwidth = 4\npolynomial = 3\ninitial = 0xf\nfinal = "9"',
            Check(width=4, polynomial=3, initial=15, final=9),
        ),
    ],
)
def test_a_check_is_a_parity_or_a_crc(lines: str, check: Check) -> None:
    text = "word_bits = 16\n" + CHECKED.format(check.width, lines)
    assert parse_layout(text, "x").check == check


@pytest.mark.parametrize(
    ("written", "scale"),
    [
        ("0.1", Fraction(1, 10)),
        ("3", Fraction(3)),
        ("-2.5e-3", Fraction(-1, 400)),
        ('"360/16777216"', Fraction(360, 1 << 24)),
        ("0.30000000000000000000000001", 3 * Fraction(1, 10) + Fraction(1, 10**26)),
    ],
)
def test_scale_and_offset_are_what_is_written_to_the_last_digit(
    written: str, scale: Fraction
) -> None:
    text = f"word_bits = 16\n{FIELD}scale = {written}\noffset = {written}"
    (field,) = parse_layout(text, "x").fields
    assert (field.scale, field.offset) == (scale, scale)


def test_unused_bits_are_named() -> None:
    text = 'word_bits = 18\nunused = ["17", "16"]\n' + FIELD
    assert parse_layout(text, "x").unused == (Bits(17, 17), Bits(16, 16))


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("", "the key word_bits is missing"),
        ("word_bits = 16", "the key field is missing"),
        (
            "word_bit = 16\n" + FIELD,
            'no key "word_bit" is known; there are: word_bits, fault_word, zero_is_fault, unused,'
            " check, field",
        ),
        ("word_bits = 1.5\n" + FIELD, "word_bits must be a whole number, not 1.5"),
        ("word_bits = true\n" + FIELD, "word_bits must be a whole number, not True"),
        ('word_bits = "sixteen"\n' + FIELD, "word_bits must be a whole number, not sixteen"),
        ('word_bits = "0x__"\n' + FIELD, "word_bits must be a whole number, not 0x__"),
        ('word_bits = "016"\n' + FIELD, "word_bits must be a whole number, not 016"),
        ("word_bits = 16\nzero_is_fault = 1\n" + FIELD, "zero_is_fault must be true or false"),
        ("word_bits = 16\nunused = 3\n" + FIELD, "unused must be a list, not 3"),
        ("word_bits = 16\nunused = [3]\n" + FIELD, "unused must be a text, not 3"),
        ("word_bits = 17\n" + FIELD, "or unused, not bits 16"),
        ("word_bits = 16\nfield = 3", "field must be a list, not 3"),
        ("word_bits = 16\nfield = [3]", "field 1: a table is needed, not 3"),
        ("word_bits = 16\n[[field]]\nbits = '1'", "field 1: the key name is missing"),
        ("word_bits = 16\n[[field]]\nname = 'a'", "field a: the key bits is missing"),
        (
            "word_bits = 16\n" + FIELD + "sclae = 2",
            'field a: no key "sclae" is known; there are: name, bits, signed,',
        ),
        (
            "word_bits = 16\n[[field]]\nname = 'a'\nbits = '0..15'",
            "field a: bits must be msb..lsb, as 63..24, not 0..15",
        ),
        (
            "word_bits = 16\n[[field]]\nname = 'a'\nbits = 15",
            "field a: bits must be a text, not 15",
        ),
        ("word_bits = 16\n" + FIELD + "scale = 0", "field a: scale must be between 1e-30 and 1e30"),
        ("word_bits = 16\n" + FIELD + "scale = inf", "field a: scale must be a number, as 0.001"),
        ("word_bits = 16\n" + FIELD + "scale = 1e99999999", "field a: scale must be a number"),
        ("word_bits = 16\n" + FIELD + f"scale = 1e{10**30}", "field a: scale must be a number"),
        ("word_bits = 16\n" + FIELD + "scale = '1/0'", "field a: scale must be a number"),
        ("word_bits = 16\n" + FIELD + "unit = 3", "field a: unit must be a text, not 3"),
        ("word_bits = 16\ncheck = 3\n" + FIELD, "check: kind must be even, odd or crc, not None"),
        (
            "word_bits = 16\n" + CHECKED.format(8, 'kind = "sum"'),
            "check: kind must be even, odd or crc, not sum",
        ),
        (
            "word_bits = 16\n" + CHECKED.format(1, 'kind = "odd"\nwidth = 1'),
            'check: no key "width" is known; there are: kind',
        ),
        (
            "word_bits = 16\n" + CHECKED.format(8, 'kind = "crc"\nwidth = 8'),
            "check: the key polynomial is missing",
        ),
        (
            "word_bits = 16\n" + CHECKED.format(8, 'kind = "crc"\nwidth = 8\npolynomial = 256'),
            "check: polynomial must be between 1 and 255, not 256",
        ),
        ("word_bits =", "Invalid value (at end of document)"),
        ("a = " + "[" * 5000, "maximum recursion depth exceeded"),
        ('"\\u001b[2J" = 1', 'no key "?[2J" is known'),
    ],
)
def test_what_is_wrong_is_said_in_one_line(text: str, error: str) -> None:
    with pytest.raises(ValueError, match=r"\Alink\.toml: ") as caught:
        parse_layout(text, "link.toml")
    assert error in str(caught.value)
    assert str(caught.value).isprintable()


@given(st.text())
def test_no_text_is_met_with_anything_but_one_line(text: str) -> None:
    with pytest.raises(ValueError, match=r"\Ax: ") as caught:
        parse_layout(text, "x")
    assert str(caught.value).isprintable()


def test_a_file_is_read_or_its_name_said(tmp_path: Path) -> None:
    path = tmp_path / "link.toml"
    with pytest.raises(ValueError, match=r"link\.toml: No such file or directory\Z"):
        read_layout(path)
    path.write_bytes(b"\xff")
    with pytest.raises(ValueError, match=r"link\.toml: a layout must be text in UTF-8\Z"):
        read_layout(path)
    path.write_text("word_bits = 16\n" + FIELD, "utf-8")
    assert read_layout(path).fields[0].name == "a"
