"""The child: what comes back from it, and what is said when nothing does."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
import warnings
from pathlib import Path

import numpy as np
import pytest

from support.processes import are_gone
from trundle.errors import InputError, PlanningError, UnknownNameError, WorldError, WorldWarning
from trundle.guard import Child, ReadCall, ReadLimits, read_guarded, read_limits

SHORT = ReadLimits(seconds=1.0)
PLENTY = ReadLimits(seconds=60.0)
linux = pytest.mark.skipif(sys.platform != "linux", reason="limits of memory and ends of parents are Linux's")


def call(function: str, *args, limits: ReadLimits = PLENTY, **kwargs):
    return read_guarded(guarded(function, *args, limits=limits, **kwargs))


def guarded(function: str, *args, limits: ReadLimits = PLENTY, **kwargs) -> ReadCall:
    return ReadCall(f"support.guarded_calls:{function}", args, "scene.usd", WorldError, limits, kwargs)


def test_values_come_back_and_frozen_arrays_stay_frozen():
    found = call("make_arrays")
    np.testing.assert_array_equal(found["frozen"], np.arange(6.0).reshape(2, 3))
    assert not found["frozen"].flags.writeable
    assert found["frozen"].flags.aligned
    assert found["large"].sum() == 1e6
    assert found["words"] == ("a", 1)


def test_warnings_and_log_come_back(caplog):
    with pytest.warns(WorldWarning, match="half of it") as caught:
        call("remark")
    assert Path(caught[0].filename) == Path(__file__)
    assert ("trundle.some.reader", "one note") in [(record.name, record.message) for record in caplog.records]


def test_the_standard_streams_are_left_alone(capfd):
    assert call("chatter") == ("", b"")
    assert capfd.readouterr() == ("", "")


def test_errors_keep_their_type_and_what_they_know():
    with pytest.raises(UnknownNameError, match="Did you mean 'nova_carter'") as caught:
        call("unknown_name")
    assert (caught.value.name, caught.value.choices) == ("nova_cartr", ("nova_carter",))
    with pytest.raises(PlanningError) as failed:
        call("planning_error")
    assert (failed.value.pose, failed.value.cell) == ((1.0, 2.0, 3.0), (4, 5))


def test_a_fault_is_raised_as_what_it_is_with_its_place():
    with pytest.raises(KeyError) as caught:
        call("fault")
    assert "guarded_calls.py" in "".join(caught.value.__notes__)
    with pytest.raises(RuntimeError, match="StubbornError: whatever"):
        call("stubborn")


@pytest.mark.parametrize("number", [signal.SIGSEGV, signal.SIGABRT, signal.SIGKILL])
def test_a_crash_is_one_typed_error(number):
    with pytest.raises(WorldError, match=rf"scene\.usd: .*crashed on it \({signal.Signals(number).name}\)"):
        call("crash", number)


@pytest.mark.parametrize("function", ["hang_in_native_code", "nap"])
def test_the_time_is_limited(function, tmp_path):
    with pytest.raises(WorldError, match=r"scene\.usd: reading it took longer than 1 s; .*TRUNDLE_READ_SECONDS"):
        call(function, *([str(tmp_path)] if function == "nap" else []), limits=SHORT)


@linux
def test_the_memory_is_limited_above_what_the_child_takes():
    assert call("take", 0.3, limits=ReadLimits(gigabytes=1.0)) == 3 * 10**8
    with pytest.raises(WorldError, match=r"more than 0\.2 GB of memory; .*TRUNDLE_READ_GIGABYTES"):
        call("take", 0.3, limits=ReadLimits(gigabytes=0.2))
    with pytest.raises(WorldError, match="more than 2 GB of memory"):
        call("run_out_in_native_code")


def test_endless_recursion_is_too_deep():
    with pytest.raises(WorldError, match="nested too deeply"):
        call("recurse")


def test_it_leaves_no_core_leads_its_group_and_loads_only_what_it_needs():
    found = call("state")
    assert found["pid"] != os.getpid()
    assert (found["core"], found["leads"], found["modules"]) == (0, True, [])


def test_one_child_answers_several_requests_and_a_crash_starts_another():
    with Child() as child:
        first = child.read(guarded("state"))["pid"]
        assert child.read(guarded("state"))["pid"] == first
        with pytest.raises(WorldError, match="crashed"):
            child.read(guarded("crash"))
        assert child.read(guarded("state"))["pid"] != first


def test_options_that_cannot_be_handed_over_are_refused():
    with pytest.raises(WorldError, match="must be plain values"):
        call("take", lambda: None)


SCRIPT = """
import sys
sys.path[:0] = {tests!r}
from trundle.errors import WorldError
from trundle.guard import ReadCall, ReadLimits, read_guarded
read_guarded(ReadCall("support.guarded_calls:nap", ({folder!r},), "f", WorldError, ReadLimits(seconds=300)))
"""


def start(folder: Path) -> tuple[subprocess.Popen[bytes], int]:
    """A script without a guard for its main module that reads for ever; with the child's number."""
    script = folder / "script.py"
    script.write_text(SCRIPT.format(tests=[str(Path(__file__).parents[1])], folder=str(folder)))
    # Modules of these names beside it are not the child's.
    for name in ("pickle", "numpy", "selectors"):
        (folder / "files" / f"{name}.py").parent.mkdir(exist_ok=True)
        (folder / "files" / f"{name}.py").write_text("raise SystemExit('wrong module')")
    process = subprocess.Popen([sys.executable, str(script)], stderr=subprocess.PIPE, cwd=folder / "files")
    found = folder / "child"
    for _ in range(600):
        if found.exists() and found.read_text():
            return process, int(found.read_text())
        time.sleep(0.1)
    process.kill()
    raise AssertionError(process.communicate()[1])


