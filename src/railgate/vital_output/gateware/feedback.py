"""One output's feedback: its own pulses as they come back, and the relay's contact."""

from __future__ import annotations

from amaranth.hdl import Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.primitives import FilteredInput
from railgate.vital_output.spec import Config

__all__ = ["Feedback"]


class Feedback(wiring.Component):
    """Tells whether the pulse train comes back at its frequency, and whether anything is driven.

    pulse_pin, contact_pin: in, 1 bit each, asynchronous.
    frequency: out, 1 bit, register, the last period is right. contact: out, 1 bit, register, the
    relay's is closed. fb: out, 1 bit, that, or the pulses are not 0 Hz. Requirements DRV-8, DRV-10.
    """

    def __init__(self, config: Config) -> None:
        self._config = config
        pins = ("pulse_pin", "contact_pin")
        outputs = ("frequency", "contact", "fb")
        super().__init__({name: In(1) for name in pins} | {name: Out(1) for name in outputs})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        config = self._config
        zero, low, high = config.zero_ticks, config.period_low_ticks, config.period_high_ticks
        m.submodules.input_pulse = pulse = FilteredInput(config.feedback_filter_ticks)
        m.submodules.input_contact = contact = FilteredInput(config.contact_filter_ticks)
        since = Signal(range(zero + 1), init=zero)
        m.d.comb += [
            pulse.pin.eq(self.pulse_pin),
            contact.pin.eq(self.contact_pin),
            self.contact.eq(contact.level),
            self.fb.eq(contact.level | (since != zero)),
        ]
        with m.If(pulse.rise):
            m.d.sync += [
                since.eq(1),
                self.frequency.eq((since >= low) & (since <= high)),
            ]
        with m.Else():
            with m.If(since != zero):
                m.d.sync += since.eq(since + 1)
            with m.If(since >= high):
                m.d.sync += self.frequency.eq(0)
        return m
