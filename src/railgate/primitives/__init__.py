"""Gateware that every function shares."""

from railgate.primitives.inputs import FilteredInput

__all__ = ["FilteredInput"]
