"""A run as one HTML page that needs nothing beside it."""

from railgate.unit.report.page import write_report

__all__ = ["write_report"]