@linux
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGINT])
def test_it_ends_with_its_parent(tmp_path, number):
    process, child = start(tmp_path)
    process.send_signal(number)
    _, said = process.communicate(timeout=60)
    assert are_gone([child])
    assert b"KeyboardInterrupt" in said or number == signal.SIGKILL


def test_trusted_files_are_read_here_and_so_they_are_in_kit(monkeypatch):
    assert call("state", limits=ReadLimits(trusted=True))["pid"] == os.getpid()
    monkeypatch.setitem(sys.modules, "omni.kit.app", None)
    assert call("state")["pid"] == os.getpid()


def test_limits_are_as_given_else_the_environments_else_the_usual(monkeypatch):
    assert read_limits() == ReadLimits(20.0, 2.0, trusted=False)
    monkeypatch.setenv("TRUNDLE_READ_SECONDS", "60")
    monkeypatch.setenv("TRUNDLE_READ_GIGABYTES", "8")
    monkeypatch.setenv("TRUNDLE_TRUSTED", "1")
    assert read_limits() == ReadLimits(60.0, 8.0, trusted=True)
    assert read_limits(trusted=False, time_limit_s=5, memory_limit_gb=1.5) == ReadLimits(5.0, 1.5, trusted=False)


@pytest.mark.parametrize(
    ("name", "value"),
    [("TRUNDLE_READ_SECONDS", "soon"), ("TRUNDLE_READ_GIGABYTES", "-1"), ("TRUNDLE_TRUSTED", "yes")],
)
def test_wrong_limits_are_refused(monkeypatch, name, value):
    monkeypatch.setenv(name, value)
    with pytest.raises(InputError, match=f"{name} is .*must be"):
        read_limits()


@pytest.mark.parametrize(
    "given", [{"trusted": "yes"}, {"time_limit_s": 0}, {"time_limit_s": float("nan")}, {"memory_limit_gb": True}]
)
def test_wrong_options_are_refused(given):
    with pytest.raises(InputError, match="must be"):
        read_limits(**given)


def test_nothing_is_shown_twice():
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        call("remark")
    assert len(caught) == 1
