"""The parts that functions are placed on, and what each has."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields

__all__ = ["PARTS", "REFERENCE", "Area", "Part", "part"]


@dataclass(frozen=True)
class Area:
    """What a netlist takes of a part, or what the part has.

    lut: look-up tables of four inputs, those used as carries and memory too. ff: flip-flops.
    ram: block RAMs. dsp: multipliers.
    """

    lut: int = 0
    ff: int = 0
    ram: int = 0
    dsp: int = 0

    def __add__(self, other: Area) -> Area:
        return Area(*(getattr(self, f.name) + getattr(other, f.name) for f in fields(Area)))

    def __mul__(self, times: int) -> Area:
        return Area(*(getattr(self, f.name) * times for f in fields(Area)))


@dataclass(frozen=True, kw_only=True)
class Part:
    """One device of one speed grade.

    has: all of it. plls: how many of these. synthesis: Yosys's command for its family. nextpnr: the
    tool's architecture, by which its package and its program are called. options: the tool's, of
    this device. takes: what each cell of a netlist takes. free_pins: the tool places ports that no
    constraint names.
    """

    has: Area
    plls: int
    synthesis: str
    nextpnr: str
    options: tuple[str, ...]
    takes: Mapping[str, Area]
    free_pins: bool = True


LUT, FF, RAM, DSP, FREE = Area(lut=1), Area(ff=1), Area(ram=1), Area(dsp=1), Area()

_ECP5 = {
    "LUT4": LUT,
    "CCU2C": LUT * 2,
    "TRELLIS_DPR16X4": LUT * 6,  # four as memory, two as its write port
    "PFUMX": FREE,  # in the slice of the tables that it selects from, as the next
    "L6MUX21": FREE,
    "TRELLIS_FF": FF,
    "DP16KD": RAM,
    "PDPW16KD": RAM,
    "MULT18X18D": DSP,
    **dict.fromkeys(("IB", "OB", "OBZ", "BB", "TRELLIS_IO", "EHXPLLL"), FREE),
}

_ICE40 = {
    "SB_LUT4": LUT,
    "SB_CARRY": FREE,  # in the logic cell of the table that it feeds
    "SB_RAM40_4K": RAM,
    **{f"SB_DFF{e}{r}": FF for e in ("", "E") for r in ("", "R", "S", "SR", "SS")},
    **dict.fromkeys(("SB_IO", "SB_GB_IO", "SB_GB", "SB_PLL40_CORE", "SB_PLL40_PAD"), FREE),
}

_GOWIN = {
    **{f"LUT{inputs}": LUT for inputs in range(1, 5)},
    "ALU": LUT,
    **{f"MUX2_LUT{inputs}": FREE for inputs in range(5, 9)},
    "RAM16SDP4": LUT * 4,
    **{f"DFF{r}{e}": FF for e in ("", "E") for r in ("", "R", "S", "P", "C")},
    **dict.fromkeys(("SP", "SPX9", "SDPB", "SDPX9B", "DPB", "DPX9B"), RAM),
    **dict.fromkeys(("IBUF", "OBUF", "TBUF", "IOBUF", "rPLL", "GND", "VCC"), FREE),
}

REFERENCE = "ECP5-25F-6"
"""The part that goals are set for."""

PARTS: Mapping[str, Part] = {
    REFERENCE: Part(
        has=Area(lut=24_288, ff=24_288, ram=56, dsp=28),
        plls=2,
        synthesis="synth_ecp5",
        nextpnr="ecp5",
        options=("--25k", "--package", "CABGA381", "--speed", "6", "--lpf-allow-unconstrained"),
        takes=_ECP5,
    ),
    "iCE40-HX8K": Part(
        has=Area(lut=7_680, ff=7_680, ram=32),
        plls=2,
        synthesis="synth_ice40",
        nextpnr="ice40",
        options=("--hx8k", "--package", "ct256", "--pcf-allow-unconstrained"),
        takes=_ICE40,
    ),
    "ECP5-85F-6": Part(
        has=Area(lut=83_640, ff=83_640, ram=208, dsp=156),
        plls=4,
        synthesis="synth_ecp5",
        nextpnr="ecp5",
        options=("--85k", "--package", "CABGA381", "--speed", "6", "--lpf-allow-unconstrained"),
        takes=_ECP5,
    ),
    "iCE40-UP5K": Part(
        has=Area(lut=5_280, ff=5_280, ram=30, dsp=8),
        plls=1,
        synthesis="synth_ice40",
        nextpnr="ice40",
        options=("--up5k", "--package", "sg48", "--pcf-allow-unconstrained"),
        takes=_ICE40,
    ),
    "GW1NR-9": Part(
        has=Area(lut=8_640, ff=6_480, ram=26, dsp=20),
        plls=2,
        synthesis="synth_gowin",
        nextpnr="himbaechel-gowin",
        options=("--device", "GW1NR-LV9QN88PC6/I5", "--vopt", "family=GW1N-9C"),
        takes=_GOWIN,
        free_pins=False,
    ),
}


def part(name: str, *, free_pins: bool = False) -> Part:
    """By its name. free_pins: it is one on which ports need no pins. Raises ValueError."""
    there = [each for each, part in PARTS.items() if part.free_pins or not free_pins]
    if name not in there:
        raise ValueError(f'a part must be one of {", ".join(there)}, not "{name}"')
    return PARTS[name]
