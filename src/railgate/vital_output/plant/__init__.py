"""What is outside the pins of the two FPGAs, as step functions and as Amaranth components.

CPU pair and network time → FPGA 1 ⇄ cross-link ⇄ FPGA 2 → relay → feedback to both. The contract
of what answers within ticks; both sides are written from it.

**Clocks.** Domains `fpga_1` and `fpga_2`, and `relay`, in which the relays live: a tick of a
contract below is one of that domain, counted as in railgate.vital_output.spec.

**Relay (DRV-13).** Of each output. Stage c = 1, 2 is fed with FPGA c's pulse; while `rogue_c` is 1,
with a train of its own instead, 1 in the ticks k with k mod period < ⌊period / 2⌋, period being
period_ticks in relay ticks, rounded: so a faulty FPGA would pulse for ever. What it is fed with
passes two flip-flops (which start at 0); a rise is in the tick in which the second one is new.
`since` starts at high + 1, becomes 1 after the tick of a rise, else grows by 1 up to high + 1.
`alive` becomes 1 after a rise with low ≤ since ≤ high, 0 after any other rise and after a tick
without one in which since ≥ high; low and high are period · (1 ∓ pulse_tolerance), rounded inwards.
The coil is on while both stages are alive and `broken` is 0. `moving` starts at 0; in a tick in
which the contact is open and the coil is on, or it is closed and the coil is off: if moving ≥ t -
1, the contact changes and moving becomes 0, else moving grows by 1; in any other tick it becomes 0.
t is pick-up or release in relay ticks, rounded up; while `welded` is 1, a closed contact does not
open (moving grows no further than t - 1).

**Feedback.** No tick passes. Pulse feedback of FPGA c: its pulse, 0 while `open_c`, 1 while
`stuck_c`. Contact, to both FPGAs: the relay's, 0 while `contact_open`, 1 while `contact_stuck`
(in all of these stuck before open).

**Cross-link.** `line_1` is from FPGA 1 to FPGA 2, `line_2` back: link_tx, delayed by `delay_ticks`
flip-flops of the sender's domain (which start at 1), inverted while `flip`, 0 while `low`, 1 while
`high` (high before low).

**Stopped clock.** While `stopped` of an FPGA is 1, its clock has no edges: an edge at the end of a
tick in which it is 1 changes nothing but by a reset, which acts all the same; that tick is not
counted.
"""

from railgate.vital_output.plant.cpu import Command, Cpus
from railgate.vital_output.plant.faults import FAULTS, Fault, fault
from railgate.vital_output.plant.relay import RelayTimes, contacts
from railgate.vital_output.plant.scenario import Scenario

__all__ = [
    "FAULTS",
    "Command",
    "Cpus",
    "Fault",
    "RelayTimes",
    "Scenario",
    "contacts",
    "fault",
]
