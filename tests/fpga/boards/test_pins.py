"""Files of pins: the boards' own, and what is wrong with others, told with its line."""

import pytest

from railgate.fpga.boards import BOARDS, board, builtin_pins, read_pins
from railgate.fpga.gateware.top import PINS, TARGETS, Top
from railgate.unit.config import Unit

UNIT = Unit()

FILE = """\
[attributes]
IO_TYPE = "LVCMOS33"

[uart]
rx = "M1"
tx = "L4"

[channel]
cpu_rx = "gpio_0:5+"
link_rx = "gpio_0:6+"
link_tx = "gpio_0:6-"
pulses = ["gpio_0:7+", "A4"]
pulse_feedback = ["gpio_0:7-", "gpio_0:8-"]
contact = ["gpio_0:9+", "gpio_0:9-"]
"""


def read(tmp_path, text: str, target: str = "vital_output"):
    file = tmp_path / "mine.toml"
    file.write_text(text, "utf-8")
    return read_pins(file, Top(UNIT, target).signature, board("ulx3s-25f").open())


@pytest.mark.shows("SYS-3")
@pytest.mark.parametrize("on", BOARDS)
@pytest.mark.parametrize("target", TARGETS)
def test_a_board_has_its_own_pins_for_every_target(on, target) -> None:
    top = Top(UNIT, target)
    pins = builtin_pins(on, top.signature, board(on).open())
    assert [pin.path for pin in pins] == [path for path, _, _ in top.signature.flatten(top)]
    package = [name for pin in pins for name in pin.package]
    assert len(package) == len(set(package))


def test_a_pin_of_a_connector_is_one_of_the_package(tmp_path) -> None:
    pins = {pin.path: pin for pin in read(tmp_path, FILE)}
    assert pins["channel", "pulses"].package == ("A6", "A4")
    assert pins["channel", "pulses"].out
    assert not pins["channel", "contact"].out
    assert {tuple(pin.attributes.items()) for pin in pins.values()} == {(("IO_TYPE", "LVCMOS33"),)}


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("[uart]", "[usart]", '4: no table "usart" is known; there are: uart, sensor_1, .*'),
        ("tx = ", "tax = ", '6: no key "tax" is known; there are: rx, tx'),
        ('tx = "L4"\n', "", "4: the key tx is missing"),
        ('"L4"', "4", '6: tx must be a pin, as "A1", not 4'),
        ('"L4"', '["L4", "L5"]', '6: tx must be a pin, as "A1", not .*'),
        (', "A4"]', "]", "12: pulses must be a list of 2 pins, not .*"),
        ("gpio_0:5+", "gpio_0:99", "9: cpu_rx must be at one of 0\\+, 0-, .*, not gpio_0:99"),
        ("gpio_0:5+", "pmod_0:1", "9: cpu_rx must be at one of gpio_0, not pmod_0:1"),
        ("gpio_0:5+", "L4", "9: cpu_rx: pin L4 must be free, not uart.tx's"),
        ("gpio_0:5+", "G2", "9: cpu_rx: pin G2 must be free, not the oscillator's"),
        ('"A4"', '"gpio_0:7+"', "12: pulses: pins must differ, not be gpio_0:7\\+, gpio_0:7\\+"),
        ('"LVCMOS33"', "true", "2: IO_TYPE must be a text or a whole number"),
        ("[attr", "link = 3\n[attr", "1: link must be a table, \\[link\\]"),
        ("[channel]", "[link]", '9: no key "cpu_rx" is known; there are: clk, .*'),
        ("[uart]", "[uart", " Expected .*"),
    ],
)
def test_what_is_wrong_is_told_in_one_line_with_its_place(tmp_path, old, new, says) -> None:
    with pytest.raises(ValueError, match=rf"mine\.toml:{says}$") as told:
        read(tmp_path, FILE.replace(old, new))
    assert "\n" not in str(told.value)


def test_a_table_that_the_target_needs_must_be_there(tmp_path) -> None:
    with pytest.raises(ValueError, match=r"mine\.toml:1: the table sensor_1 is missing$"):
        read(tmp_path, FILE, "odometer")


def test_a_file_that_cannot_be_read_is_told(tmp_path) -> None:
    needed, platform = Top(UNIT, "odometer").signature, board("ulx3s-25f").open()
    with pytest.raises(ValueError, match="No such file"):
        read_pins(tmp_path / "none.toml", needed, platform)
    (tmp_path / "bytes").write_bytes(b"\xff\xfe")
    with pytest.raises(ValueError, match="a file of pins must be text in UTF-8"):
        read_pins(tmp_path / "bytes", needed, platform)


def test_a_board_that_is_not_there_is_told() -> None:
    with pytest.raises(ValueError, match=r'one of ulx3s-25f, .*, tang-nano-9k, not "versa"'):
        board("versa")


def test_boards_name_targets_and_members_that_there_are() -> None:
    assert all(set(each.fits) <= set(TARGETS) for each in BOARDS.values())
    assert all(PINS.values())
