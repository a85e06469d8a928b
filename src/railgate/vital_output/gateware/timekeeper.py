"""The channel's own time, disciplined by the network's."""

from __future__ import annotations

from amaranth.hdl import Module, Mux, Signal, signed
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.vital_output.spec import Config

__all__ = ["Timekeeper"]


class Timekeeper(wiring.Component):
    """Counts ticks and cycles, follows good updates by the slew, and tells whether to trust it.

    valid: in, 1 bit, index_in: in, 32 bits, cycles, phase_in: in, of range(cycle_ticks), ticks: the
    network's time. lifeless: in, 1 bit, the image has no life.
    index: out, 32 bits, cycles, phase: out, of range(cycle_ticks + slew_ticks), ticks, registers,
    the own time. trusted: out, 1 bit, it agrees with the network's. jump: out, 1 bit, event, this
    update does not (TIME_JUMP). decides: out, 1 bit, this is the tick of decision. DRV-3, DRV-7.
    """

    def __init__(self, config: Config) -> None:
        self._config = config
        super().__init__(
            {
                "valid": In(1),
                "index_in": In(32),
                "phase_in": In(range(config.cycle_ticks)),
                "lifeless": In(1),
                "index": Out(32),
                "phase": Out(range(config.cycle_ticks + config.slew_ticks)),
                "trusted": Out(1),
                "jump": Out(1),
                "decides": Out(1),
            }
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        config = self._config
        cycle, slew, margin = config.cycle_ticks, config.slew_ticks, config.margin_ticks
        most = margin + slew  # a good update less what the cycle that ends corrects
        pending = Signal(signed(1 + most.bit_length()))
        seated = Signal()
        consistent = Signal()
        holdover = Signal(range(config.holdover_cycles + 1))

        # The sum with the correction is the middle one of these three, and reaches the last tick
        # if two of them do: so it need not wait for the correction.
        last = cycle - 1
        correction = Signal(signed(1 + slew.bit_length()))
        ends = Signal()
        m.d.comb += [
            correction.eq(Mux(pending > slew, slew, Mux(pending < -slew, -slew, pending))),
            ends.eq(
                (self.phase >= last - slew)
                & ((self.phase + pending >= last) | (self.phase >= last + slew))
            ),
        ]

        # Likewise the step of the indices comes last, and only selects.
        step = Signal(signed(32))
        ahead = Signal.like(pending)
        near = Signal()
        m.d.comb += step.eq(self.index_in - self.index)
        for cycles in (-1, 0, 1):
            too_low = (self.phase_in - self.phase + (cycles * cycle + margin))[-1]
            too_high = (self.phase - self.phase_in + (margin - cycles * cycle))[-1]
            with m.If(step == cycles):
                m.d.comb += [
                    ahead.eq(self.phase_in - self.phase + cycles * cycle),
                    near.eq(~too_low & ~too_high),
                ]

        update = Signal()
        good = Signal()
        seats = Signal()
        later = (step > 0) | ((step == 0) & (self.phase_in >= self.phase))
        m.d.comb += [
            update.eq(self.valid & (self.phase_in < cycle)),
            good.eq(update & seated & near),
            seats.eq(update & ~good & (~seated | (self.lifeless & later))),
            self.jump.eq(update & ~good & ~seats),
            self.trusted.eq(consistent & (holdover != config.holdover_cycles)),
            self.decides.eq(self.phase == config.decision_ticks),
        ]

        m.d.sync += self.phase.eq(self.phase + 1)
        with m.If(ends):
            m.d.sync += [self.phase.eq(0), self.index.eq(self.index + 1)]
            m.d.sync += [pending.eq(pending - correction)]
            with m.If(holdover != config.holdover_cycles):
                m.d.sync += holdover.eq(holdover + 1)
        with m.If(good):
            m.d.sync += [
                pending.eq(Mux(ends, ahead - correction, ahead)),
                consistent.eq(1),
                holdover.eq(0),
            ]
        with m.If(self.jump):
            m.d.sync += consistent.eq(0)
        with m.If(seats):
            wraps = self.phase_in == last
            m.d.sync += [
                self.phase.eq(Mux(wraps, 0, self.phase_in + 1)),
                self.index.eq(self.index_in + wraps),
                seated.eq(1),
                pending.eq(0),
                consistent.eq(0),
                holdover.eq(0),
            ]
        return m
