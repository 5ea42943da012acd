import shutil
import webbrowser
from pathlib import Path

import pytest

from support.command_line import Trundle
from trundle.mission import Scenario
from trundle.record import RunFolder


@pytest.fixture(scope="module")
def driven(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("runs") / "run"
    scenario = Scenario.make(
        world={"name": "warehouse", "options": {"size": [14, 11]}}, backend="kinematic", seed=5, time_limit_s=1.0
    )
    with (
        scenario.build() as mission,
        RunFolder(folder, scenario=mission.scenario, video=False, overlay=False) as record,
    ):
        mission.run(observers=[record])
    return folder


@pytest.fixture
def run(driven: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(driven, tmp_path / "run"))


def test_a_report_is_written_again_or_elsewhere(trundle: Trundle, run: Path, tmp_path: Path) -> None:
    before = (run / "report.html").read_text()
    (run / "report.html").unlink()
    done = trundle("report", run)
    assert (done.code, done.err) == (0, "")
    assert str(run / "report.html") in done.out
    assert len((run / "report.html").read_text()) == pytest.approx(len(before), rel=0.05)
    done = trundle("report", run, "-o", tmp_path / "other.html", "--json")
    assert done.json == {"report": str(tmp_path / "other.html")}
    assert (tmp_path / "other.html").is_file()


def test_a_replay_prints_the_page_and_makes_it_where_there_is_none(trundle: Trundle, run: Path) -> None:
    (run / "report.html").unlink()
    done = trundle("replay", run)
    assert (done.code, done.err) == (0, "")
    assert (run / "report.html").resolve().as_uri() in done.out
    assert (run / "report.html").is_file()


def test_a_replay_opens_the_browser(trundle: Trundle, run: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[str] = []
    monkeypatch.setenv("DISPLAY", ":7")
    monkeypatch.setattr(webbrowser, "open", lambda address: not opened.append(address))
    done = trundle("replay", run, "--browser", "--json")
    assert (done.code, done.err) == (0, "")
    assert opened == [done.json["address"]]
    assert opened[0].startswith("file:///")


def test_without_a_browser_a_replay_says_what_to_do(
    trundle: Trundle, run: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DISPLAY", ":7")
    monkeypatch.setattr(webbrowser, "open", lambda address: False)
    done = trundle("replay", run, "--browser")
    assert done.code == 0
    address = (run / "report.html").resolve().as_uri()
    copy = f"Copy {run / 'report.html'} to a machine with one; the address here is {address}\n"
    assert done.err == f"No browser was found here. {copy}"
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr("sys.platform", "linux")
    done = trundle("replay", run, "--browser")
    assert done.code == 0
    assert done.err == f"There is no display here, so no browser was opened. {copy}"


@pytest.mark.parametrize("verb", ["report", "replay"])
def test_what_is_no_run_is_one_clear_error(trundle: Trundle, run: Path, tmp_path: Path, verb: str) -> None:
    (tmp_path / "empty").mkdir()
    (tmp_path / "drive").mkdir()
    (tmp_path / "drive" / "drive.csv").write_text("time_s\n")
    for given, message in (
        (tmp_path / "none", "no such folder"),
        (tmp_path / "empty", "the folder of a run"),
        (tmp_path / "drive", "trundle compare reads it"),
        (run / "scenario.yaml", "trundle run"),
    ):
        done = trundle(verb, given)
        assert done.code == 2, done.out
        assert message in done.err
        assert done.err.count("\n") == 1
    (run / "report.html").unlink()
    (run / "trajectory.npz").write_bytes(b"PK\3\4")
    done = trundle(verb, run)
    assert done.code == 2
    assert "trajectory.npz" in done.err
