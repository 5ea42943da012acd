import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image

from trundle.errors import OutputError, OutsideMapError
from trundle.mission import Scenario, Trajectory, run
from trundle.mission.run_files import load_paths
from trundle.record.run_folder import RunFolder
from trundle.record.video import encode

FILES = {"episode.json", "trajectory.npz", "paths.npz", "scenario.yaml", "report.html", "overlay.png", "video.mp4"}
NAMES_THAT_STAY = {
    "outcome",
    "time_s",
    "distance_m",
    "path_length_m",
    "min_clearance_m",
    "planning_ms",
    "real_time_factor",
    "contacts",
    "run_dir",
}


@pytest.fixture
def scenario():
    return Scenario.make(
        world={"name": "warehouse", "options": {"size": [14, 11]}}, backend="kinematic", seed=5, time_limit_s=120
    )


def names(folder):
    return {path.name for path in Path(folder).iterdir()}


def test_a_run_leaves_its_files_and_the_record_has_the_names_that_stay(tmp_path, scenario):
    with scenario.build() as mission, RunFolder(tmp_path / "r", scenario=mission.scenario) as folder:
        episode = mission.run(observers=[folder])
    assert episode.observer_errors == ()
    assert names(tmp_path / "r") == FILES
    record = json.loads((tmp_path / "r" / "episode.json").read_text())
    assert set(record) >= NAMES_THAT_STAY
    assert record["outcome"] == "arrived"
    assert record["run_dir"] == str(tmp_path / "r")
    assert record["versions"]["trundle"]
    assert record["complete"] is True
    assert record == folder.record
    trajectory = Trajectory.load(tmp_path / "r" / "trajectory.npz")
    assert trajectory.x.tolist() == episode.trajectory.x.tolist()
    with Image.open(tmp_path / "r" / "overlay.png") as image:
        image.load()


def test_the_saved_scenario_repeats_the_run_bit_for_bit(tmp_path, scenario):
    with scenario.build() as mission, RunFolder(tmp_path, scenario=mission.scenario, video=False) as folder:
        first = mission.run(observers=[folder]).trajectory
    with Scenario.load(tmp_path / "scenario.yaml").build() as mission:
        again = mission.run().trajectory
    for name in Trajectory.columns():
        assert getattr(again, name).tobytes() == getattr(first, name).tobytes()


def test_a_read_only_folder_fails_before_the_run(tmp_path, monkeypatch):
    def refuse(*arguments, **options):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("tempfile.TemporaryFile", refuse)  # file modes do not stop root
    with pytest.raises(OutputError, match="Permission denied"):
        RunFolder(tmp_path / "r")


def test_bad_input_leaves_no_folder(tmp_path, scenario):
    with scenario.build() as mission:
        far = (1000.0, 0.0)
        with RunFolder(tmp_path / "r") as folder, pytest.raises(OutsideMapError):
            run(mission.sim, mission.navigator, mission.start, far, observers=[folder])
        assert not (tmp_path / "r").exists()
        (tmp_path / "mine").mkdir()
        with RunFolder(tmp_path / "mine") as folder, pytest.raises(OutsideMapError):
            run(mission.sim, mission.navigator, mission.start, far, observers=[folder])
        assert (tmp_path / "mine").exists()


def test_one_file_that_fails_does_not_keep_the_others(tmp_path, scenario):
    def broken(run, episode):
        raise OSError("no driver")

    with scenario.build() as mission, RunFolder(tmp_path, scenario=mission.scenario, frames=broken) as folder:
        episode = mission.run(observers=[folder])
    assert names(tmp_path) == FILES - {"video.mp4"}
    (error,) = episode.observer_errors
    assert isinstance(error, OutputError)
    assert "no driver" in str(error)
    assert "video.mp4" not in json.loads((tmp_path / "episode.json").read_text())["files"]


@pytest.mark.parametrize("method", ["on_start", "on_step", "on_end", "run_dict"])
def test_a_report_that_fails_does_not_cost_the_episode(tmp_path, scenario, monkeypatch, method):
    def fail(*_):
        raise KeyError("a fault")

    monkeypatch.setattr(f"trundle.page.run_data.RunData.{method}", fail)
    with scenario.build() as mission, RunFolder(tmp_path, scenario=mission.scenario, video=False) as folder:
        episode = mission.run(observers=[folder])
    assert names(tmp_path) == FILES - {"video.mp4", "report.html"}
    (error,) = episode.observer_errors
    assert "report.html: 'a fault'" in str(error)
    assert json.loads((tmp_path / "episode.json").read_text())["complete"] is True


