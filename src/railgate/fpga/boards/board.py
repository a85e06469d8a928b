"""What is known of each board."""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from dataclasses import dataclass

from amaranth.build import Platform

__all__ = ["BOARDS", "Board", "board"]


@dataclass(frozen=True, kw_only=True)
class Board:
    """One board.

    title: its full name. part: what is on it, of parts.PARTS. module, platform: where
    amaranth-boards has it. loader: the command of the usual loader, but for the bitstream. fits:
    the targets that do. pll_pad: the oscillator comes in on the pad of the part's PLL, and feeds
    that alone.
    """

    title: str
    part: str
    module: str
    platform: str
    loader: str
    fits: tuple[str, ...]
    pll_pad: bool = False

    def open(self) -> Platform:
        """The platform, of which one design can be made. Raises ValueError where it is missing."""
        try:
            module = importlib.import_module(f"amaranth_boards.{self.module}")
        except ImportError:
            raise ValueError("building needs amaranth-boards: install railgate[fpga]") from None
        return getattr(module, self.platform)()


ALL = ("odometer", "position_link", "vital_output", "fpga_1", "fpga_2")

BOARDS: Mapping[str, Board] = {
    "ulx3s-25f": Board(
        title="ULX3S 25F",
        part="ECP5-25F-6",
        module="ulx3s",
        platform="ULX3S_25F_Platform",
        loader="openFPGALoader -b ulx3s",
        fits=ALL,
    ),
    "ulx3s-85f": Board(
        title="ULX3S 85F",
        part="ECP5-85F-6",
        module="ulx3s",
        platform="ULX3S_85F_Platform",
        loader="openFPGALoader -b ulx3s",
        fits=ALL,
    ),
    "hx8k": Board(
        title="iCE40-HX8K Breakout Board",
        part="iCE40-HX8K",
        module="ice40_hx8k_b_evn",
        platform="ICE40HX8KBEVNPlatform",
        loader="iceprog -S",
        fits=("position_link",),
    ),
    "icebreaker": Board(
        title="iCEBreaker",
        part="iCE40-UP5K",
        module="icebreaker",
        platform="ICEBreakerPlatform",
        loader="iceprog",
        fits=("position_link",),
        pll_pad=True,
    ),
    "tang-nano-9k": Board(
        title="Tang Nano 9K",
        part="GW1NR-9",
        module="tang_nano_9k",
        platform="TangNano9kPlatform",
        loader="openFPGALoader -b tangnano9k",
        fits=("position_link",),
    ),
}


def board(name: str) -> Board:
    """By its name. Raises ValueError."""
    if name not in BOARDS:
        raise ValueError(f'a board must be one of {", ".join(BOARDS)}, not "{name}"')
    return BOARDS[name]
