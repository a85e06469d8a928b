"""What is outside the position link's pins: position system, line and radio unit.

Each exists twice, written from this page: as step functions (here, vectorised over cycles) and as
Amaranth components (`gateware`), which give the same pins tick for tick. Terms, C, rise(n) and
fall(n) are those of railgate.position_link.spec. Ref: source 001, paragraphs 13 to 17; LNK-2 to
LNK-7.

**Ticks.** A pin's edge is seen in tick k where it has another level in k than in k - 1; before tick
0 all pins and all that is below is 0, and `rst` makes a new tick 0.

**CLK number.** With a rise of clk in tick k the number becomes 1 where anf[k] is 1 and was 0 with
the rise before; else it goes up by 1, and after `cycle_bits` to 0, where it stays. So CLK m of a
cycle has number m, and its edge is seen in tick C + rise(m - 1), or C + fall(m - 1).

**Position system.** It launches with each rise of clk, or where `sampling_edge` is RISING with each
fall: an edge seen in tick k changes what is launched in tick k + 1. What it does is told by inputs
that hold still in C ≤ k < C + cycle_ticks:
- `latency`, `length`: with CLK number `latency` UEF rises, for `length` CLK: the answer. One that
  is 0 is no answer.
- `second`, `second_length`: of a second UEF pulse, likewise. The answer goes before it where both
  begin with the same CLK.
- `word`: DATA is its bits, one a CLK, the most significant one with UEF's rise, 0 after the last.
A pulse that begins, and CLK number 1 or 0, end the pulse under way. Without one UEF and DATA are 0.
- `delay`, cable and launch, 0 to 255 ticks: in tick k the line's far end has what was launched in
  tick k - delay[k].

**Line**, of UEF and of DATA each: `flip` inverts it, then `low` holds it at 0, then `high` at 1,
each in the very tick.

**Radio unit.** It samples `radio_valid` and `radio_data` where it sees a fall of clk. Successive
samples with valid 1 are the bits of a frame, which ends with the first valid 0, seen in tick k. In
tick k + 1: a frame of `frame_bits` gives all its `frame_fields` together, and `right`: its check
is right, or it is bare. `frames` counts those that are right, `faults` the others and those of
another length, modulo 2³².
"""

from railgate.position_link.plant.faults import FAULTS, Fault, fault
from railgate.position_link.plant.plan import Plan
from railgate.position_link.plant.radio import received
from railgate.position_link.plant.scenario import Scenario, controls, drive
from railgate.position_link.plant.words import LAYOUT

__all__ = [
    "FAULTS",
    "LAYOUT",
    "Fault",
    "Plan",
    "Scenario",
    "controls",
    "drive",
    "fault",
    "received",
]
