"""The position link's host side: delivered words to position, speed, age and health."""

from railgate.position_link.host.health import Summary, summary
from railgate.position_link.host.layout import Bits, Layout, WordField, guarantee
from railgate.position_link.host.layout_file import example, parse_layout, read_layout
from railgate.position_link.host.link import (
    Deliveries,
    Delivery,
    deliveries,
    position_uncertainty_m,
)

__all__ = [
    "Bits",
    "Deliveries",
    "Delivery",
    "Layout",
    "Summary",
    "WordField",
    "deliveries",
    "example",
    "guarantee",
    "parse_layout",
    "position_uncertainty_m",
    "read_layout",
    "summary",
]
