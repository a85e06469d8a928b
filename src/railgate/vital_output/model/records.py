"""What the vital output's model remembers, as one record.

Everything is int64: numbers of 32 bits are kept below 2³², masks of 64 outputs wrap into the sign,
which keeps their bits. Ticks of a domain are counted through all of its resets, so that they only
grow; `origin` is the tick 0 of the contract. What does not happen is in tick FAR or NONE.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from railgate.vital_output.model.clocks import CLOCK
from railgate.vital_output.spec import CAUSES, Config

__all__ = [
    "COUNTERS",
    "FAR",
    "INPUTS",
    "NONE",
    "REGISTERS",
    "SENT",
    "SIGNALS",
    "STATE",
    "places",
    "record",
]

FAR = 1 << 62
"""Later than every tick."""
NONE = -FAR
"""Before every tick."""

OUTPUTS = 64
"""As many as there can be."""
SENT = 80
"""More messages than can be on their way on a line."""
BITS = 512
"""More than the longest message has."""
IN_FLIGHT = 8
"""More changes of one pin than can be on their way through synchroniser and filter."""

INPUTS = (
    *("command.payload", "command.valid", "time.index", "time.phase", "time.valid", "boot", "test"),
    *("link_rx", "pulse_feedback", "contact"),
    *("rst", "stopped", "flip", "low", "high", "open", "stuck", "contact_open", "contact_stuck"),
    *("welded", "broken", "rogue_1", "rogue_2"),
)
"""What a domain is told from outside: a channel, one that has no loop, one that has, the relays."""

COUNTERS = ("accepted", "start", "lost", "passed", "stored", *(c.name.lower() for c in CAUSES))
SIGNALS = (
    *("command.ready", "link_tx", "pulses", "index", "trusted", "sequence", "life", "image"),
    *("acknowledge", "states.0", "states.1", "states.2", "blocked", "test_phase", "linked"),
    *("drifting", "latched", "first_cause", "first_output"),
    *(f"{name}_count" for name in COUNTERS),
)
"""What a channel shows, in this order; `states` in as many parts as it needs."""


def places(*names: str) -> list[np.int64]:
    """Of these SIGNALS. No int: numba compiles a kernel anew for each one that it is given."""
    return [np.int64(SIGNALS.index(name)) for name in names]


Part = tuple[str, Any] | tuple[str, Any, int | tuple[int, ...]]


def record(names: str, *parts: Part) -> np.dtype[Any]:
    """A record of numbers, then of parts: each a name, a type, and their number if above 1."""
    return np.dtype([(name, np.int64) for name in names.split()] + list(parts))


FRAME = record("sequence image acknowledge crc index")
"""A command frame, and the index with which it is good."""

MESSAGE = record("number boot test low high carries passed", ("frame", FRAME))
"""A message of the cross-link; low and high: bit 0 and bit 1 of each output's code."""

REGISTERS = record(
    "zero index pending consistent holdover seated "
    "referenced reference verdict_tick verdict carries passed open own_there forwarded_there "
    "expires number numbered linked ever_linked taken offset_zero window drifting has_seen seen "
    "forward_tick forward_verdict image acknowledge stored_index life errors latched blocked "
    "test_phase first_cause first_output",
    *((name, FRAME) for name in ("checked", "own", "forward", "forwarded")),
    ("peer", MESSAGE),
)
"""The registers that a channel's parts share. zero: the tick in which phase is 0, or would have
been; offset_zero: likewise of offset. verdict_tick, forward_tick: those in which the verdicts on
`checked` and `forward` are told. expires: in which remaining is 1. taken: of the last message."""

PIN = record("level rise right count", ("ticks", np.int64, IN_FLIGHT))
"""A level behind a synchroniser, and the ticks in which it will change; the tick of its last rise,
and whether that was as long after the one before as a train's."""

