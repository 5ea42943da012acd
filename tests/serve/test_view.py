"""`trundle.show`: what a loop of one's own shows, and what it gets back."""

import json
import math
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path as FilePath

import numpy as np
import pytest

import trundle
from support.page_visitor import OpenPage, Visitor
from trundle.costmap import Costmap
from trundle.errors import InputError, UnknownNameError
from trundle.geometry import Goal, Pose2D
from trundle.maps import OccupancyGrid
from trundle.observation import Estimate, Hypothesis, Scan
from trundle.page.encoding import unpack_array
from trundle.path import Path
from trundle.robots import Robot
from trundle.serve import View, opening
from trundle.serve.view_feed import MOST_ROWS, Trails
from trundle.worlds import World


@pytest.fixture
def view() -> Iterator[View]:
    with trundle.show(None, "jackal", open_browser=False) as opened:
        yield opened


def visit(view: View) -> OpenPage:
    return Visitor.of_address(view.address).open()


def scan(lidar: str = "front", ranges: tuple[float, ...] = (1.0, 2.0)) -> Scan:
    return Scan(lidar, 0.0, Pose2D(0.2, 0.0), 0.3, np.linspace(0.0, 1.0, len(ranges)), np.array(ranges), 0.1, 10.0)


def costmap(robot: str = "jackal") -> Costmap:
    grid = OccupancyGrid(np.zeros((40, 60), dtype=np.int8), resolution=0.1, origin=Pose2D(0.0, 0.0))
    return Costmap.from_grid(grid, Robot.load(robot))


def until(found: Callable[[], bool]) -> None:
    deadline = time.monotonic() + 10.0
    while not found():
        assert time.monotonic() < deadline
        time.sleep(0.01)


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


def test_a_pose_that_is_set_on_the_page_is_taken_once(view: View) -> None:
    view.update((1.0, 2.0))
    with visit(view) as page:
        page.wait("frame")
        assert view.take_pose() is None
        for x in (3.0, 4.0):
            page.send("pose", pose=[x, 2.0, 0.5], covariance=[[0.25, 0, 0], [0, 0.25, 0], [0, 0, 0.0685]])
        page.ping()
        assert view.take_pose() == Pose2D(4.0, 2.0, 0.5)
        assert view.take_pose() is None
        assert view.goal is None


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


# What the loop gets --------------------------------------------------------------------------------------------------


def test_a_clicked_goal_stays_and_is_taken_once(view: View) -> None:
    assert view.goal is None
    assert view.take_goal() is None
    view.update((0.0, 0.0))
    with visit(view) as page:
        page.send("goal", pose=[1.0, 2.0, None])
        page.send("goal", pose=[3.0, 4.0, 1.5])
        page.ping()
        assert view.goal == Goal(3.0, 4.0, 1.5)
        assert view.take_goal() == Goal(3.0, 4.0, 1.5)
        assert view.take_goal() is None
        assert view.goal == Goal(3.0, 4.0, 1.5)
        view.update((0.0, 0.0))
        assert page.wait("frame", lambda message: message["goals"])["goals"] == [[3.0, 4.0, 1.5]]
        view.goal = None
        view.update((0.0, 0.0))
        page.wait("frame", lambda message: not message["goals"])
        view.goal = (1.0, 1.0)
        assert view.goal == Goal(1.0, 1.0)
        assert view.take_goal() is None  # nobody clicked it


def test_held_keys_count_as_let_go_when_the_page_tells_them_no_more(view: View) -> None:
    with visit(view) as page:
        page.send("keys", held=["w", "ArrowUp"])
        page.ping()
        assert view.keys == {"w", "ArrowUp"}
        page.send("keys", held=[])
        page.ping()
        assert view.keys == frozenset()
        page.send("keys", held=["w"])
        page.ping()
        time.sleep(0.35)
        assert view.keys == frozenset()


