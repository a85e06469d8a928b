"""The clock of a domain, by a PLL of the part, and its reset."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from amaranth.hdl import ClockDomain, ClockSignal, Const, Instance, IOValue, Module, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.cdc import FFSynchronizer
from amaranth.lib.wiring import In, Out

from railgate.fpga.pll import Setting

__all__ = ["PLLS", "Start"]

SETTLE_S = Fraction(20, 1_000_000)
"""Longer than block RAMs of an iCE40 read zeros after it has been configured."""


class Start(wiring.Component):
    """Resets a domain of a clock from the part's configuration on until the PLL has held its lock
    for SETTLE_S, and again where it loses it.

    clk, locked: in, 1 bit, the PLL's. rst: out, 1 bit, register of that clock.
    """

    def __init__(self, clock_hz: int) -> None:
        self._ticks = int(SETTLE_S * clock_hz)
        super().__init__({"clk": In(1), "locked": In(1), "rst": Out(1, init=1)})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        m.domains.start = start = ClockDomain(reset_less=True, local=True)
        locked, held = Signal(), Signal(range(self._ticks + 1))
        m.submodules.locked = FFSynchronizer(self.locked, locked, o_domain="start")
        m.d.comb += start.clk.eq(self.clk)
        m.d.start += [self.rst.eq(held != self._ticks), held.eq(0)]
        with m.If(locked):
            m.d.start += held.eq(held + (held != self._ticks))
        return m


class Pll(wiring.Component):
    """reference: the oscillator. clk: out, 1 bit. locked: out, 1 bit, asynchronous."""

    def __init__(self, setting: Setting, reference: Value | IOValue) -> None:
        self._setting = setting
        self._reference = reference
        super().__init__({"clk": Out(1), "locked": Out(1)})


class Ecp5Pll(Pll):
    """See Pll."""

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        feedback = Signal()
        dividers = self._setting.parameters
        m.submodules.pll = Instance(
            "EHXPLLL",
            a_ICP_CURRENT="12",
            a_LPF_RESISTOR="8",
            a_MFG_ENABLE_FILTEROPAMP="1",
            a_MFG_GMCREF_SEL="2",
            **{f"p_{name}": value for name, value in dividers.items()},
            p_FEEDBK_PATH="CLKOP",
            p_CLKOP_ENABLE="ENABLED",
            p_CLKOP_CPHASE=dividers["CLKOP_DIV"] - 1,
            p_CLKOS_ENABLE="ENABLED",
            p_CLKOS_CPHASE=dividers["CLKOS_DIV"] - 1,
            i_CLKI=self._reference,
            i_CLKFB=feedback,
            i_RST=Const(0),
            i_STDBY=Const(0),
            i_PLLWAKESYNC=Const(0),
            i_ENCLKOP=Const(0),
            i_ENCLKOS=Const(0),
            o_CLKOP=feedback,
            o_CLKOS=self.clk,
            o_LOCK=self.locked,
        )
        return m


class Ice40Pll(Pll):
    """See Pll; reference: a signal, or the pad itself, if it is the PLL's own. Behind the PLL a
    counter divides, whose clock is high for one part of so many."""

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        m.domains.pll = pll = ClockDomain(reset_less=True, local=True)
        pad = isinstance(self._reference, IOValue)
        m.submodules.pll = Instance(
            "SB_PLL40_PAD" if pad else "SB_PLL40_CORE",
            **{f"p_{name}": value for name, value in self._setting.parameters.items()},
            p_FEEDBACK_PATH="SIMPLE",
            **{"i_PACKAGEPIN" if pad else "i_REFERENCECLK": self._reference},
            i_RESETB=Const(1),
            i_BYPASS=Const(0),
            o_PLLOUTGLOBAL=pll.clk,
            o_LOCK=self.locked,
        )
        divide = self._setting.divide
        if divide == 1:
            m.d.comb += self.clk.eq(ClockSignal("pll"))
        else:
            count, clock = Signal(range(divide)), Signal()
            last = count == divide - 1
            m.d.pll += [count.eq(count + 1), clock.eq(last)]
            with m.If(last):
                m.d.pll += count.eq(0)
            m.d.comb += self.clk.eq(clock)
        return m


class GowinPll(Pll):
    """See Pll."""

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        divide = self._setting.divide
        output = {1: "CLKOUT", 3: "CLKOUTD3"}.get(divide, "CLKOUTD")
        selects = {"FBDSEL": 6, "IDSEL": 6, "ODSEL": 6, "PSDA": 4, "DUTYDA": 4, "FDLY": 4}
        m.submodules.pll = Instance(
            "rPLL",
            **{f"p_{name}": value for name, value in self._setting.parameters.items()},
            p_DYN_SDIV_SEL=divide if output == "CLKOUTD" else 2,
            p_FCLKIN="27",
            p_DYN_IDIV_SEL="false",
            p_DYN_FBDIV_SEL="false",
            p_DYN_ODIV_SEL="false",
            p_DYN_DA_EN="false",
            p_DUTYDA_SEL="1000",
            p_PSDA_SEL="0000",
            p_CLKFB_SEL="internal",
            p_CLKOUT_BYPASS="false",
            p_CLKOUTP_BYPASS="false",
            p_CLKOUTD_BYPASS="false",
            p_CLKOUTD_SRC="CLKOUT",
            p_CLKOUTD3_SRC="CLKOUT",
            p_DEVICE="GW1NR-9C",
            i_CLKIN=self._reference,
            i_CLKFB=Const(0),
            i_RESET=Const(0),
            i_RESET_P=Const(0),
            **{f"i_{name}": Const(0, width) for name, width in selects.items()},
            o_LOCK=self.locked,
            **{f"o_{output}": self.clk},
        )
        return m


PLLS: Mapping[str, type[Pll]] = {
    "ecp5": Ecp5Pll,
    "ice40": Ice40Pll,
    "himbaechel-gowin": GowinPll,
}
"""By nextpnr's name of the architecture, as pll.FAMILIES."""
