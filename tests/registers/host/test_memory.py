"""Registers in memory: a file that is mapped."""

from pathlib import Path

import numpy as np
import pytest

from railgate.registers.host import AccessError, MemoryBus, Registers
from registers.maps import every_kind

pytestmark = pytest.mark.shows("SYS-1")

BASE = 4096 + 64
SIZE = 64


@pytest.fixture
def file(tmp_path) -> Path:
    path = tmp_path / "registers"
    path.write_bytes(bytes(BASE) + np.arange(0xA000, 0xA020, dtype=np.uint32).tobytes())
    return path


def test_words_are_read_and_written_where_they_are(file) -> None:
    with MemoryBus(file, SIZE, BASE) as bus:
        assert bus.read(0) == [0xA000]
        assert bus.read(8, 3) == [0xA002, 0xA003, 0xA004]
        bus.write(4, [0xFFFF_FFFF, 0x1234_5678])
        assert bus.read(0, 4) == [0xA000, 0xFFFF_FFFF, 0x1234_5678, 0xA003]
    words = np.frombuffer(file.read_bytes(), np.uint32)[BASE // 4 :]
    assert words[:4].tolist() == [0xA000, 0xFFFF_FFFF, 0x1234_5678, 0xA003]


def test_what_is_not_mapped_is_refused(file) -> None:
    with MemoryBus(file, SIZE, BASE) as bus:
        assert bus.read(SIZE - 4) == [0xA00F]
        for access in (lambda: bus.read(SIZE), lambda: bus.read(SIZE - 4, 2)):
            with pytest.raises(AccessError, match="not all of it is mapped, at address 0x"):
                access()
        with pytest.raises(ValueError, match="address must be a multiple of 4, not 0x6"):
            bus.write(6, [1])


def test_a_word_is_one_access_of_32_bits(file) -> None:
    """No byte of the neighbours is touched by a write, none is left out."""
    with MemoryBus(file, SIZE, BASE) as bus:
        bus.write(4, [0xFFFF_FFFF])
    whole = file.read_bytes()[BASE : BASE + 12]
    assert whole == b"\x00\xa0\x00\x00" + b"\xff" * 4 + b"\x02\xa0\x00\x00"


@pytest.mark.parametrize(
    ("path", "says"),
    [
        ("/none", "/none cannot be mapped: No such file or directory"),
        ("/dev/null", "/dev/null cannot be mapped: "),
    ],
)
def test_what_cannot_be_mapped_is_told(path, says) -> None:
    with pytest.raises(ValueError, match=says):
        MemoryBus(Path(path), SIZE)


def test_a_file_too_short_is_told(file) -> None:
    with pytest.raises(ValueError, match="registers cannot be mapped: "):
        MemoryBus(file, 4096, BASE)


def test_a_block_is_read_and_written_by_name(file) -> None:
    """Fields of every kind, alone and in a group, at both of its places."""
    (block,) = every_kind().blocks.values()
    with MemoryBus(file, block.size, 4096) as bus:
        registers = Registers(bus, block)
        for place in block.places:
            for offset in filter(None, (place.offset, place.again)):
                bus.write(offset, [0] * place.register.words)
        registers.write("setting", level=-200, mode=2)
        assert registers.read("setting") == {"level": -200, "mode": 2}
        registers.write("setting", mode=1)
        assert registers.read("setting") == {"level": 0, "mode": 1}
        group = block.place("number")
        far, modes = ((1 << 70) - 5, 0x12_3456_789A)
        words = [far >> 32 * n & 0xFFFF_FFFF for n in range(3)] + [0x3456_789A, 0x12]
        bus.write(group.offset, words)
        assert registers.read("number") == {"far": -5, "modes": modes}
        assert registers.read("modes") == {"modes": modes}
        assert registers.read("number", again=True) == {"far": 0, "modes": 0}
        bus.write(group.again + 12, [7, 0])
        assert registers.read("modes", again=True) == {"modes": 7}
    for wrong, says in (
        (lambda: registers.read("level"), 'no register "level" in field'),
        (lambda: registers.read("setting", again=True), "setting is in no group"),
        (lambda: registers.write("setting", level=256), "level must be between -256 and 255"),
    ):
        with pytest.raises(ValueError, match=says):
            wrong()
