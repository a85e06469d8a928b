"""All that answers within ticks outside the pins of the two FPGAs."""

from __future__ import annotations

from amaranth.hdl import DomainRenamer, EnableInserter, Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.vital_output.plant.gateware.line import DISTURBANCE, Line, held
from railgate.vital_output.plant.gateware.relay import Relay
from railgate.vital_output.plant.relay import DEFECTS, FEEDBACK, RelayTimes
from railgate.vital_output.spec import Config

__all__ = ["Plant"]


class Plant(wiring.Component):
    """Cross-link, relays and feedback.

    fpga_1, fpga_2: of each FPGA link_tx (1 bit), pulses (outputs), its outputs, and stopped (1),
    in; link_rx (1) and pulse_feedback (outputs), its inputs, out. line_1, line_2: a DISTURBANCE
    each, of FPGA 1's line and of FPGA 2's. relay: in, outputs bits each, what is wrong with relays
    and feedback, see DEFECTS and FEEDBACK. contact: out, outputs bits, the relays'.
    contact_feedback: out, outputs bits, what both FPGAs see of it.
    Domains: fpga_1, fpga_2, relay. delay_ticks: of each line.
    """

    def __init__(self, config: Config, times: RelayTimes, delay_ticks: int = 0) -> None:
        self._relay = Relay(config, times)
        self._delay_ticks = delay_ticks
        outputs = config.outputs
        fpga = wiring.Signature(
            {
                "link_tx": In(1),
                "pulses": In(outputs),
                "stopped": In(1),
                "link_rx": Out(1),
                "pulse_feedback": Out(outputs),
            }
        )
        defects = wiring.Signature({name: In(outputs) for name in (*DEFECTS, *FEEDBACK)})
        super().__init__(
            {
                "fpga_1": Out(fpga),
                "fpga_2": Out(fpga),
                "line_1": Out(DISTURBANCE),
                "line_2": Out(DISTURBANCE),
                "relay": Out(defects),
                "contact": Out(outputs),
                "contact_feedback": Out(outputs),
            }
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        by = self.relay
        m.submodules.relay = DomainRenamer("relay")(self._relay)
        m.d.comb += [getattr(self._relay, name).eq(getattr(by, name)) for name in DEFECTS]
        m.d.comb += [
            self._relay.pulses_1.eq(self.fpga_1.pulses),
            self._relay.pulses_2.eq(self.fpga_2.pulses),
            self.contact.eq(self._relay.contact),
            self.contact_feedback.eq(held(self.contact, by.contact_open, by.contact_stuck)),
            self.fpga_1.pulse_feedback.eq(held(self.fpga_1.pulses, by.open_1, by.stuck_1)),
            self.fpga_2.pulse_feedback.eq(held(self.fpga_2.pulses, by.open_2, by.stuck_2)),
        ]
        for c, sender, receiver in ((1, self.fpga_1, self.fpga_2), (2, self.fpga_2, self.fpga_1)):
            line = Line(self._delay_ticks)
            m.submodules[f"line_{c}"] = DomainRenamer(f"fpga_{c}")(
                EnableInserter(~sender.stopped)(line)
            )
            wiring.connect(m, wiring.flipped(getattr(self, f"line_{c}")), line.disturbance)
            m.d.comb += [line.source.eq(sender.link_tx), receiver.link_rx.eq(line.pin)]
        return m
