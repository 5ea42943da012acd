"""`trundle map from-bag`, `continue` and `from-graph`: from a recording to a checked map."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from support.command_line import Trundle
from support.pose_graphs import make_graph
from support.room_drives import WALLS, Drive, write_bag, write_carmen
from trundle.mapping import load_pose_graph, save_pose_graph
from trundle.maps import OccupancyGrid
from trundle.recordings import RecordedDrive

pytest.importorskip("rosbags")

ROUND = Drive(seconds=55.0)
HERE = ",".join(f"{value:.4f}" for value in ROUND.poses[0])
"""Where the drive begins in the room: with it as the origin, the map lies in the room's frame."""


@pytest.fixture(scope="module")
def bags(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("bags")
    write_bag(folder / "round", ROUND)
    return folder


def distances(grid: OccupancyGrid) -> np.ndarray:
    """Distance of each occupied cell's centre to the nearest wall of the room [m]."""
    rows, cols = np.nonzero(grid.data == 100)
    points = np.column_stack([cols + 0.5, rows + 0.5]) * grid.resolution
    points = grid.origin.transform_points(points)
    first, step = WALLS[:, 0], WALLS[:, 1] - WALLS[:, 0]
    to = points[:, None] - first[None]
    share = np.clip((to * step).sum(-1) / (step**2).sum(-1), 0.0, 1.0)
    return np.hypot(*np.moveaxis(to - share[..., None] * step, -1, 0)).min(axis=1)


def test_a_strangers_bag_becomes_a_map_that_is_true(trundle: Trundle, bags: Path, tmp_path: Path) -> None:
    done = trundle("map", "from-bag", bags / "round", "-o", "site.yaml", "--origin", HERE, "--json")
    assert done.code == 0, done.err
    assert (done.json["robot"], done.json["odometry"], done.json["parts"]) == ("unknown", "/odom", 1)
    grid = OccupancyGrid.load(tmp_path / "site.yaml")
    off = distances(grid)
    assert len(off) > 500
    assert (off < 0.1).mean() > 0.97
    made = sorted(path.name for path in tmp_path.iterdir())
    assert made == ["site.png", "site.posegraph", "site.yaml", "site_drive.png"]
    assert done.json["driven_m"] == pytest.approx(19.8, abs=0.5)
    assert isinstance(done.json["findings"], list)


def test_people_are_told_what_to_look_at(trundle: Trundle, bags: Path) -> None:
    done = trundle("map", "from-bag", bags / "round", "-o", "site.yaml")
    assert done.code == 0, done.err
    assert "map check: " in done.out
    assert "look at site_drive.png" in done.err


def test_a_lidar_upside_down_gives_the_same_map(trundle: Trundle, tmp_path: Path) -> None:
    drive = Drive(seconds=30.0)
    measured = drive.scan
    drive.scan = lambda index: measured(index)[::-1]
    write_bag(tmp_path / "bag", drive, roll=math.pi)
    done = trundle("map", "from-bag", tmp_path / "bag", "-o", "site.yaml", "--origin", HERE, "--json")
    assert done.code == 0, done.err
    assert (distances(OccupancyGrid.load(tmp_path / "site.yaml")) < 0.1).mean() > 0.97
    assert any("upside down" in line for line in done.json["remarks"])


def test_scans_alone_suffice_where_they_come_often_enough(trundle: Trundle, tmp_path: Path) -> None:
    write_bag(tmp_path / "bag", ROUND, topics=("/scan", "/tf_static"))
    done = trundle("map", "from-bag", tmp_path / "bag", "-o", "site.yaml", "--origin", HERE, "--json")
    assert done.code == 0, done.err
    assert (distances(OccupancyGrid.load(tmp_path / "site.yaml")) < 0.1).mean() > 0.95
    assert any("the motion is that of the scans" in line for line in done.json["remarks"])


@pytest.mark.filterwarnings("ignore:the odometry jumped")  # as the motion of such scans does
def test_scans_alone_that_do_not_fit_each_other_are_refused(trundle: Trundle, tmp_path: Path) -> None:
    def shuffle(topic, message, index):
        if topic == "/scan":
            message.ranges = ROUND.scan(index * 331 % len(ROUND.times)).astype(np.float32)
        return message

    write_bag(tmp_path / "bag", ROUND, topics=("/scan", "/tf_static"), change=shuffle)
    done = trundle("map", "from-bag", tmp_path / "bag", "-o", "out/site.yaml")
    assert done.code == 2
    assert "no odometry, and its scans alone do not suffice" in done.err
    assert list((tmp_path / "out").iterdir()) == []


def test_a_bag_without_scans_is_refused(trundle: Trundle, tmp_path: Path) -> None:
    write_bag(tmp_path / "bag", Drive(seconds=3.0), topics=("/odom", "/tf"))
    done = trundle("map", "from-bag", tmp_path / "bag", "-o", "site.yaml")
    assert done.code == 2
    assert "the bag has no scans" in done.err


def carried(topic, message, index):
    """The robot is carried away after 30 s, for 5 s, and its odometry begins again elsewhere."""
    if topic == "/odom" and index >= 700:
        message.pose.pose.position.x += 30.0
    return None if topic == "/scan" and 600 <= index < 700 else message


def test_a_robot_that_was_carried_away_is_recognised(trundle: Trundle, tmp_path: Path) -> None:
    write_bag(tmp_path / "bag", Drive(seconds=70.0), change=carried)
    done = trundle("map", "from-bag", tmp_path / "bag", "-o", "site.yaml", "--origin", HERE)
    assert done.code == 0, done.err
    assert "part 2 joins part 1" in done.out
    assert "the map begins a new part there" in done.err
    assert (distances(OccupancyGrid.load(tmp_path / "site.yaml")) < 0.1).mean() > 0.95


def test_what_is_not_recognised_stays_out_of_the_map_and_in_the_graph(trundle: Trundle, tmp_path: Path) -> None:
    def elsewhere(topic, message, index):
        if topic == "/scan" and index >= 700:
            angles = np.arange(len(message.ranges)) * message.angle_increment
            message.ranges = (1.2 + 0.2 * np.sin(9.0 * angles + 0.01 * index)).astype(np.float32)
        return carried(topic, message, index)

    write_bag(tmp_path / "bag", Drive(seconds=50.0), change=elsewhere)
    done = trundle("map", "from-bag", tmp_path / "bag", "-o", "site.yaml")
    assert done.code == 1
    assert "not in the map: part 2 of 2" in done.out
    assert set(load_pose_graph(tmp_path / "site.posegraph").parts.tolist()) == {0, 1}


def test_a_map_goes_on_with_another_drive(trundle: Trundle, bags: Path, tmp_path: Path) -> None:
    first = trundle("map", "from-bag", bags / "round", "-o", "site.yaml", "--json")
    write_carmen(tmp_path / "second.log", Drive(seconds=40.0, beams=181, fov=math.pi))
    done = trundle("map", "continue", "site.posegraph", "second.log", "-o", "site.yaml", "--json")
    assert done.code == 0, done.err
    assert (done.json["parts"], done.json["parts_not_in_map"]) == (2, [])
    assert done.json["poses"] > first.json["poses"]
    assert done.json["lidars"] == "front"
    assert len(load_pose_graph(tmp_path / "site.posegraph").lidars) == 2


def test_two_graphs_are_merged_where_they_overlap(trundle: Trundle, bags: Path, tmp_path: Path) -> None:
    trundle("map", "from-bag", bags / "round", "-o", "one.yaml", "--origin", HERE, "--json")
    trundle("map", "from-bag", bags / "round", "-o", "two.yaml", "--origin", "50,50,1", "--json")
    done = trundle("map", "from-graph", "one.posegraph", "two.posegraph", "-o", "both.yaml", "--json")
    assert done.code == 0, done.err
    assert done.json["parts_not_in_map"] == []
    assert (distances(OccupancyGrid.load(tmp_path / "both.yaml")) < 0.1).mean() > 0.97


def test_a_pose_graph_of_other_drives_is_not_replaced(trundle: Trundle, bags: Path, tmp_path: Path) -> None:
    save_pose_graph(make_graph(), tmp_path / "site.posegraph")
    done = trundle("map", "from-bag", bags / "round", "-o", "site.yaml")
    assert done.code == 2
    assert "site.posegraph already exists: continue it with trundle map continue" in done.err
    assert [path.name for path in tmp_path.iterdir()] == ["site.posegraph"]
    assert trundle("map", "from-bag", bags / "round", "-o", "site.yaml", "--overwrite").code == 0


def test_a_map_beyond_memory_is_refused_and_nothing_is_written(trundle: Trundle, tmp_path: Path) -> None:
    graph = make_graph()
    save_pose_graph(replace(graph, poses=graph.poses * (3e4, 3e4, 1.0)), tmp_path / "far.posegraph")
    done = trundle("map", "from-graph", "far.posegraph", "-o", "out/far.yaml")
    assert done.code == 2
    assert "use a coarser resolution" in done.err
    assert list((tmp_path / "out").iterdir()) == []


def test_what_was_mapped_is_kept_where_its_map_is_beyond_memory(
    trundle: Trundle, bags: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as small:
        small.setattr("trundle.mapping.drawing.MAX_CELLS", 1000)
        done = trundle("map", "from-bag", bags / "round", "-o", "out/far.yaml")
    assert done.code == 2
    assert "use a coarser resolution; trundle map from-graph" in done.err
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["far.posegraph"]
    assert trundle("map", "from-graph", "out/far.posegraph", "-o", "out/far.yaml").code == 0


def test_a_pose_graph_with_poses_kilometres_apart_is_refused(trundle: Trundle, bags: Path, tmp_path: Path) -> None:
    graph = make_graph()
    save_pose_graph(replace(graph, poses=graph.poses * (3e4, 3e4, 1.0)), tmp_path / "far.posegraph")
    done = trundle("map", "continue", "far.posegraph", bags / "round", "-o", "out/far.yaml")
    assert done.code == 2
    assert "lie too far apart" in done.err


def test_foreign_and_damaged_pose_graphs_are_refused(trundle: Trundle, bags: Path, tmp_path: Path) -> None:
    (tmp_path / "theirs.posegraph").write_bytes(b"\x16\0\0\0\0\0\0\0serialization::archive\x11\0")
    done = trundle("map", "continue", "theirs.posegraph", bags / "round", "-o", "site.yaml")
    assert done.code == 2
    assert "of slam_toolbox" in done.err
    save_pose_graph(make_graph(), tmp_path / "cut.posegraph")
    content = (tmp_path / "cut.posegraph").read_bytes()
    (tmp_path / "cut.posegraph").write_bytes(content[:900])
    done = trundle("map", "from-graph", "cut.posegraph", "-o", "site.yaml", "--json")
    assert done.code == 2
    assert "cut off or damaged" in done.json["error"]["message"]


def test_a_recording_that_was_cut_off_gives_the_map_of_what_can_be_read(trundle: Trundle, tmp_path: Path) -> None:
    write_bag(tmp_path / "bag", Drive(seconds=40.0, beams=2000))
    (file,) = (tmp_path / "bag").glob("*.mcap")
    content = file.read_bytes()
    (tmp_path / "cut.mcap").write_bytes(content[: len(content) * 9 // 10])
    done = trundle("map", "from-bag", "cut.mcap", "-o", "site.yaml", "--json")
    assert done.code == 0, done.err
    assert any("cut off or damaged" in line for line in done.json["remarks"])


def test_ctrl_c_leaves_nothing(trundle: Trundle, bags: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    steps = RecordedDrive.steps

    def stopped(drive):
        for number, step in enumerate(steps(drive)):
            if number == 100:
                raise KeyboardInterrupt
            yield step

    monkeypatch.setattr(RecordedDrive, "steps", stopped)
    done = trundle("map", "from-bag", bags / "round", "-o", "out/site.yaml")
    assert done.code == 130
    assert "stopped: nothing was written" in done.err
    assert list((tmp_path / "out").iterdir()) == []


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--resolution", "0"], "--resolution 0"),
        (["--origin", "1"], "--origin '1'"),
        (["--origin", "1e9,0,0"], "x of the pose graph's origin must be a number from -1e+06"),
        (["--robot", "nova_cartr"], "nova_carter"),
        (["--posegraph", "graph.txt"], "posegraph"),
        (["-o", "map.png"], "map.png"),
    ],
)
def test_wrong_options_are_told_before_any_work(trundle: Trundle, bags: Path, options, said) -> None:
    done = trundle("map", "from-bag", bags / "round", *options)
    assert done.code == 2
    assert said in done.err
