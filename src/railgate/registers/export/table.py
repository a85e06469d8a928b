"""The map as a person reads it, field by field."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from rich.table import Table

from railgate.registers.block import Block, Place
from railgate.registers.map import Map

__all__ = ["rows", "show"]


def rows(map_: Map) -> list[dict[str, Any]]:
    """One of each field, as plain numbers and strings; see docs/commands.md."""
    return [
        row
        for base, block in map_.blocks.items()
        for place in block.places
        for row in _rows(base, block, place)
    ]


def _rows(base: int, block: Block, place: Place) -> Iterator[dict[str, Any]]:
    register = place.register
    for field, shift in zip(register.fields, register.shifts, strict=True):
        yield {
            "block": block.name,
            "group": place.group.name if place.group else None,
            "register": register.name,
            "address": base + place.offset,
            "again": None if place.again is None else base + place.again,
            "access": register.access.value,
            "field": field.name,
            "low": shift,
            "width": field.width,
            "signed": field.signed,
            "start": field.start,
            "unit": field.unit,
            "meaning": field.meaning,
        }


def show(map_: Map) -> Table:
    """A table of each field; a group's two places are told with its registers."""
    table = Table(box=None, pad_edge=False)
    for title in ("address", "again", "register", "access", "bits", "field", "meaning"):
        table.add_column(title, overflow="fold")
    told, section = "", ""
    for row in rows(map_):
        if section != (section := f"{row['block']} {row['group'] or ''}"):
            table.add_section()
            table.add_row("", "", f"[bold]{section}[/bold]")
        first = told != (told := f"{row['block']}.{row['register']}")
        high = row["low"] + row["width"] - 1
        table.add_row(
            f"{row['address']:#06x}" if first else "",
            f"{row['again']:#06x}" if first and row["again"] is not None else "",
            row["register"] if first else "",
            row["access"] if first else "",
            f"{high}:{row['low']}" if row["width"] > 1 else str(row["low"]),
            row["field"] if row["field"] != row["register"] else "",
            f"{row['meaning']}, {row['unit']}" if row["unit"] else row["meaning"],
        )
    return table