OUTPUT = record("state entered left since until toggle regular steady")
"""One output. entered: the first tick of its state. It drives in since ≤ tick < until; in the tick
`toggle` its pulse changes next. regular: rises in a row that nothing has disturbed; steady: the
train needs no attention until something disturbs it."""

SENDER = record("number bit next level delay", ("bits", np.int8, BITS))
"""A message that goes out: its number, its next bit that differs from the one before, the tick
after which that begins, `delay` ticks later than on link_tx; the level until then."""

CHANNEL = record(
    "board base looped origin time due drive_due latch toggle causes boot "
    "begun twice bytes sends receiving begins got arrival counted "
    "pulses still ceased feedback contact line feedback_pin contact_pin link_pin "
    "drawn restful leapable readable news heard renewed settled repeating",
    ("now", REGISTERS),
    ("was", REGISTERS),
    ("incoming", MESSAGE),
    ("outputs", OUTPUT, OUTPUTS),
    ("feedback_pins", PIN, OUTPUTS),
    ("contact_pins", PIN, OUTPUTS),
    ("link", PIN),
    ("senders", SENDER, 2),
    ("buffer", np.int64, 24),
    ("received", np.int8, BITS),
    ("values", np.int64, len(Config().layout.message)),
    ("counts", np.int64, len(COUNTERS)),
    ("sent", MESSAGE, SENT),
    ("shown", np.int64, len(SIGNALS)),
    ("logged", np.int64, len(SIGNALS)),
    ("wanted", np.int64, len(SIGNALS)),
)
"""One channel.

now: its registers; was: as they were in the tick that is under way. base: where its signals begin
in the log. looped: whether there is a loop. time: of the edge that ends this tick. due, drive_due,
latch, toggle: the next ticks in which anything, an output, a message's fields, a pulse may change.
causes: bit c of those of this tick. begun, twice, bytes, buffer: of the frame that comes in. sends:
messages made. receiving, begins, got, received: of the message that comes in bit by bit; values: of
a message's fields; arrival: the tick in which `incoming` is there as a whole. counted: a counter
has grown. still: outputs whose trains are steady; ceased: those of them that end. feedback,
contact, line: what pulses, relays and wire are; …_pin: what comes of it at the pins. drawn: pulses
are followed edge by edge; restful: but for steady ones. leapable: the relays always find a steady
train alive; readable: the peer always reads an undisturbed message. senders: for link_tx, and for
the line; sent: the messages that may be on their way, each at its number modulo SENT. shown: what
the signals are from `time` on; news: some may have changed; logged: what they were before; wanted:
those that are asked for. heard: in this tick a message is taken that has come as a whole; renewed:
in this tick changes what messages tell; settled: the first message that tells all that the later
ones will, as long as nothing changes; repeating: messages are leapt over.
"""

DOMAIN = record(
    "cursor change event time skipped frozen resetting done",
    ("held", np.int64, len(INPUTS)),
)
"""A clock domain: the next change of its inputs, and the edge that samples it; its next edge that
matters, and when that is; edges that were stopped; the edge from which on they are, or NONE; the
last tick done. held: its inputs."""

RELAYS = record(
    "due origin period low high pick_up release contact",
    ("fed", np.int64, 2),
    ("still", np.int64, 2),
    ("apart", np.int64, OUTPUTS),
    ("stages", PIN, (2, OUTPUTS)),
)
"""The relays. fed: what each stage is fed with; still: the outputs whose trains are steady there.
apart: the first tick of those in which coil and contact have been different."""

STATE = record(
    "fresh loop logged wanted disturbance calm reach",
    ("clocks", CLOCK, 3),
    ("domains", DOMAIN, 3),
    ("channels", CHANNEL, 2),
    ("relays", RELAYS),
)
"""All of a run. fresh: a piece begins. loop: whether there are the other channel and the relays.
logged, wanted: of the relays' contacts, as of a channel's signals. disturbance: the next one of the
lines that may not have been sampled yet, `calm` its time; reach: more than any period."""
