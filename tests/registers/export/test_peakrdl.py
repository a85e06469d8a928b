"""The C header, compiled, and the pages: made by PeakRDL of the map's SystemRDL."""

import re
import shutil
import subprocess
import sys
from enum import IntFlag

import pytest

from railgate.registers import Map
from railgate.registers.export import c_header, html
from registers.maps import every_kind, unit

pytestmark = pytest.mark.shows("SYS-1")


def compiled(source: str, folder) -> list[str]:
    """What a C program prints."""
    (folder / "main.c").write_text(source)
    found = shutil.which("cc")
    compiler = [found] if found else [sys.executable, "-m", "ziglang", "cc"]
    command = [*compiler, "-std=gnu11", "-Wall", "-Werror", "-o", "main", "main.c"]
    subprocess.run(command, cwd=folder, check=True)
    run = subprocess.run([folder / "main"], check=True, capture_output=True, text=True)
    return run.stdout.splitlines()


def registers(map_: Map) -> dict[str, int]:
    """Each word's member in the header's structure, with its address."""
    found = {}
    for base, block in map_.blocks.items():
        for place in block.places:
            words = place.register.words
            name = place.register.name
            for word in range(words):
                part = f"{name}_{word}" if words > 1 else name
                if place.group is None:
                    found[f"{block.name}.{part}"] = base + place.offset + 4 * word
                    continue
                group = f"{block.name}.{place.group.name}"
                found[f"{group}.{part}"] = base + place.offset + 4 * word
                found[f"{group}_again.{part}"] = base + place.again + 4 * word
    return found


@pytest.mark.parametrize("make", [unit, every_kind], ids=["unit", "every kind"])
def test_the_compiled_header_has_every_register_at_its_address(make, tmp_path) -> None:
    map_ = make()
    c_header(map_, tmp_path / "new" / "map.h")
    expected = registers(map_)
    prints = "\n".join(
        f'printf("%zu %zu\\n", offsetof({map_.name}_t, {member}), '
        f"sizeof((({map_.name}_t *)0)->{member}));"
        for member in expected
    )
    includes = '#include <stddef.h>\n#include <stdio.h>\n#include "new/map.h"\n'
    told = compiled(f"{includes}int main(void) {{\n{prints}\nreturn 0; }}\n", tmp_path)
    assert told == [f"{address} 4" for address in expected.values()]


def test_the_headers_masks_are_the_fields(tmp_path) -> None:
    map_ = unit()
    c_header(map_, tmp_path / "unit.h")
    text = (tmp_path / "unit.h").read_text(encoding="utf-8")
    macros = dict(re.findall(r"^#define (\w+) (\w+)$", text, re.MULTILINE))
    for block in map_.blocks.values():
        for place in block.places:
            register = place.register
            if register.words > 1:
                continue
            scope = [map_.name, block.name, f"{place.group.name}_words" if place.group else None]
            for field, shift in zip(register.fields, register.shifts, strict=True):
                if issubclass(register.values.get(field.name, int), IntFlag):
                    continue  # a macro of each flag
                parts = (*filter(None, scope), register.name, field.name)
                name = "__".join(parts).upper()
                assert int(macros[f"{name}_bm"], 16) == ((1 << field.width) - 1) << shift
                assert int(macros[f"{name}_bp"]) == shift
                assert int(macros[f"{name}_reset"], 16) == field.start
    flag = "UNIT__ODOMETER__SNAPSHOT_WORDS__SENSOR_1_STATE__SENSOR_1_FLAGS_STAMP_OVERFLOW"
    shift = map_.blocks[0].place("sensor_1_state").register.shifts[-1]
    assert int(macros[f"{flag}_bp"]) == shift + 11


def test_pages_are_written_and_tell_every_field(tmp_path) -> None:
    html(unit(), tmp_path / "pages")
    assert (tmp_path / "pages" / "index.html").exists()
    told = "".join(path.read_text(encoding="utf-8") for path in (tmp_path / "pages").rglob("*.js*"))
    for name in ("sensor_1_since_edge", "causes_unstable", "test_phase"):
        assert name in told


def test_what_cannot_be_written_or_made_is_one_line(tmp_path, monkeypatch) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("")
    with pytest.raises(ValueError, match=r"file/map\.h cannot be written: File exists"):
        c_header(unit(), blocked / "map.h")
    monkeypatch.setattr("railgate.registers.export.peakrdl.find_spec", lambda _: None)
    with pytest.raises(ValueError, match=r"html needs PeakRDL; .*railgate\[registers\]"):
        html(unit(), tmp_path)
