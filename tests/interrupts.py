"""Processes that a test interrupts."""

from __future__ import annotations

import signal

__all__ = ["heeds_interrupts"]


def heeds_interrupts() -> None:
    """In a child before it begins: also where the tests run in the background of a shell, whose
    processes ignore SIGINT."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
