"""`trundle.show`: what a loop of one's own shows, and what it gets back."""

import json
import math
import time
from pathlib import Path as FilePath

import numpy as np
import pytest

import trundle
from support.page_visitor import OpenPage, Visitor
from trundle.costmap import Costmap
from trundle.errors import InputError, UnknownNameError
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.observation import Estimate, Hypothesis, Scan
from trundle.page.encoding import unpack_array
from trundle.path import Path
from trundle.robots import Robot
from trundle.serve import View
from trundle.serve.view_feed import MOST_ROWS, Trails
from trundle.worlds import World


def visit(view: View) -> OpenPage:
    return Visitor.of_address(view.address).open()


def scan(lidar: str = "front", ranges: tuple[float, ...] = (1.0, 2.0)) -> Scan:
    return Scan(lidar, 0.0, Pose2D(0.2, 0.0), 0.3, np.linspace(0.0, 1.0, len(ranges)), np.array(ranges), 0.1, 10.0)


def costmap(robot: str = "jackal") -> Costmap:
    grid = OccupancyGrid(np.zeros((40, 60), dtype=np.int8), resolution=0.1, origin=Pose2D(0.0, 0.0))
    return Costmap.from_grid(grid, Robot.load(robot))


# What the pages get --------------------------------------------------------------------------------------------------


def test_a_page_gets_the_pose_the_path_the_scan_the_costmap_and_the_text(view: View) -> None:
    view.update(
        Pose2D(1.0, 2.0, 0.5), path=np.array([(1.0, 2.0), (3.0, 2.0)]), scan=scan(), costmap=costmap(), text="off we go"
    )
    with visit(view) as page:
        frame = page.wait("frame")
        paths = page.wait("paths")["paths"]
        picture = page.wait("costmap")
    assert frame["robots"] == [["", 1.0, 2.0, 0.5]]
    assert frame["text"] == "off we go"
    seen = frame["scans"][0]
    assert seen["name"] == "front"
    assert seen["pose"] == [pytest.approx(1.0 + 0.2 * math.cos(0.5), abs=1e-3), *seen["pose"][1:3], 0.5]
    assert unpack_array(paths[""]).tolist() == [[1.0, 2.0], [3.0, 2.0]]
    assert (picture["width"], picture["height"], picture["resolution"]) == (60, 40, 0.1)


def test_several_robots_have_poses_paths_and_scans_by_name(view: View) -> None:
    line = Path(np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)]))
    view.update({"a": (0.0, 0.0), "b": (2.0, 1.0, math.pi)}, path={"b": line, "a": None}, scan={"b": [scan("left")]})
    with visit(view) as page:
        frame, paths = page.wait("frame"), page.wait("paths")["paths"]
    assert frame["robots"] == [["a", 0.0, 0.0, 0.0], ["b", 2.0, 1.0, pytest.approx(math.pi, abs=1e-3)]]
    assert list(paths) == ["b"]
    assert [one["pose"][:2] for one in frame["scans"]] == [[1.8, 1.0]]


def test_what_is_not_given_stays_and_none_removes_it(view: View) -> None:
    view.update((0.0, 0.0), path=[(0.0, 0.0), (1.0, 0.0)], scan=scan(), costmap=costmap(), text="one")
    with visit(view) as page:
        page.wait("costmap")
        view.update((0.5, 0.0))
        frame = page.wait("frame", lambda message: message["robots"][0][1] == 0.5)
        assert (frame["text"], len(frame["scans"])) == ("one", 1)
        view.update((0.6, 0.0), scan=())  # none has come since
        assert len(page.wait("frame", lambda message: message["robots"][0][1] == 0.6)["scans"]) == 1
        assert not [message for message in page.got if message["type"] == "paths"][1:]
        view.update((0.7, 0.0), path=None, scan=None, costmap=None, text="")
        frame = page.wait("frame", lambda message: message["robots"][0][1] == 0.7)
        assert (frame["text"], frame["scans"]) == ("", [])
        assert page.wait("paths")["paths"] == {}
        assert page.wait("costmap")["png"] is None


