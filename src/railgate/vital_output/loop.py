"""Both channels with all that is outside their pins, as one component."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from amaranth.hdl import DomainRenamer, EnableInserter, Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.engines import Clock, Design, Model
from railgate.vital_output.gateware import Channel
from railgate.vital_output.plant.gateware import Plant
from railgate.vital_output.plant.relay import RelayTimes
from railgate.vital_output.spec import Config

__all__ = ["Loop", "loop"]

PINS = ("link_rx", "pulse_feedback", "contact")
"""A channel's inputs that the plant drives."""


class Loop(wiring.Component):
    """FPGA 1 and FPGA 2, the cross-link between them, the relays, and the feedback.

    fpga_1, fpga_2: of each channel the command stream, time, boot and test, in; link_tx, pulses and
    one of each of config.fields, out; stopped: in, 1 bit, its clock has no edges (a reset counts
    all the same). line_1, line_2, relay: in, what is wrong, see Plant; Scenario.controls drives all
    inputs. contact: out, outputs bits, the relays'.
    Domains: fpga_1, fpga_2, relay. delay_ticks: of each line.
    """

    def __init__(self, config: Config, relay: RelayTimes, delay_ticks: int = 0) -> None:
        self._channels = tuple(Channel(config, board) for board in range(2))
        self._plant = Plant(config, relay, delay_ticks)
        members = self._channels[0].signature.members
        self._told = {name: member for name, member in members.items() if name not in PINS}
        plant = self._plant.signature.members
        around = {name: plant[name] for name in ("line_1", "line_2", "relay", "contact")}
        fpga = wiring.Signature({**self._told, "stopped": In(1)})
        super().__init__({"fpga_1": Out(fpga), "fpga_2": Out(fpga)} | around)

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        m.submodules.plant = plant = self._plant
        for c, channel in enumerate(self._channels, 1):
            own, pins = getattr(self, f"fpga_{c}"), getattr(plant, f"fpga_{c}")
            m.submodules[f"fpga_{c}"] = DomainRenamer(f"fpga_{c}")(
                EnableInserter(~own.stopped)(channel)
            )
            for name, member in self._told.items():
                if member.is_signature:
                    inner = wiring.flipped(getattr(own, name))
                    wiring.connect(m, inner, getattr(channel, name))
                elif member.flow == In:
                    m.d.comb += getattr(channel, name).eq(getattr(own, name))
                else:
                    m.d.comb += getattr(own, name).eq(getattr(channel, name))
            m.d.comb += [
                pins.stopped.eq(own.stopped),
                pins.link_tx.eq(channel.link_tx),
                pins.pulses.eq(channel.pulses),
                channel.link_rx.eq(pins.link_rx),
                channel.pulse_feedback.eq(pins.pulse_feedback),
                channel.contact.eq(plant.contact_feedback),
            ]
        for name in ("line_1", "line_2", "relay"):
            wiring.connect(m, wiring.flipped(getattr(self, name)), getattr(plant, name))
        m.d.comb += self.contact.eq(plant.contact)
        return m


def loop(
    config: Config, relay: RelayTimes, clocks: Sequence[Clock], delay_ticks: int = 0
) -> Design:
    """The closed loop with the clocks of fpga_1, fpga_2 and relay, see Scenario.clocks."""

    def model() -> Model:
        from railgate.vital_output.model import PairModel

        return PairModel(config, relay, clocks, delay_ticks)

    return Design(
        name="vital-output-pair",
        component=partial(Loop, config, relay, delay_ticks),
        clocks=tuple(clocks),
        model=model,
    )