def test_held_keys_count_as_let_go_when_the_connection_is_lost(view: View, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("trundle.serve.view.DEAD_MAN_S", 3600.0)
    page = visit(view)
    page.send("keys", held=["w"])
    page.ping()
    assert view.keys == {"w"}
    page.close()
    until(lambda: not view.keys)


def test_only_the_page_that_drives_gives_goals_and_keys(view: View) -> None:
    with visit(view) as first, visit(view) as second:
        second.send("keys", held=["w"])
        second.send("goal", pose=[1.0, 1.0, None])
        assert "another page drives" in second.wait("error")["text"]
        second.ping()
        assert (view.goal, view.keys) == (None, frozenset())
        first.ping()


@pytest.mark.parametrize(
    "message",
    [
        {"type": "keys"},
        {"type": "keys", "held": "w"},
        {"type": "keys", "held": [""]},
        {"type": "keys", "held": ["k" * 25]},
        {"type": "keys", "held": [str(i) for i in range(17)]},
        {"type": "restart", "seed": None},
        {"type": "manual", "v": 1.0, "w": 0.0},
        {"type": "goal", "pose": [1.0]},
        {"type": "setup"},
    ],
    ids=str,
)
def test_anything_else_is_refused_with_a_reason(view: View, message: dict[str, object]) -> None:
    with visit(view) as page:
        page.socket.send(json.dumps(message))
        assert page.wait("error")["text"]
    assert (view.goal, view.keys) == (None, frozenset())


# Opening and closing -------------------------------------------------------------------------------------------------


def test_the_address_is_printed_and_the_page_is_not_opened(capsys: pytest.CaptureFixture[str]) -> None:
    with trundle.show(None, "jackal", open_browser=False) as view:
        assert view.address in capsys.readouterr().out
        assert view.address.startswith("http://127.0.0.1:")


def test_the_page_is_opened_where_there_is_a_browser(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    opened: list[str] = []
    monkeypatch.setattr(opening, "is_remote", lambda: False)
    monkeypatch.setattr(opening, "open_browser", lambda address: opened.append(address) or len(opened) == 1)
    with trundle.show(None, "jackal") as view:
        assert opened == [view.address]
    assert "No browser" not in capsys.readouterr().out
    with trundle.show(None, "jackal"):
        assert "No browser was found here" in capsys.readouterr().out


def test_over_ssh_it_says_how_to_reach_the_page(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("SSH_CONNECTION", "here")
    with trundle.show(None, "jackal") as view:
        assert f"ssh -L {view.port}:localhost:{view.port}" in capsys.readouterr().out


def test_two_views_at_once_are_apart(view: View) -> None:
    with trundle.show(None, "nova_carter", open_browser=False) as other:
        view.update((1.0, 0.0))
        other.update((2.0, 0.0))
        with visit(view) as one, visit(other) as two:
            assert one.wait("scene")["scene"]["robot"]["name"] == "jackal"
            assert two.wait("scene")["scene"]["robot"]["name"] == "nova_carter"
            assert one.wait("frame")["robots"][0][1] == 1.0
            assert two.wait("frame")["robots"][0][1] == 2.0
            one.send("goal", pose=[1.0, 1.0, None])
            one.ping()
            assert (view.goal, other.goal) == (Goal(1.0, 1.0), None)


def test_closing_tells_the_pages_and_an_update_after_it_is_refused() -> None:
    with trundle.show(None, "jackal", open_browser=False) as view, visit(view) as page:
        view.update((0.0, 0.0))
        page.wait("frame")
        page.send("keys", held=["w"])
        page.ping()
        view.close()
        page.wait("end")
        assert view.keys == frozenset()
        with pytest.raises(InputError, match=r"this view is closed: .* trundle\.show"):
            view.update((0.0, 0.0))
        view.close()
    assert "closed" in repr(view)
    assert "The view is closed" in view._repr_html_()


def test_a_loop_that_raises_closes_its_view() -> None:
    with pytest.raises(ZeroDivisionError), trundle.show(None, "jackal", open_browser=False) as view:
        1 / 0  # noqa: B018
    with pytest.raises(ConnectionRefusedError):
        Visitor.of_address(view.address)


def test_an_update_never_waits_for_a_page_that_does_not_read(view: View) -> None:
    with visit(view):
        path = np.zeros((20_000, 2))
        began = time.process_time()
        for i in range(200):
            view.update((0.01 * i, 0.0), path=path, text="x" * 1000)
        assert time.process_time() - began < 5.0


def test_nothing_stays_behind_a_program_that_forgets_to_close(tmp_path: FilePath) -> None:
    program = "import trundle; trundle.show(None, 'jackal', open_browser=False).update((0, 0))"
    done = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (0, "")


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


# Safety --------------------------------------------------------------------------------------------------------------


def test_a_notebook_shows_the_page_in_a_frame_of_the_loopback_address(view: View) -> None:
    html = view._repr_html_()
    assert f'<iframe src="http://127.0.0.1:{view.port}/frame?token=' in html
    visitor = Visitor.of_address(view.address)
    status, headers, body = visitor.get(f"/frame?token={visitor.token}")
    assert status == 200
    assert b"trundle" in body
    assert "frame-ancestors http://localhost:* http://127.0.0.1:*" in headers["Content-Security-Policy"]
    assert "X-Frame-Options" not in headers
    assert headers["Referrer-Policy"] == "no-referrer"


def test_a_frame_needs_the_token_and_its_socket_the_origin(view: View) -> None:
    visitor = Visitor.of_address(view.address)
    assert visitor.get("/frame")[0] == 401
    assert visitor.get("/frame?token=wrong")[0] == 401
    assert visitor.get(f"/frame?token={visitor.token}&token={visitor.token}")[0] == 401
    assert visitor.get(f"/frame?token={visitor.token}", Host="evil.example")[0] == 403
    assert visitor.get(f"/frame?token={visitor.token}", Origin="http://evil.example")[0] == 403
    for path, status in (("/ws?token=wrong", 401), (f"/ws?token={visitor.token}", 403)):
        assert (
            visitor.get(path, Origin="http://evil.example" if status == 403 else f"http://{visitor.host}")[0] == status
        )


def test_the_page_itself_must_not_be_framed_and_needs_the_token(view: View) -> None:
    visitor = Visitor.of_address(view.address)
    assert visitor.get("/")[0] == 401
    status, headers, _ = visitor.see("/")
    assert status == 200
    assert "frame-ancestors 'none'" in headers["Content-Security-Policy"]
    assert headers["X-Frame-Options"] == "DENY"