def test_what_a_robot_believes_is_drawn_and_stays(view: View) -> None:
    particles = np.array([(1.0, 2.0, 0.5), (1.2, 2.0, 0.4)])
    with visit(view) as page:
        view.update((1.0, 2.0, 0.5))
        assert page.wait("frame")["belief"] is None
        view.update((1.0, 2.0, 0.5), covariance=np.diag([0.04, 0.01, 0.02]), particles=particles)
        believed = page.wait("frame")["belief"]
        assert believed["pose"] == [1.0, 2.0, 0.5]
        assert believed["ellipse"][:2] == pytest.approx([0.4895, 0.2448], abs=1e-3)
        assert unpack_array(believed["particles"]).tolist() == [[0, 0, 500], [20, 0, 400]]
        view.update((2.0, 2.0, 0.5))
        assert page.wait("frame")["belief"]["pose"] == [2.0, 2.0, 0.5]
        places = (Hypothesis(Pose2D(2.5, 2.0), 0.6), Hypothesis(Pose2D(7.0, 2.0), 0.4))
        estimate = Estimate(0.0, Pose2D(2.5, 2.0), None, state="ambiguous", hypotheses=places)
        view.update((2.0, 2.0, 0.5), estimate=estimate, particles=None, covariance=None)
        believed = page.wait("frame")["belief"]
        assert (believed["pose"][:2], believed["state"], len(believed["places"])) == ([2.5, 2.0], "ambiguous", 2)
        assert (believed["ellipse"], believed["particles"]) == (None, None)
        view.update((2.0, 2.0, 0.5), estimate=None)
        assert page.wait("frame")["belief"] is None


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"particles": [(1.0, 2.0)]}, r"shape \(N, 3\)"),
        ({"particles": [(1.0, 2.0, math.nan)]}, "finite"),
        ({"covariance": [[1.0, 0.0], [0.0, 1.0]]}, "3 x 3"),
        ({"estimate": (1.0, 2.0)}, "Estimate"),
        ({"pose": {"a": (0.0, 0.0), "b": (1.0, 0.0)}, "particles": [(1.0, 2.0, 0.0)]}, "single robot"),
    ],
)
def test_a_wrong_belief_says_what_to_give_and_leaves_what_was_shown(
    view: View, given: dict[str, object], says: str
) -> None:
    view.update((1.0, 2.0))
    with pytest.raises(InputError, match=says):
        view.update(**{"pose": (5.0, 5.0), **given})  # type: ignore[arg-type]
    with visit(view) as page:
        frame = page.wait("frame")
        assert (frame["robots"], frame["belief"]) == ([["", 1.0, 2.0, 0.0]], None)


def test_the_newest_scan_of_each_lidar_stays(view: View) -> None:
    view.update((0.0, 0.0), scan=[scan("left"), scan("right")])
    view.update((1.0, 0.0), scan=scan("left", (3.0, 3.0, 3.0)))
    with visit(view) as page:
        scans = {one["name"]: one for one in page.wait("frame")["scans"]}
    assert scans["left"]["pose"][0] == pytest.approx(1.2)
    assert scans["right"]["pose"][0] == pytest.approx(0.2)


def test_a_robot_that_is_not_given_any_more_takes_its_path_and_scan_with_it(view: View) -> None:
    view.update({"a": (0, 0), "b": (1, 1)}, path={"b": [(0, 0), (1, 1)]}, scan={"b": scan()})
    view.update({"a": (0, 0)})
    with visit(view) as page:
        frame = page.wait("frame")
    assert [robot[0] for robot in frame["robots"]] == ["a"]
    assert frame["scans"] == []


def test_a_costmap_that_is_equal_to_the_one_before_is_not_sent_again(view: View) -> None:
    with visit(view) as page:
        for i in range(30):
            view.update((0.1 * i, 0.0), costmap=costmap())
            time.sleep(0.04)
        page.ping()
    assert len([message for message in page.got if message["type"] == "costmap"]) == 1


def test_yaws_that_add_up_over_many_turns_are_no_degrees(view: View) -> None:
    view.update((0.0, 0.0, 20.0 * math.pi + 0.5))  # a warning would be an error here
    view.update(np.array([0.0, 0.0, 7.0]))
    with visit(view) as page:
        assert page.wait("frame")["robots"][0][3] == pytest.approx(7.0 - 2.0 * math.pi, abs=1e-3)


def test_a_page_that_is_opened_late_gets_the_whole_trail(view: View) -> None:
    for i in range(101):
        view.update((0.05 * i, 0.0))
    with visit(view) as page:
        log = page.wait("log", lambda message: message["rows"][-1][1] > 4.8)
    logs = [message for message in page.got if message["type"] == "log"]
    assert [one["from"] for one in logs] == [sum(len(one["rows"]) for one in logs[:i]) for i in range(len(logs))]
    along = [row[1] for one in logs for row in one["rows"]]
    assert (along[0], along[-1]) == (0.0, pytest.approx(5.0, abs=0.15))
    assert np.diff(along) == pytest.approx(0.125, abs=0.03)
    assert {row[5] for row in log["rows"]} == {""}


def test_trails_stay_bounded_and_a_page_gets_them_anew_once_they_are_thinned() -> None:
    trails = Trails()
    got: list[list[float]] = []
    cursor = 0
    for i in range(3 * MOST_ROWS):
        trails.add([float(i)])
        if i % 97 == 0:
            text, cursor = trails.read(cursor) or pytest.fail("there are rows")
            message = json.loads(text)
            got = got[: message["from"]] + message["rows"]
            assert got[-1] == [float(i)]
    text, _ = trails.read(0) or pytest.fail("there are rows")
    rows = [row[0] for row in json.loads(text)["rows"]]
    assert MOST_ROWS // 2 < len(rows) <= MOST_ROWS
    assert rows == sorted(set(rows))
    assert rows[0] == 0.0
    assert trails.read(10 * MOST_ROWS) is None


