"""What tests show, as a marker, and their results, kept for `railgate evidence`."""

from collections import Counter
from typing import Any

import pytest

from railgate.evidence.digests import digests
from railgate.evidence.results import RESULTS, Case, Ran, keep_tests

MARKER = (
    'shows(*requirements, kind="test"): what it shows, by names; a "sweep" of situations or a test'
)
UNKNOWN = {"shows": (), "sweep": False, "of": 0}
"""Of a test whose process broke down."""


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", MARKER)
    if not hasattr(config, "workerinput"):  # xdist's workers report to the process that records
        config.pluginmanager.register(Recorder(config))


@pytest.hookimpl(tryfirst=True)  # before any are deselected
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Hand on with each report what the test shows, and how many cases its function has."""
    some = config.getoption("lf", False) or any("[" in argument for argument in config.args)
    of = Counter(function(item.nodeid) for item in items)
    for item in items:
        marks = list(item.iter_markers("shows"))
        told = {
            "shows": [requirement for mark in marks for requirement in mark.args],
            "sweep": any(mark.kwargs.get("kind") == "sweep" for mark in marks)
            or item.get_closest_marker("slow") is not None,
            "of": 0 if some else of[function(item.nodeid)],
        }
        item.user_properties.append(("evidence", told))


def function(nodeid: str) -> str:
    return nodeid.partition("[")[0]


class Recorder:
    """Keeps each test's results when the session ends, with the digests of what it ran on."""

    def __init__(self, config: pytest.Config) -> None:
        self.config = config
        self.on = {name: d for name, d in digests().items() if name != "proven"}
        self.told: dict[str, dict[str, Any]] = {}
        self.cases: dict[str, dict[str, Case]] = {}

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Of set-up, call and tear-down of a case; each counts that did not pass."""
        name, _, parameters = report.nodeid.removesuffix("]").partition("[")
        cases = self.cases.setdefault(name, {})
        before = cases.get(parameters, Case("passed", 0.0, 0.0))
        outcome = before.outcome if report.passed else report.outcome
        cases[parameters] = Case(outcome, before.seconds + report.duration, report.stop)
        self.told[name] = dict(report.user_properties).get("evidence", UNKNOWN)

    def pytest_sessionfinish(self) -> None:
        results = {
            name: Ran(self.on, **self.told[name], cases=self.cases[name]) for name in self.told
        }
        try:
            keep_tests(results, self.config.rootpath / RESULTS)
        except ValueError as error:  # that they are not kept is no fault of the tests
            self.config.pluginmanager.get_plugin("terminalreporter").write_line(f"\n{error}")
