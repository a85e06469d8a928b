"""The boards that bitstreams are built for; where their pins go is in a TOML file each beside this.

The platforms, with oscillators and connectors, are those of amaranth-boards.
"""

from railgate.fpga.boards.board import BOARDS, Board, board
from railgate.fpga.boards.pins import Pin, builtin_pins, read_pins

__all__ = ["BOARDS", "Board", "Pin", "board", "builtin_pins", "read_pins"]