# Worlds and robots ---------------------------------------------------------------------------------------------------


@pytest.fixture
def room(tmp_path: FilePath) -> FilePath:
    data = np.zeros((40, 60), dtype=np.int8)
    data[0] = data[-1] = 100
    OccupancyGrid(data, resolution=0.1, origin=Pose2D(0.0, 0.0)).save(tmp_path / "room.yaml")
    return tmp_path / "room.yaml"


def test_a_map_a_world_a_name_a_file_or_nothing_is_what_is_around(room: FilePath) -> None:
    scenes = []
    robot = Robot.load("jackal")
    for world in (OccupancyGrid.load(room), room, str(room), World.from_map(room), "maze", None):
        with trundle.show(world, robot, open_browser=False) as view, visit(view) as page:
            scenes.append(page.wait("scene")["scene"])
    assert [bool(scene["instances"]) for scene in scenes] == [True] * 5 + [False]
    assert [scene["map"] is not None for scene in scenes] == [True] * 5 + [False]
    assert [(scene["map"]["width"], scene["map"]["height"]) for scene in scenes[:3]] == [(60, 40)] * 3


@pytest.mark.parametrize(
    ("world", "says"),
    [
        ("warehose", "Did you mean 'warehouse'"),
        (5, "the world of a view must be of type World or OccupancyGrid, got int; give one of these, a world's name"),
        ("nowhere.yaml", "nowhere.yaml"),
    ],
)
def test_a_wrong_world_says_what_to_give(world: object, says: str) -> None:
    with pytest.raises(trundle.TrundleError) as raised:
        trundle.show(world, "jackal", open_browser=False)  # type: ignore[arg-type]
    assert says in str(raised.value)


def test_a_scenario_or_robot_is_no_world(tmp_path: FilePath) -> None:
    trundle.Scenario.make(world="warehouse").save(tmp_path / "s.yaml")
    with pytest.raises(InputError, match=r"s\.yaml: this is a scenario, not a world or a map"):
        trundle.show(tmp_path / "s.yaml", "jackal", open_browser=False)
    with pytest.raises(UnknownNameError, match="jackal"):
        trundle.show(None, "jakal", open_browser=False)


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"pose": None}, "a pose is (x, y) or (x, y, yaw), got None"),
        ({"pose": (1.0,)}, "a pose is (x, y) or (x, y, yaw)"),
        ({"pose": (1.0, math.nan, 0.0)}, "finite"),
        ({"pose": {}}, "1 to 100 robots, got 0"),
        (
            {"pose": {1: (0, 0)}},
            "the name of a robot in a view must be of type str, got int; give poses as {name: pose}",
        ),
        ({"pose": (0, 0), "path": np.zeros((3, 4))}, "shape (N, 2) or (N, 3), got shape (3, 4)"),
        ({"pose": (0, 0), "path": "there"}, "path must be an array of numbers"),
        ({"pose": (0, 0), "path": [(0, math.inf)]}, "path must have finite numbers"),
        ({"pose": (0, 0), "path": np.zeros((100_001, 2))}, "give at most 100000"),
        ({"pose": {"a": (0, 0), "b": (1, 1)}, "path": [(0, 0)]}, "there are several robots: give path as {name: path}"),
        (
            {"pose": {"a": (0, 0)}, "path": {"c": [(0, 0)]}},
            "path of 'c', which is no robot of this update; its robots: 'a'",
        ),
        ({"pose": (0, 0), "scan": {"c": scan()}}, "pose is a single pose"),
        ({"pose": (0, 0), "scan": np.zeros(3)}, "scan must be of type Scan, got ndarray; give a trundle.Scan"),
        ({"pose": (0, 0), "scan": [scan(), 5]}, "scan must be of type Scan, got int"),
        (
            {"pose": (0, 0), "costmap": np.zeros((3, 3))},
            "costmap must be of type Costmap, got ndarray; of a map make one",
        ),
        ({"pose": (0, 0), "text": 5}, "text must be of type str, got int; write values into it"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_a_wrong_update_says_what_to_give_and_leaves_what_was_shown(
    view: View, given: dict[str, object], says: str
) -> None:
    view.update((1.0, 2.0), text="before")
    with pytest.raises(InputError) as raised:
        view.update(**given)  # type: ignore[arg-type]
    assert says in str(raised.value)
    with visit(view) as page:
        frame = page.wait("frame")
    assert (frame["text"], frame["robots"]) == ("before", [["", 1.0, 2.0, 0.0]])