def test_a_run_can_do_without_a_report(tmp_path, scenario):
    with scenario.build() as mission, RunFolder(tmp_path, page=False, video=False) as folder:
        assert not folder.wants_rollouts
        mission.run(observers=[folder])
    assert "report.html" not in names(tmp_path)


@pytest.mark.slow
def test_ctrl_c_during_the_video_leaves_the_video_out(tmp_path, scenario):
    def interrupted(run, episode):
        raise KeyboardInterrupt

    with scenario.build() as mission, RunFolder(tmp_path, scenario=mission.scenario, frames=interrupted) as folder:
        episode = mission.run(observers=[folder])
    assert episode.arrived
    assert names(tmp_path) == FILES - {"video.mp4"}


@pytest.mark.slow
def test_the_outcome_is_written_before_pictures_and_again_at_the_end(tmp_path, scenario):
    seen = []

    def look(run, episode):
        seen.append((names(tmp_path / "r"), json.loads((tmp_path / "r" / "episode.json").read_text())))
        raise OSError("no driver")

    def draw(path, episode):
        seen.append(names(tmp_path / "r"))
        path.write_text(episode.outcome)

    with (
        scenario.build() as mission,
        RunFolder(tmp_path / "r", scenario=mission.scenario, frames=look, extras={"extra.txt": draw}) as folder,
    ):
        mission.run(observers=[folder])
    at_extra, (at_video, early) = seen
    first = {"trajectory.npz", "paths.npz", "scenario.yaml", "episode.json"}
    assert first <= at_extra & at_video
    assert (early["outcome"], early["complete"]) == ("arrived", False)
    late = json.loads((tmp_path / "r" / "episode.json").read_text())
    assert late["complete"] is True
    assert set(late["files"]) == FILES - {"episode.json", "video.mp4"} | {"extra.txt"}
    assert {key: late[key] for key in ("outcome", "distance_m", "name")} == {
        key: early[key] for key in ("outcome", "distance_m", "name")
    }


@pytest.mark.slow
def test_an_earlier_run_is_replaced_only_when_asked_for(tmp_path, scenario):
    with scenario.build() as mission:
        for number, overwrite in enumerate((False, True)):
            with RunFolder(tmp_path, name=str(number), video=False, overwrite=overwrite) as folder:
                mission.run(observers=[folder])
            before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
            assert set(before) == FILES - {"video.mp4", "scenario.yaml"}
            with pytest.raises(OutputError, match="--overwrite"):
                RunFolder(tmp_path)
            assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


@pytest.mark.slow
def test_a_folder_is_for_one_run(tmp_path, scenario):
    with scenario.build() as mission, RunFolder(tmp_path, video=False) as folder:
        mission.run(observers=[folder])
        before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
        (error,) = mission.run(observers=[folder]).observer_errors
    assert "another RunFolder" in str(error)
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_a_record_that_cannot_be_written_leaves_the_earlier_run(tmp_path, scenario, monkeypatch):
    (tmp_path / "episode.json").write_text("old")
    (tmp_path / "trajectory.npz").write_text("old")

    def fail(*_, **__):
        raise OutputError("disk full")

    monkeypatch.setattr("trundle.record.run_folder.write_text", fail)
    with scenario.build() as mission, RunFolder(tmp_path, video=False, overwrite=True) as folder:
        (error,) = mission.run(observers=[folder]).observer_errors
    assert "disk full" in str(error)
    assert (tmp_path / "episode.json").read_text() == (tmp_path / "trajectory.npz").read_text() == "old"


@pytest.mark.slow
def test_record_trajectory_and_scenario_are_on_the_disk(tmp_path, scenario, monkeypatch):
    synced = set()
    sync = os.fsync

    def note(descriptor):
        synced.add(os.fstat(descriptor).st_ino)
        sync(descriptor)

    monkeypatch.setattr(os, "fsync", note)
    with scenario.build() as mission, RunFolder(tmp_path, scenario=mission.scenario, video=False) as folder:
        mission.run(observers=[folder])
    for name in ("episode.json", "trajectory.npz", "paths.npz", "scenario.yaml", "."):
        assert (tmp_path / name).stat().st_ino in synced, name


@pytest.mark.slow
def test_the_same_run_gives_the_same_picture(tmp_path, scenario):
    for name in ("a", "b"):
        with scenario.build() as mission, RunFolder(tmp_path / name, video=False) as folder:
            mission.run(observers=[folder])
    assert (tmp_path / "a" / "overlay.png").read_bytes() == (tmp_path / "b" / "overlay.png").read_bytes()


