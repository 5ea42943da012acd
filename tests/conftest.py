"""How property tests draw their examples, and which of the slow tests run.

Property tests draw the same examples on every run, or random ones with `--explore`:

python -m pytest --explore --explore-seconds 60                        every property test for a minute
python -m pytest --explore --explore-examples 20000 tests/costmap      until so many examples were tried

A finding prints the arguments; pin it with `@example(…)` beside the test's `@given`.

Tests marked `slow` all run, or one in N of them, another one each day:

python -m pytest --slow today/6       what `make test` does
python -m pytest --slow 3/6           what it did on a day that printed "part 3 of 6"
python -m pytest -m slow              all of them, which `make test-slow` does
"""

from __future__ import annotations

import datetime
import functools
import os
import re
import signal
import sys
import time
from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import HealthCheck, settings

# A slow machine is no fault of the code, and a database of failures would make two runs differ.
_STEADY: dict[str, Any] = {"deadline": None, "database": None, "suppress_health_check": [HealthCheck.too_slow]}
settings.register_profile("repeatable", derandomize=True, **_STEADY)
settings.register_profile("explore", derandomize=False, print_blob=True, **_STEADY)


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("exploration of property tests")
    group.addoption("--explore", action="store_true", help="run only property tests, on random examples")
    group.addoption("--explore-seconds", type=float, metavar="S", help="time for each test; no limit by default")
    group.addoption("--explore-examples", type=int, default=20_000, metavar="N", help="for each test; default 20000")
    tests = parser.getgroup("slow tests")
    tests.addoption("--slow", metavar="K/N", help="run part K of N of the tests marked slow; K may be today")


def pytest_configure(config: pytest.Config) -> None:
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        # Started in the background of a shell: tests that interrupt a child need it to take Ctrl-C.
        signal.signal(signal.SIGINT, signal.default_int_handler)
    # Compiled files are kept, whatever the caller says: without them each worker takes 9 s of CPU to compile these
    # tests with their asserts, and each child process compiles what it imports.
    sys.dont_write_bytecode = False
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    settings.load_profile("explore" if config.getoption("explore") else "repeatable")
    if (part := config.getoption("slow")) is not None:
        # The worker processes get the number: they have to agree, also when midnight passes.
        config.option.slow = _numbered(part)


def _numbered(part: str) -> str:
    """A part as K/N, with the number of today's: the parts follow each other day by day."""
    if (given := re.fullmatch(r"(today|\d+)/([1-9]\d*)", part)) is None:
        raise pytest.UsageError(f"--slow {part}: give K/N, as in 3/6, or today/6")
    which, count = given[1], int(given[2])
    number = datetime.date.today().toordinal() % count + 1 if which == "today" else int(which)
    if not 1 <= number <= count:
        raise pytest.UsageError(f"--slow {part}: K is from 1 to {count}")
    return f"{number}/{count}"


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    others: list[pytest.Item] = []
    if config.getoption("explore"):
        others = [item for item in items if not _is_property(item)]
    elif (part := config.getoption("slow")) is not None:
        number, count = map(int, part.split("/"))
        # Neighbours in this list are cases of one test: each part has some of them.
        slow = [item for item in items if item.get_closest_marker("slow") is not None]
        others = [item for place, item in enumerate(slow) if place % count != number - 1]
    left_out = set(others)
    items[:] = [item for item in items if item not in left_out]
    if others:
        config.hook.pytest_deselected(items=others)


def pytest_report_header(config: pytest.Config) -> str | None:
    if (part := config.getoption("slow")) is None:
        return None
    return f"slow tests: part {part.replace('/', ' of ')} (--slow {part}); make test-slow runs all"


def _is_property(item: pytest.Item) -> bool:
    return isinstance(item, pytest.Function) and getattr(item.obj, "is_hypothesis_test", False)


@pytest.hookimpl(tryfirst=True)
def pytest_pyfunc_call(pyfuncitem: pytest.Function) -> bool | None:
    """Repeat a property test, whose every round draws other examples, until there are enough of them."""
    config = pyfuncitem.config
    if not config.getoption("explore"):
        return None
    # Hypothesis calls what stands here for every example.
    handle: Any = pyfuncitem.obj.hypothesis
    counter, test = _Counter(), handle.inner_test
    handle.inner_test = counter.wrap(test)
    names = pyfuncitem._fixtureinfo.argnames
    seconds = config.getoption("explore_seconds")
    until = None if seconds is None else time.monotonic() + seconds
    try:
        while counter.count < config.getoption("explore_examples") and (until is None or time.monotonic() < until):
            pyfuncitem.obj(**{name: pyfuncitem.funcargs[name] for name in names})
    finally:
        handle.inner_test = test
        pyfuncitem.user_properties.append(("examples", counter.count))
    return True


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    for outcome in ("passed", "failed"):
        for report in terminalreporter.stats.get(outcome, ()):
            for name, value in getattr(report, "user_properties", ()):
                if name == "examples":
                    terminalreporter.write_line(f"{value} examples, {outcome}: {report.nodeid}")


class _Counter:
    """How often tests were called."""

    def __init__(self) -> None:
        self.count = 0

    def wrap(self, test: Callable[..., Any]) -> Callable[..., Any]:
        @functools.wraps(test)
        def counted(*args: Any, **kwargs: Any) -> Any:
            self.count += 1
            return test(*args, **kwargs)

        return counted
