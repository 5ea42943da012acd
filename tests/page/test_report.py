import json
import shutil
from dataclasses import replace

import numpy as np
import pytest

from trundle.errors import InputError
from trundle.maps import OccupancyGrid
from trundle.mission import Episode, Scenario, Session
from trundle.mission.steering.directives import DropBox, GivenDirective, Pause
from trundle.navigation import Navigator
from trundle.page import COLUMNS, RunData, report_folder
from trundle.page.encoding import unpack_array, unpack_json
from trundle.page.run_data import encode_costmaps
from trundle.record import RunFolder
from trundle.sim.kinematic import KinematicSimulator

MOST = 100_000_000


def boot_of(file):
    return json.loads(file.read_text().split('id="boot">')[1].split("</script>")[0])


def run_of(file):
    return unpack_json(boot_of(file)["episode"], most_bytes=MOST)


def column(rows, name):
    return np.array([row[COLUMNS.index(name)] for row in rows], dtype=object)


@pytest.fixture(scope="module")
def doubtful(tmp_path_factory):
    """The folder of a run whose localizer is in doubt at first."""
    place = tmp_path_factory.mktemp("runs") / "doubtful"
    world = {"name": "warehouse", "options": {"size": [14, 11]}}
    localizer = "support.doubtful:DoubtfulLocalizer"
    scenario = Scenario.make(world=world, backend="kinematic", localizer=localizer, seed=5)
    with (
        scenario.build() as mission,
        RunFolder(place, scenario=mission.scenario, video=False, overlay=False) as record,
    ):
        mission.run(observers=[record])
    return place


def test_what_the_localizer_believed_is_in_the_report(doubtful):
    boot, run = boot_of(doubtful / "report.html"), run_of(doubtful / "report.html")
    assert boot["run"]["localizer"] == "DoubtfulLocalizer"
    states = [frame["belief"]["state"] for frame in run["frames"]]
    assert list(dict.fromkeys(states)) == ["ambiguous", "lost", "localized"]
    assert max(len(unpack_array(frame["belief"]["particles"])) for frame in run["frames"]) <= 150


