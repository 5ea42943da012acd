"""The reports are written while an evaluation runs, and never stop it."""

import subprocess
from pathlib import Path

import pytest

from trundle.errors import OutputError
from trundle.evaluation import Evaluation, Suite
from trundle.evaluation.engine import run_suite
from trundle.evaluation.report.write import FIRST_S, InterimReports, start_writer


class Clock:
    now = 0.0

    def __call__(self):
        return self.now


class SlowWriter:
    """Runs until it is ended or told to be done."""

    def __init__(self, folder, *, ends_by_itself=True):
        self.folder = folder
        self.status = None
        self._listens = ends_by_itself

    def poll(self):
        return self.status

    def wait(self, timeout):
        if self.status is None:
            raise subprocess.TimeoutExpired("writer", timeout)
        return self.status

    def terminate(self):
        self.status = 1 if self._listens else None

    def kill(self):
        self.status = -9


class StarvedWriter(SlowWriter):
    """Gets no processor, so that even its end is late."""

    def terminate(self):
        pass

    def kill(self):
        self.was_killed = True


@pytest.fixture
def clock():
    return Clock()


def test_reports_take_at_most_a_twentieth_of_the_time(clock):
    started = []

    def start(folder):
        started.append((clock.now, SlowWriter(folder)))
        return started[-1][1]

    reports = InterimReports("out", start=start, clock=clock)
    for second in range(1000):
        clock.now = float(second)
        if started and second == started[-1][0] + 10:
            started[-1][1].status = 1 if len(started) == 2 else 0  # one that fails changes nothing
        reports.look()
    assert [when for when, _ in started] == [FIRST_S, FIRST_S + 210, FIRST_S + 420, FIRST_S + 630, FIRST_S + 840]
    assert {writer.folder for _, writer in started} == {"out"}


@pytest.mark.parametrize("listens", [True, False])
def test_a_report_that_is_being_written_ends_with_the_evaluation(clock, listens):
    writer = SlowWriter("out", ends_by_itself=listens)
    reports = InterimReports("out", start=lambda _: writer, clock=clock)
    clock.now = FIRST_S
    reports.look()
    assert writer.status is None
    reports.close()
    assert writer.status == (1 if listens else -9)
    reports.close()


def test_a_report_that_ends_late_on_a_busy_machine_is_left_to_its_end(clock):
    writer = StarvedWriter("out")
    reports = InterimReports("out", start=lambda _: writer, clock=clock)
    clock.now = FIRST_S
    reports.look()
    reports.close()
    assert writer.was_killed


def test_a_process_that_cannot_be_started_is_tried_again_later(clock):
    tries = []

    def start(folder):
        tries.append(clock.now)
        raise OSError("no memory")

    reports = InterimReports("out", start=start, clock=clock)
    for second in range(100):
        clock.now = float(second)
        reports.look()
    reports.close()
    assert tries == [FIRST_S, 2 * FIRST_S, 3 * FIRST_S]


def test_the_report_is_there_while_the_evaluation_runs(room, tmp_path: Path):
    room.save(tmp_path / "room.yaml")
    suite = Suite.make(worlds=[str(tmp_path / "room.yaml")], backends="kinematic", seeds=3, require="success>=0.1")
    out = tmp_path / "out"
    seen = []

    def write_now(progress):
        if progress.done == 2:
            writer = start_writer(str(out))
            seen.append((writer.wait(300), (out / "report.html").read_text(), len(Evaluation(out))))

    run_suite(suite, out, workers=1, on_progress=write_now)
    assert len(Evaluation(out)) == 3
    [(status, page, rows)] = seen
    assert (status, rows) == (0, 2)
    assert "2 episodes of 3 so far" in page


def test_an_evaluation_goes_on_where_no_interim_report_can_be_written(room, tmp_path: Path, monkeypatch):
    room.save(tmp_path / "room.yaml")
    suite = Suite.make(worlds=[str(tmp_path / "room.yaml")], backends="kinematic", seeds=3)
    out = tmp_path / "out"
    monkeypatch.setattr("trundle.evaluation.report.write.FIRST_S", 0.0)
    run_suite(suite, out, workers=1, on_progress=lambda _: (out / "report.html").mkdir(exist_ok=True))
    assert len(Evaluation(out)) == 3


def test_reports_written_apart_are_the_same(room, tmp_path):
    room.save(tmp_path / "room.yaml")
    suite = Suite.make(worlds=[str(tmp_path / "room.yaml")], backends="kinematic", seeds=2)
    folder = run_suite(suite, tmp_path / "out", workers=1)
    evaluation = Evaluation(folder)
    contents = []
    for apart in (False, True):
        report = Path(evaluation.write_report(["success>=0.1"], apart=apart))
        contents.append((report.read_text(), evaluation.read_summary()))
        report.unlink()
    assert contents[0] == contents[1]
    assert contents[1][1]["gates"][0]["passed"]


def test_reports_that_cannot_be_written_apart_say_why(room, tmp_path):
    room.save(tmp_path / "room.yaml")
    suite = Suite.make(worlds=[str(tmp_path / "room.yaml")], backends="kinematic", seeds=1)
    evaluation = Evaluation(run_suite(suite, tmp_path / "out", workers=1))
    with pytest.raises(OutputError, match="Did you mean 'success'"):
        evaluation.write_report(["sucess>=0.1"], apart=True)
