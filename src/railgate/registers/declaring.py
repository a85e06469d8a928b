"""What functions declare their registers with."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from railgate.field import Field
from railgate.registers.register import Access, Register, Values

__all__ = ["gather", "identity"]


def gather(
    fields: Iterable[Field],
    together: Mapping[str, Sequence[str]],
    values: Mapping[str, Values],
) -> tuple[Register, ...]:
    """A register to read of each field, by its name, in their order.

    together: by the name of a register, the fields that share it; it stands where the first of them
    does. values: as of Register, of all fields. Raises ValueError.
    """
    there = {each.name: each for each in fields}
    shared = {name: register for register, names in together.items() for name in names}
    found: dict[str, tuple[Field, ...]] = {}
    for name, each in there.items():
        register = shared.get(name, name)
        found[register] = (*found.get(register, ()), each)
    if missing := {*shared, *values} - there.keys():
        raise ValueError(f"no field {', '.join(sorted(missing))} to make a register of")
    return tuple(
        Register(
            name=name,
            fields=each,
            values={own.name: values[own.name] for own in each if own.name in values},
        )
        for name, each in found.items()
    )


def identity(letters: str, version: int, digest: int) -> tuple[Register, Register]:
    """What every block begins with: which function it is, which version of its registers, and the
    digest of its configuration (SYS-5).

    letters: three, as of the function's requirements. version: 0 … 255. digest: 32 bits.
    """
    code = int.from_bytes(letters.encode("ascii"), "big")
    who = (
        Field("version", 8, "of these registers", start=version),
        Field("function", 24, f'the letters "{letters}" in ASCII', start=code),
    )
    what = (Field("digest", 32, "of the function's configuration", start=digest),)
    return (
        Register(name="identity", fields=who, access=Access.CONSTANT),
        Register(name="configuration", fields=what, access=Access.CONSTANT),
    )
