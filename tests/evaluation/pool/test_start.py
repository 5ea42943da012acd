import os
import resource
import subprocess
import sys
from pathlib import Path

import pytest

from support.pool_tasks import Ask, CrashingSetup, Echo, FailingSetup, FailingSetupOnce, Large, Planted
from support.pools import make_pool, value_of
from trundle.errors import InputError, MissingExtraError
from trundle.evaluation.pool import PoolSetupError
from trundle.extras import install_line

SCRIPT = """
import sys
from trundle.evaluation.pool import Pool

class Task:
    def setup(self):
        self.factor = 2

    def __call__(self, job, note):
        return self.factor * job

print("started")
with Pool(Task(), workers=1, deadline_s=60, memory_mb=None, fork=sys.argv[1] == "fork") as pool:
    print([outcome.value for outcome in pool.run(range(3))])
"""


@pytest.mark.parametrize("options", [{"workers": 0}, {"deadline_s": 0.0}, {"memory_mb": float("nan")}, {"retries": -1}])
def test_bad_arguments_are_refused(options):
    with pytest.raises(InputError, match=next(iter(options))):
        make_pool(**options)


def test_a_set_up_that_fails_twice_is_refused():
    with make_pool(FailingSetup(), workers=4) as pool, pytest.raises(PoolSetupError) as caught:
        list(pool.run(range(10)))
    assert "OSError: no such map: planted.yaml (support/pool_tasks.py:" in str(caught.value)


def test_a_set_up_that_crashes_twice_is_refused():
    with (
        make_pool(CrashingSetup()) as pool,
        pytest.raises(PoolSetupError, match=r"SIGSEGV .*pool_tasks\.py:\d+ in setup"),
    ):
        list(pool.run(range(10)))


def test_a_set_up_that_fails_once_costs_no_job(tmp_path):
    with make_pool(FailingSetupOnce(tmp_path / "tried")) as pool:
        assert [outcome.value for outcome in pool.run(range(3))] == [0, 1, 2]


def test_a_set_up_that_hangs_is_refused(monkeypatch):
    monkeypatch.setattr("trundle.evaluation.pool.pool.SETUP_S", 1.0)
    with make_pool(Ask(hang=True)) as pool, pytest.raises(PoolSetupError, match="it took longer than 1 s"):
        list(pool.run(["return"]))


@pytest.mark.parametrize(("name", "reason"), [("no_such_module", "ModuleNotFoundError"), ("planted_crash", "SIGSEGV")])
def test_a_module_that_cannot_be_preloaded_is_refused(name, reason, tmp_path, monkeypatch):
    (tmp_path / "planted_crash.py").write_text("import ctypes\nctypes.string_at(0)\n")
    monkeypatch.syspath_prepend(tmp_path)
    with make_pool(preload=[name]) as pool, pytest.raises(PoolSetupError, match=reason):
        list(pool.run(["return"]))


def test_a_task_that_cannot_be_pickled_is_refused():
    with pytest.raises(PoolSetupError, match="the task cannot be sent to workers"):
        make_pool(Planted({1: (value for value in ())}))


def test_a_function_of_a_test_travels_by_value():
    class Task(Echo):
        def __call__(self, job, note):
            return job + os.getpid() * 0

    with make_pool(Task()) as pool:
        assert [outcome.value for outcome in pool.run([4])] == [4]


@pytest.mark.slow
def test_a_script_needs_no_guard_and_may_define_the_task(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(SCRIPT)
    environment = {**os.environ, "PYTHONPATH": ""}
    for mode in ("fork", "spawn"):
        done = subprocess.run(
            [sys.executable, script, mode], capture_output=True, text=True, env=environment, check=False
        )
        assert (done.stdout, done.stderr) == ("started\n[0, 2, 4]\n", "")


def test_a_task_of_a_script_needs_cloudpickle(monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    monkeypatch.setattr(Echo, "__module__", "__main__")
    monkeypatch.setattr(sys.modules["__main__"], "Echo", Echo, raising=False)
    with pytest.raises(MissingExtraError, match="cloudpickle") as caught:
        make_pool(Echo())
    assert caught.value.install == install_line("evaluate")


def test_a_task_of_a_module_needs_no_cloudpickle(monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with make_pool() as pool:
        assert value_of(pool, "return", 5) == 5


def test_a_large_job_is_refused(pool):
    with pytest.raises(InputError, match=r"a job takes 9,0\d\d bytes"):
        list(pool.run([("return", "x" * 9000)]))


def test_too_few_descriptors_are_reported():
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (len(list(Path("/proc/self/fd").iterdir())) + 40, hard))
    try:
        with make_pool(Echo(), workers=200) as pool, pytest.raises(PoolSetupError, match="give the pool fewer workers"):
            list(pool.run(range(1000)))
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))


@pytest.mark.parametrize("fork", [True, False])
@pytest.mark.parametrize("size", [60_000, 70_000, 1_000_000, 20_000_000])
def test_a_task_of_any_size_reaches_its_workers(size, fork):
    with make_pool(Large(size), fork=fork) as pool:
        assert value_of(pool, None) == size