SCRIPT = """
import os, signal, sys, time
from pathlib import Path
from trundle.mission import Scenario
from trundle.record.run_folder import RunFolder

class Watch:
    def __init__(self, on_step, on_end): self.on_step, self.on_end = on_step, on_end
    def on_start(self, run): pass

def drive(folder, on_step=lambda step: None, on_end=lambda episode: None):
    scenario = Scenario.make(world={"name": "warehouse", "options": {"size": [14, 11]}}, backend="kinematic", seed=5)
    with scenario.build() as mission, RunFolder(folder, scenario=mission.scenario) as record:
        return mission.run(observers=[Watch(on_step, on_end), record])

"""


def start(code):
    return subprocess.Popen([sys.executable, "-c", SCRIPT + code], stdout=subprocess.PIPE, text=True)


def check_whole(folder):
    """Whatever is there can be read whole."""
    for path in folder.iterdir():
        if path.name.startswith("."):
            continue  # a temporary name
        if path.name == "episode.json":
            complete = json.loads(path.read_text())["complete"]
            assert names(folder) >= (FILES if complete else {"trajectory.npz", "paths.npz", "scenario.yaml"})
        elif path.name == "trajectory.npz":
            Trajectory.load(path)
        elif path.name == "paths.npz":
            load_paths(path)
        elif path.name == "scenario.yaml":
            Scenario.load(path)
        elif path.name == "overlay.png":
            with Image.open(path) as image:
                image.load()
        elif path.name == "report.html":
            assert path.read_text().endswith("</html>\n")
        else:
            assert path.name == "video.mp4"
            assert b"moov" in path.read_bytes()


@pytest.mark.slow
def test_ctrl_c_ends_a_run_as_aborted_with_its_files(tmp_path):
    code = f"""
def press(step):
    if step.index == 20:
        os.kill(os.getpid(), signal.SIGINT)

print(drive({str(tmp_path)!r}, press).outcome)
"""
    with start(code) as process:
        said, _ = process.communicate(timeout=60)
    assert said == "aborted\n"
    assert process.returncode == 0
    assert names(tmp_path) == FILES
    assert json.loads((tmp_path / "episode.json").read_text())["outcome"] == "aborted"


@pytest.mark.slow
def test_a_kill_at_any_moment_leaves_no_half_file(tmp_path):
    # It is killed after so much processor time as a share of the writing takes, however busy the machine is.
    code = f"""
folder = Path({str(tmp_path)!r})
began = []
drive(folder / "whole", on_end=lambda episode: began.append(time.process_time()))
writing = time.process_time() - began[0]

def drive_and_die(folder, after):
    def die(episode):
        if after == 0.0:
            os.kill(os.getpid(), signal.SIGKILL)
        signal.setitimer(signal.ITIMER_PROF, after)

    drive(folder, on_end=die)

for number in range(6):
    child = os.fork()
    if child == 0:
        drive_and_die(folder / str(number), writing * number / 6.0)
        os._exit(0)
    os.waitpid(child, 0)
"""
    with start(code) as process:
        process.communicate(timeout=300)
    assert process.returncode == 0
    assert names(tmp_path / "whole") == FILES
    for number in range(6):
        check_whole(tmp_path / str(number))
    # It was killed while it wrote: a temporary name may be left, which no kill can be kept from leaving.
    assert {name for name in names(tmp_path / "0") if not name.startswith(".")} < FILES


@pytest.mark.slow
def test_a_kill_during_the_video_keeps_the_outcome(tmp_path):
    code = f"""
def die(run, episode):
    os.kill(os.getpid(), signal.SIGTERM)

scenario = Scenario.make(world={{"name": "warehouse", "options": {{"size": [14, 11]}}}}, backend="kinematic", seed=5)
with scenario.build() as mission, RunFolder({str(tmp_path)!r}, scenario=mission.scenario, frames=die) as record:
    mission.run(observers=[record])
"""
    with start(code) as process:
        process.communicate(timeout=60)
    assert process.returncode == -signal.SIGTERM
    check_whole(tmp_path)
    record = json.loads((tmp_path / "episode.json").read_text())
    assert (record["outcome"], record["complete"]) == ("arrived", False)


def test_videos_are_whole_files(tmp_path):
    import numpy as np

    encode(tmp_path / "v.mp4", [np.zeros((32, 32, 3), dtype=np.uint8)])
    assert b"moov" in (tmp_path / "v.mp4").read_bytes()