def test_a_report_from_the_folder_alone_has_the_states_of_the_trajectory(doubtful, tmp_path):
    kept = np.load(doubtful / "trajectory.npz")["localization"]
    assert (kept[0], kept[50], kept[-1]) == (1, 2, 0)
    bare = tmp_path / "bare"
    shutil.copytree(doubtful, bare)
    (bare / "report.html").unlink()
    report_folder(bare)
    run = run_of(bare / "report.html")
    states = column(run["rows"], "state")
    assert (states[0], states[50], states[-1]) == ("ambiguous", "lost", "localized")
    assert [one["text"] for one in run["events"] if one["kind"] == "locate"] == ["ambiguous", "lost", "localized"]
    assert boot_of(bare / "report.html")["run"]["localizer"] == "recorded"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The folder of a sensed run with an error in its odometry."""
    place = tmp_path_factory.mktemp("runs") / "a run"
    scenario = Scenario.make(
        world={"name": "warehouse", "options": {"size": [14, 11]}},
        backend={"name": "kinematic", "options": {"lidar": True}},
        localizer="odometry",
        seed=5,
    )
    with (
        scenario.build() as mission,
        RunFolder(place, scenario=mission.scenario, video=False, overlay=False) as record,
    ):
        mission.run(observers=[record])
    return place


@pytest.fixture
def copied(folder, tmp_path):
    return shutil.copytree(folder, tmp_path / "copy")


@pytest.mark.slow
def test_the_report_of_a_sensed_run_has_all_and_is_small(folder):
    file = folder / "report.html"
    boot, run = boot_of(file), run_of(file)
    record = json.loads((folder / "episode.json").read_text())
    assert boot["mode"] == "report"
    assert boot["verdict"]["outcome"] == record["outcome"]
    assert dict(boot["verdict"]["figures"])["distance"] == f"{record['distance_m']:.2f} m"
    assert boot["settings"]["seed"] == 5
    assert boot["versions"] == record["versions"]
    assert boot["command"] == f"trundle run '{folder / 'scenario.yaml'}'"
    assert boot["contacts"] == []
    scene = unpack_json(boot["scene"], most_bytes=MOST)
    assert scene["map"]["png"]
    assert scene["robot"]["parts"]
    assert len(run["rows"]) == len(Episode.load(folder).trajectory)
    frames = run["frames"]
    assert np.diff([frame["t"] for frame in frames]).max() < 0.26
    points = np.cumsum(np.reshape(frames[3]["scans"][0]["deltas"], (-1, 2)), axis=0)
    assert len(points) > 30
    assert 10.0 < np.hypot(*points.T).max() < 1200.0  # [cm]: the lidar's range
    seconds = record["time_s"]
    assert len(file.read_text()) - page_size() < 13_000 * max(seconds, 10.0)  # with the page 1.5 MB in 60 s


def page_size():
    from trundle.page import render

    return len(render({"mode": "report"}, title=""))


def test_costmaps_come_back_from_their_differences(folder, carter, hall):
    import base64
    import io

    from PIL import Image

    from trundle.costmap import Costmap

    first = Costmap.from_grid(OccupancyGrid.from_world(hall), carter)
    second = first.update(slice(20, 30), slice(20, 40), 100)
    full, change = encode_costmaps([(0.0, first), (2.0, second)], MOST)

    def pixels(one):
        return np.asarray(Image.open(io.BytesIO(base64.b64decode(one["png"]))))

    assert (change["base"], "base" in full) == (0, False)
    np.testing.assert_array_equal((pixels(full) + pixels(change))[::-1], second.data)
    assert len(change["png"]) < len(full["png"])
    assert [one["t"] for one in encode_costmaps([(0.0, first), (2.0, second), (4.0, first)], 100)] == [0.0]


@pytest.mark.slow
def test_a_long_run_stays_within_bounds(monkeypatch, drive):
    monkeypatch.setattr("trundle.page.run_data.MOST_ROWS", 40)
    monkeypatch.setattr("trundle.page.run_data._MOST_FRAME_BYTES", 30_000)
    data = RunData()
    episode = drive(data, lidar=True)
    run = data.run_dict()
    times = column(run["rows"], "t")
    assert len(times) <= 41
    assert (times[0], times[-1]) == (0.0, pytest.approx(episode.trajectory.time[-1]))
    assert 2 <= len(run["frames"]) < 25
    assert run["frames"][-1]["t"] > 0.7 * times[-1]


def test_boxes_that_were_dropped_are_in_the_replay(drive):
    data = RunData()
    episode = drive(data)
    asked = (
        GivenDirective(20, 1.0, DropBox(1.0, 2.0, 0.0, (0.4, 0.4, 0.6)), "page"),
        GivenDirective(21, 1.05, DropBox(-3.0, 0.0), "page", refused="the robot is there"),
        GivenDirective(22, 1.1, Pause(True), "page"),
    )
    data.on_end(replace(episode, directives=asked))
    (box,) = data.run_dict()["solids"]
    assert box["t"] == 1.0
    np.testing.assert_allclose(unpack_array(box["instances"][0]["size"]), [(0.4, 0.4, 0.6)], rtol=1e-6)


def test_the_same_data_give_the_same_report(copied):
    report_folder(copied)
    first = (copied / "report.html").read_bytes()
    report_folder(copied)
    assert (copied / "report.html").read_bytes() == first


@pytest.mark.slow
def test_a_report_made_again_keeps_what_was_seen(folder, copied):
    before = run_of(copied / "report.html")
    assert report_folder(copied) == copied / "report.html"
    assert run_of(copied / "report.html") == before
    assert boot_of(copied / "report.html")["command"] == f"trundle run {copied / 'scenario.yaml'}"
    other = copied / "other.html"
    assert report_folder(copied, other) == other
    assert run_of(other) == before


@pytest.mark.slow
@pytest.mark.parametrize(
    "damage", [None, "", "<html>", '<script type="application/json" id="boot">{"verdict":3}</script>']
)
def test_a_folder_without_a_whole_report_gets_one_from_its_files(copied, damage):
    before = run_of(copied / "report.html")
    (copied / "report.html").unlink()
    if damage is not None:
        (copied / "report.html").write_text(damage)
    report_folder(copied)
    boot, after = boot_of(copied / "report.html"), run_of(copied / "report.html")
    scene = unpack_json(boot["scene"], most_bytes=MOST)
    assert scene["instances"]
    assert scene["note"] == ""
    for name in ("t", "x", "y", "yaw", "v", "sent_v", "cross_track", "left"):
        ours, theirs = column(after["rows"], name), column(before["rows"], name)
        known = [index for index, value in enumerate(theirs) if value is not None and ours[index] is not None]
        assert len(known) > 0.9 * len(ours)
        np.testing.assert_allclose(
            ours[known].astype(float), theirs[known].astype(float), atol=0.35 if name == "left" else 0.02
        )
    assert after["paths"] == before["paths"]
    assert [event["kind"] for event in after["events"]][:2] == ["start", "plan"]


def test_a_run_whose_world_and_robot_are_gone_is_replayed_with_a_note(copied):
    (copied / "report.html").unlink()
    (copied / "scenario.yaml").unlink()
    record = json.loads((copied / "episode.json").read_text())
    (copied / "episode.json").write_text(json.dumps({**record, "robot": "</script>rover"}))
    report_folder(copied)
    boot = boot_of(copied / "report.html")
    scene = unpack_json(boot["scene"], most_bytes=MOST)
    assert (boot["settings"], boot["command"], scene["instances"]) == (None, None, [])
    assert "the world cannot be drawn: the folder has no scenario.yaml" in scene["note"]
    assert "nova_carter is drawn for the robot '</script>rover'" in scene["note"]


@pytest.mark.parametrize("name", ["trajectory.npz", "paths.npz", "episode.json"])
def test_a_damaged_run_names_the_file(copied, name):
    (copied / "report.html").unlink()
    (copied / name).write_bytes(b"PK\3\4 nothing")
    with pytest.raises(InputError, match=name):
        report_folder(copied)


def test_a_folder_without_a_run_says_so(tmp_path):
    with pytest.raises(InputError, match=r"no episode\.json in it; give the folder that trundle run wrote"):
        report_folder(tmp_path)
    with pytest.raises(InputError, match="no such folder"):
        report_folder(tmp_path / "none")


@pytest.mark.parametrize("end", ["collided", "aborted", "no_path"])
def test_every_end_has_a_report(tmp_path, hall, carter, end):
    grid = OccupancyGrid.from_world(hall)
    cells = grid.data.copy()
    if end == "collided":
        cells[:] = 0  # what it drives into is not on its map
    if end == "no_path":
        cells[:, cells.shape[1] // 2] = 100
    place = tmp_path / end
    agent = Navigator(OccupancyGrid(cells, grid.resolution, grid.origin), carter)
    goal = (0.0, 3.0) if end == "collided" else (3.0, 0.0)
    start = (0.0, -2.0, 1.57) if end == "collided" else (-3.0, 0.0, 0.0)
    with KinematicSimulator(hall, carter) as sim, RunFolder(place, video=False, overlay=False) as record:
        with Session(sim, agent, start, goal, observers=[record]) as session:
            if end == "aborted":
                session.step()
            else:
                session.run()
        episode = session.finish()
    assert episode.observer_errors == ()
    assert episode.outcome.value == end
    boot = boot_of(place / "report.html")
    assert boot["verdict"]["outcome"] == end
    run = run_of(place / "report.html")
    assert run["events"][-1]["kind"] == "end"
    if end == "collided":
        (contact,) = boot["contacts"]
        assert "touches </script><b>pillar" in contact["what"]
        assert column(run["rows"], "clearance")[-1] == 0.0
        assert place.joinpath("report.html").read_text().count("</script>") == 2
