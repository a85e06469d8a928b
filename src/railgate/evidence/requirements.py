"""What is required of the unit, each in one sentence."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["REQUIREMENTS", "Requirement"]


@dataclass(frozen=True)
class Requirement:
    """name: as "ODO-1". sentence: what is required. planned: not built yet, so nothing shows it."""

    name: str
    sentence: str
    planned: bool = False


REQUIREMENTS = (
    Requirement("ODO-1", "Sensor, wheel and clock are the source's: 200 km/h is 5.441 kHz."),
    Requirement("ODO-2", "Successive periods add up to exactly the ticks elapsed."),
    Requirement("ODO-3", "A period is right to a tick; the stated bound of speed holds."),
    Requirement("ODO-4", "Phase is measured within the bounds of the source's table."),
    Requirement("ODO-5", "Direction comes from the phase; a reversal has no phantom pulse."),
    Requirement("ODO-6", "No pulse is lost or counted twice, however read and edge fall."),
    Requirement("ODO-7", "A read is one consistent snapshot, of one tick, and never comes again."),
    Requirement("ODO-8", "Sensors cost the CPU one fixed-size burst, whatever the frequency."),
    Requirement("ODO-9", "Synchronised and filtered inputs keep period and phase unchanged."),
    Requirement("ODO-10", "Windows share their edges; Π and Ω sums are exact over each of them."),
    Requirement("ODO-11", "Silence bounds the speed; it neither jumps to zero nor stays."),
    Requirement("ODO-12", "Both channels are watched; what is wrong stays told until it is read."),
    Requirement("ODO-13", "Every edge can be stamped into a FIFO that tells its overflow."),
    Requirement("ODO-14", "The host's speed has a guaranteed interval; distance does not drift."),
    Requirement("ODO-15", "Slip and slide are found and compensated; diameters are calibrated."),
    Requirement("ODO-16", "A wheel's diameter is a checked, dated record; a bad one is an error."),
    Requirement("LNK-1", "CLK is exactly 512 kHz in the mean, and 20 ms are 10 240 CLK."),
    Requirement("LNK-2", "One request every 20 ms, 10 CLK wide, on the cycle's first CLK."),
    Requirement("LNK-3", "DATA is read while UEF is high, which lasts exactly the word."),
    Requirement("LNK-4", "Every fault of UEF has its own cause; an unplugged line is no word."),
    Requirement("LNK-5", "A warning at once, the alarm and the fault word after three in a row."),
    Requirement("LNK-6", "The radio unit gets exactly one word a cycle, at one fixed phase."),
    Requirement("LNK-7", "Health, counters and age are told; a check makes DATA's faults visible."),
    Requirement("LNK-8", "A configured layout turns the word into engineering units."),
    Requirement("DRV-1", "Each CPU sends its FPGA one command frame a cycle, within the skew."),
    Requirement("DRV-2", "The CRC must fit, and by rotating masks the comparator shows its no."),
    Requirement("DRV-3", "Network time is followed, never back; without it no frame is taken."),
    Requirement("DRV-4", "The polynomial keeps a Hamming distance of 8 up to 274 data bits."),
    Requirement("DRV-5", "Every threat of EN 50159 ends in rejection, with its own counter."),
    Requirement("DRV-6", "Each FPGA votes both CPUs' original frames within τ0; any bit counts."),
    Requirement("DRV-7", "A command lives three cycles; from then to the forced 0 is bounded."),
    Requirement("DRV-8", "Idle drives nothing, and leaves only for a command with no feedback."),
    Requirement("DRV-9", "Pre-drive drives nothing until the peer's factor comes within τ1."),
    Requirement("DRV-10", "Drive pulses while command, peer and feedback all are as they must be."),
    Requirement("DRV-11", "Wait demands that feedback falls in the release time."),
    Requirement("DRV-12", "An alarm stops both; a feedback alarm ends by acknowledgement only."),
    Requirement("DRV-13", "The relay is held by both trains together, never by a level."),
    Requirement("DRV-14", "Unrelated clocks cause no false alarm; both start within 4 ticks + L."),
    Requirement("DRV-15", "A second rejection within an interval forces 0 until acknowledged."),
    Requirement("DRV-16", "No single fault keeps the contact closed beyond the reaction time."),
    Requirement("DRV-17", "A peer's clock off tolerance is found in a declared time."),
    Requirement("DRV-18", "Shut-off paths are tested alone; what moves meanwhile is an alarm."),
    Requirement(
        "NET-1", "Command and status are Ethernet frames with a priority tag.", planned=True
    ),
    Requirement("NET-2", "The loss of either of two paths loses no frame.", planned=True),
    Requirement("NET-3", "Network time disciplines the FPGA's clock.", planned=True),
    Requirement("NET-4", "Frames are taken only inside their scheduled window.", planned=True),
    Requirement("NET-5", "A status frame goes back to the CPU each cycle.", planned=True),
    Requirement("SYS-1", "One register map feeds gateware, host, C header and documents."),
    Requirement("SYS-2", "Gateware and independent model are the same, tick for tick."),
    Requirement("SYS-3", "Every function is placed and routed, its fmax and area measured."),
    Requirement("SYS-4", "Each requirement is traced to what shows it."),
    Requirement("SYS-5", "Configurations have a digest; channels of unequal ones never drive."),
    Requirement("SYS-6", "Events share one time stamp and are kept in a log."),
)
