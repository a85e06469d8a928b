"""A core's clocks and synchronisers as constraints, for the tools that read them.

Of asynchronous inputs no timing is wanted up to the first flip-flop of their synchroniser, as of
inputs that stand still while they are read. What crosses from clock to clock stands still for two
ticks of the clock that reads it, so it may take one of these at most, whatever the clocks' phase.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction

from railgate.fpga.export.borders import Borders

__all__ = ["CONSTRAINTS", "Constrained"]


@dataclass(frozen=True)
class Constrained:
    """hz: the frequency of each clock, by its port. still: inputs that stand still."""

    hz: Mapping[str, int]
    borders: Borders
    still: tuple[str, ...]

    def period_ns(self, clock: str) -> str:
        return f"{float(Fraction(10**9, self.hz[clock])):.6f}".rstrip("0").rstrip(".")

    @property
    def untimed(self) -> Iterator[tuple[str, tuple[str, ...]]]:
        """Each input that no clock is right for, as tools name its bits, and the flip-flops that it
        ends at."""
        for port in (*self.borders.synchronised, *self.still):
            bits = port if self.borders.widths[port] == 1 else f"{port}[*]"
            yield bits, self.borders.synchronised.get(port, ())


def _sdc(of: Constrained) -> Iterator[str]:
    """Synopsys Design Constraints, as most tools read them, for the core as the top module."""
    for clock in of.hz:
        yield f"create_clock -name {clock} -period {of.period_ns(clock)} [get_ports {{{clock}}}]"
    for port, _ in of.untimed:
        yield f"set_false_path -from [get_ports {{{port}}}]"
    for source, sink in of.borders.between:
        ends = f"-from [get_clocks {{{source}}}] -to [get_clocks {{{sink}}}]"
        yield f"set_max_delay {of.period_ns(sink)} {ends}"
        yield f"set_false_path -hold {ends}"


def _xdc(of: Constrained) -> Iterator[str]:
    """Vivado's, for the core wherever it is: read_xdc -ref <the core's module>."""
    for port, registers in of.untimed:
        for register in registers:
            cells = f"{register.replace('.', '/')}_reg*"
            yield f"set_false_path -to [get_pins {{{cells}/D}}]"
        if not registers:
            yield f"set_false_path -from [get_ports {{{port}}}]"
    for source, sink in of.borders.between:
        ends = (f"[get_clocks -of_objects [get_ports {{{clock}}}]]" for clock in (source, sink))
        start, end = ends
        yield f"set_max_delay -datapath_only -from {start} -to {end} {of.period_ns(sink)}"


def _lpf(of: Constrained) -> Iterator[str]:
    """Lattice's, for the core as the top module."""
    for clock, hz in of.hz.items():
        yield f'FREQUENCY PORT "{clock}" {float(Fraction(hz, 10**6)):g} MHZ;'
    for port, _ in of.untimed:
        yield f'BLOCK PATH FROM PORT "{port}";'
    for source, sink in of.borders.between:
        yield f'MAXDELAY FROM CLKNET "{source}" TO CLKNET "{sink}" {of.period_ns(sink)} NS;'


CONSTRAINTS: Mapping[str, Callable[[Constrained], Iterator[str]]] = {
    "sdc": _sdc,
    "xdc": _xdc,
    "lpf": _lpf,
}
"""By the file's suffix, its lines; all have comments that begin with #."""
