"""A plugin of pytest that runs inside the judged tree: the order given, limits of processor time, a record.

It is copied beside the packages of that tree and imports nothing of the project. Each line of the record is
one event, so that a process that dies leaves word of the test that it was in.
"""

from __future__ import annotations

import json
import math
import os
import resource

import pytest

RECORD = os.environ["MUTANT_RECORD"]
FILES: list[str] = json.loads(os.environ["MUTANT_FILES"])
MOST = float(os.environ["MUTANT_SECONDS"])  # of the whole run
MOST_OF_ONE = float(os.environ["MUTANT_TEST_SECONDS"])


_begun: list[float] = []  # processor time at the start of each test


def _say(event: str, value: object) -> None:
    with open(RECORD, "a", encoding="utf-8") as file:
        file.write(json.dumps([event, value]) + "\n")


def _used() -> float:
    """Processor time of this process and its children that have ended [s]."""
    return sum(os.times()[:4])


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put the tests in the order in which their files are given."""
    items.sort(key=lambda item: FILES.index(item.nodeid.partition("::")[0]))
    _say("items", [item.nodeid for item in items])


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_logstart(nodeid: str) -> None:
    """Give a test its limit: the system ends the process where it is passed, in compiled code too."""
    _say("start", nodeid)
    _begun.append(_used())
    seconds = sum(os.times()[:2])
    resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(seconds + MOST_OF_ONE), resource.RLIM_INFINITY))


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """Record a failure, of a fixture too."""
    if report.failed:
        _say("failed", report.nodeid)


def pytest_collectreport(report: pytest.CollectReport) -> None:
    """Record a file whose import fails."""
    if report.failed:
        _say("failed", report.nodeid)


class Clock:
    """Ends the run between two tests when its time is over."""

    def __init__(self, session: pytest.Session) -> None:
        self.session = session

    def pytest_runtest_logfinish(self, nodeid: str) -> None:
        """Stop where the time is over."""
        _say("end", nodeid)
        _say("seconds", round(_used() - _begun[-1], 2))
        if _used() > MOST:
            _say("over", round(_used(), 1))
            self.session.shouldstop = "time is over"


def pytest_sessionstart(session: pytest.Session) -> None:
    """Register the clock, which needs the session."""
    session.config.pluginmanager.register(Clock(session))
