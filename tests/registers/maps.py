"""Maps that several tests describe and export: the three functions', and one of every kind."""

from enum import IntEnum, IntFlag

from railgate.field import Field
from railgate.odometer.registers import registers as odometer
from railgate.odometer.spec import Config as OdometerConfig
from railgate.position_link.registers import registers as position_link
from railgate.position_link.spec import Config as LinkConfig
from railgate.registers import Access, Block, Gate, Group, Map, Register
from railgate.vital_output.registers import registers as vital_output
from railgate.vital_output.spec import Config as VitalConfig


class Mode(IntEnum):
    OFF = 0
    NUMBER = 1
    ON = 3


class Event(IntFlag):
    HOT = 1
    COLD = 2
    WET = 8


def unit() -> Map:
    """The three functions; the word has 3 words, the states too."""
    return Map.of(
        "unit",
        'a unit of "three"',
        (
            odometer(OdometerConfig(stamp_depth=4)),
            position_link(LinkConfig(word_bits=72)),
            vital_output(VitalConfig(outputs=24)),
        ),
    )


def every_kind() -> Map:
    """A block of registers of each access and of each kind of field, at an address not 0."""
    group = Group(
        name="number",
        description="all as of one tick",
        registers=(
            Register(name="far", fields=(Field("far", 70, "wide and signed", "m", signed=True),)),
            Register(
                name="modes",
                fields=(Field("modes", 40, "of twenty"),),
                values={"modes": Mode},
            ),
        ),
        gate=Gate.LATCH,
    )
    entries = (
        Register(
            name="start",
            fields=(Field("digest", 48, "both words", start=0x1234_5678_9ABC),),
            access=Access.CONSTANT,
        ),
        Register(
            name="events",
            fields=(Field("gap", 3, "before"), Field("events", 4, "seen", start=8)),
            values={"events": Event},
            access=Access.READ_TO_CLEAR,
        ),
        Register(name="seen", fields=(Field("seen", 32, "all"),), access=Access.WRITE_ONE_TO_CLEAR),
        Register(
            name="setting",
            fields=(Field("level", 9, "signed", signed=True, start=-3), Field("mode", 2, "of it")),
            values={"mode": Mode},
            access=Access.READ_WRITE,
        ),
        Register(
            name="control",
            fields=(Field("go", 1, "starts it"), Field("halt", 1, "ends it")),
            access=Access.TRIGGER,
        ),
        group,
        Register(name="signal", fields=(Field("signal", 1, "now"),)),
    )
    block = Block(name="field", description="everything", entries=entries)
    return Map(name="reg", description="one of each", blocks={4096: block})
