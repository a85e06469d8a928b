"""What stands at the beginning of each file: what it is, of what, and all of its ports."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from dataclasses import fields
from importlib.metadata import version
from textwrap import wrap

from railgate.digest import digest
from railgate.engines.border import flat
from railgate.fpga.export.borders import Borders
from railgate.fpga.export.targets import Core

__all__ = ["described", "heading"]

LICENCE = "Apache-2.0"
WIDTH = 96
MEANINGS = ("common_fields", "sensor_fields", "fields")
"""Where a configuration tells of its ports."""


def heading(core: Core) -> list[str]:
    """Name, version, licence, and the digest of each function's configuration (SYS-5)."""
    digests = (f"{name} 0x{digest(config):08x}" for name, config in core.configurations.items())
    return [
        f"{core.name}: {core.title}",
        f"railgate {version('railgate')}, Amaranth {version('amaranth')}",
        f"SPDX-License-Identifier: {LICENCE}",
        f"Digest of the configuration: {', '.join(digests)}",
    ]


def described(core: Core, borders: Borders) -> list[str]:
    """The heading, each function's configuration, the contract, and the ports."""
    lines = heading(core)
    for function, config in core.configurations.items():
        lines += ["", f"Configuration of {function}:"]
        lines += (f"  {each.name} = {getattr(config, each.name)}" for each in fields(config))
    lines += ["", "Contract (a member of an interface is a port a__b):"]
    for contract in core.contract:
        told = inspect.getdoc(contract) or ""
        lines += ["", *(f"  {line}".rstrip() for line in told.splitlines())]
    lines += ["", "Ports: direction, bits, clock, meaning"]
    for line in _ports(core, borders):
        lines += wrap(line, WIDTH, initial_indent="  ", subsequent_indent=" " * 8)
    return lines


def _ports(core: Core, borders: Borders) -> Iterator[str]:
    meanings = {
        field.name: field.meaning + (f", {field.unit}" if field.unit else "")
        for config in core.configurations.values()
        for name in MEANINGS
        for field in getattr(config, name, ())
    }
    for domain, hz in core.hz.items():
        yield f"{domain}_clk: in, 1, rising edge, {hz} Hz"
        yield f"{_reset(domain)}: in, 1, {domain}_clk, synchronous, active high"
    for path, member, _ in core.component.signature.flatten(core.component):
        name = flat(path)
        clock = ", ".join(borders.clocks[name])
        if name in borders.synchronised:
            clock = "asynchronous"
        elif name in core.still:
            clock = "asynchronous, stands still while it is read"
        parts = [member.flow.name.lower(), str(borders.widths[name]), clock or "none"]
        if (meaning := meanings.get(str(path[-1]))) is not None:
            parts.append(meaning)
        yield f"{name}: {', '.join(parts)}"


def _reset(domain: str) -> str:
    return "rst" if domain == "sync" else f"{domain}_rst"
