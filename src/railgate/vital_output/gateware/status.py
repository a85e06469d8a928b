"""The counters of what has happened, and the first cause since the last acknowledgement."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from operator import or_

from amaranth.hdl import Cat, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.vital_output.spec import CAUSES, Cause, Config

__all__ = ["Status"]

COUNTED = ("accepted", "start", "passed", "stored")
ALARMS = (Cause.HANDSHAKE_ALARM, Cause.FEEDBACK_ALARM)
NAMES = [cause.name.lower() for cause in CAUSES]


class Status(wiring.Component):
    """Counts events, and latches the first cause.

    One in for each cause, of its name: 1 bit, event; of an alarm one bit an output. accepted,
    start, passed, stored: in, 1 bit each, events. lost: in, frames that one accepted in this tick
    tells lost. acknowledged: in, 1 bit, event, an output is.
    first_cause, first_output: out, decoded from registers, and a counter of each: out, registers,
    see Config.fields.
    """

    def __init__(self, config: Config) -> None:
        self._config = config
        causes = {
            cause.name.lower(): In(config.outputs if cause in ALARMS else 1) for cause in CAUSES
        }
        told = ("first_cause", "first_output")
        super().__init__(
            causes
            | {name: In(1) for name in (*COUNTED, "acknowledged")}
            | {"lost": In(range(config.life_cycles))}
            | {
                field.name: Out(field.width)
                for field in config.fields
                if field.name in told or field.name.endswith("_count")
            }
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        for name in (*COUNTED, *NAMES):
            count = getattr(self, f"{name}_count")
            with m.If(getattr(self, name).any()):
                m.d.sync += count.eq(count + 1)
        with m.If(self.accepted):
            m.d.sync += self.lost_count.eq(self.lost_count + self.lost)

        # Events come late in their tick: they are kept as they are, and chosen from afterwards.
        first = {name: Signal(len(getattr(self, name)), name=f"first_{name}") for name in NAMES}
        causes = Cat(bits.any() for bits in first.values())
        with m.If(self.acknowledged | ~causes.any()):
            m.d.sync += [bits.eq(getattr(self, name)) for name, bits in first.items()]
        m.d.comb += self.first_cause.eq(_chosen(causes, CAUSES))
        with m.Switch(self.first_cause):
            for cause in ALARMS:
                outputs = first[cause.name.lower()]
                with m.Case(cause):
                    m.d.comb += self.first_output.eq(_chosen(outputs, range(len(outputs))))
        return m


def _chosen(bits: Value, numbers: Sequence[int]) -> Value:
    """The number that belongs to the lowest bit that is set, 0 where none is."""
    lowest = bits & -bits
    return reduce(or_, (Mux(lowest[at], number, 0) for at, number in enumerate(numbers)))
