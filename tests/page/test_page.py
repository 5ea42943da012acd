import base64
import hashlib
import json
import math
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest

from support.doubtful import COVARIANCE, DoubtfulLocalizer
from trundle.geometry import Goal, Pose2D, Twist2D
from trundle.mission.metrics import cross_track_errors
from trundle.mission.observers import SteeringReport
from trundle.mission.own_map import Correction, MapTrack
from trundle.navigation import NavigationStatus
from trundle.navigation.behaviors import BehaviorRun
from trundle.observation import Scan
from trundle.page import COLUMNS, Events, RunLines, csp, frame_of, info_of, render, row_of
from trundle.page.encoding import pack_array, pack_json, unpack_array, unpack_json
from trundle.page.frames import ellipse_of
from trundle.sim import Contact


class Steps:
    def on_start(self, info):
        self.info, self.steps = info, []

    def on_step(self, step):
        self.steps.append(step)

    def on_end(self, episode):
        self.episode = episode


def column(rows, name):
    return [row[COLUMNS.index(name)] for row in rows]


# Values ---------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["f4", "u4", "i2", "u1"])
def test_arrays_come_back(kind):
    values = np.arange(12).reshape(3, 4)
    packed = pack_array(values, kind)
    assert packed["shape"] == [3, 4]
    np.testing.assert_array_equal(unpack_array(json.loads(json.dumps(packed))), values)
    first = np.frombuffer(base64.b64decode(packed["b64"]), dtype="u1")
    assert first[: int(kind[1])].tolist() == [0] * int(kind[1])
    assert (
        pack_array(np.array([1]), kind)["b64"]
        == base64.b64encode({"f4": b"\0\0\x80\x3f", "u4": b"\1\0\0\0", "i2": b"\1\0", "u1": b"\1"}[kind]).decode()
    )


def test_packed_values_come_back_and_are_always_the_same():
    value = {"rows": [[0.5, None, "driving"]], "name": "로봇"}
    packed = pack_json(value)
    assert packed == pack_json(value)
    assert unpack_json(packed, most_bytes=1000) == value


@pytest.mark.parametrize(
    "damage", [{}, {"gzip": 3}, {"gzip": "!"}, {"gzip": "AAAA"}, {"gzip": pack_json([1])["gzip"][:-12]}]
)
def test_a_damaged_block_is_refused(damage):
    with pytest.raises(ValueError, match=r"damaged|base64|padding"):
        unpack_json(damage, most_bytes=1000)


def test_a_block_that_unpacks_to_too_much_is_refused():
    with pytest.raises(ValueError, match="larger than 1000 bytes"):
        unpack_json(pack_json("0" * 2000), most_bytes=1000)


# Steps ----------------------------------------------------------------------------------------------------------------


def test_rows_are_what_the_trajectory_and_the_metrics_say(drive):
    steps = Steps()
    episode = drive(steps)
    lines = RunLines(steps.info)
    for step in steps.steps:
        lines.add(step)
    lines.end(episode)
    assert lines.info == json.loads(json.dumps(lines.info))
    assert lines.info["start"] == [-3.0, 0.0, 0.0]
    assert lines.info["goals"] == [[3.0, 0.0, 0.0]]
    trajectory = episode.trajectory
    assert len(lines.rows) == len(trajectory)
    for name, expected in (("t", "time"), ("x", "x"), ("y", "y"), ("yaw", "yaw"), ("sent_v", "commanded_v")):
        np.testing.assert_allclose(column(lines.rows, name), getattr(trajectory, expected), atol=1e-4)
    np.testing.assert_allclose(
        column(lines.rows, "cross_track"), cross_track_errors(trajectory, episode.paths), atol=1e-4
    )
    assert min(column(lines.rows, "clearance")) == pytest.approx(episode.metrics.min_clearance_m, abs=0.08)
    assert sum(column(lines.rows, "plan_ms")) == pytest.approx(episode.metrics.planning_ms, abs=0.1)
    assert len(lines.paths) == len(episode.paths)
    np.testing.assert_allclose(unpack_array(lines.paths[0]["points"]), episode.paths[0].poses[:, :2], rtol=1e-6)
    assert [event["kind"] for event in lines.events] == ["start", "plan", "end"]
    assert lines.events[-1]["text"] == f"arrived: {episode.message}"
    left, right = column(lines.rows, "left"), column(lines.rows, "right")
    assert left[-1] == pytest.approx(right[-1], rel=0.02)
    assert left[-1] * 0.14 == pytest.approx(episode.metrics.distance_m, rel=0.02)


def test_the_estimate_has_its_own_columns(drive):
    steps = Steps()
    drive(steps, localizer="odometry")
    row = row_of(steps.steps[40])
    assert column([row], "ex")[0] == pytest.approx(steps.steps[40].estimate.pose.x, abs=1e-4)
    assert column([row], "clearance") == column([row], "cross_track") == [None]


def test_what_a_localizer_believes_is_in_the_frame(drive):
    steps = Steps()
    drive(steps, localizer=DoubtfulLocalizer(count=1000))
    first, last = json.loads(json.dumps([frame_of(steps.steps[5]), frame_of(steps.steps[100])], allow_nan=False))
    estimate = steps.steps[5].estimate
    believed = first["belief"]
    assert believed["pose"] == pytest.approx(estimate.pose.as_tuple(), abs=1e-4)
    assert (believed["state"], last["belief"]["state"]) == ("ambiguous", "localized")
    assert [weight for *_, weight in believed["places"]] == [0.5, 0.3, 0.2]
    packed = unpack_array(believed["particles"])
    assert 300 < len(packed) <= 500
    seen = packed / (100.0, 100.0, 1000.0) + (believed["pose"][0], believed["pose"][1], 0.0)
    np.testing.assert_allclose(seen.mean(axis=0), estimate.particles[:, :3].mean(axis=0), atol=0.03)
    np.testing.assert_allclose(np.cov(seen.T), COVARIANCE, atol=0.01)
    assert info_of(steps.info)["localizer"] == "DoubtfulLocalizer"


def test_a_robot_that_knows_its_true_pose_believes_nothing(drive):
    steps = Steps()
    drive(steps)
    assert frame_of(steps.steps[5])["belief"] is None
    assert column([row_of(steps.steps[5])], "state") == [None]
    assert info_of(steps.info)["localizer"] == "none"


def test_an_ellipse_holds_95_percent_of_positions():
    covariance = np.array([[0.5, 0.3, 0.0], [0.3, 0.4, 0.0], [0.0, 0.0, 0.1]])
    long, short, angle = ellipse_of(covariance)
    points = np.random.default_rng(3).multivariate_normal([0.0, 0.0], covariance[:2, :2], 100_000)
    along = points @ (math.cos(angle), math.sin(angle))
    across = points @ (-math.sin(angle), math.cos(angle))
    assert np.mean((along / long) ** 2 + (across / short) ** 2 < 1.0) == pytest.approx(0.95, abs=0.005)
    assert long > short
    assert ellipse_of(np.full((3, 3), np.nan)) is None


def test_the_state_is_in_the_rows_and_its_changes_are_events(drive):
    lines = {}

    class Observer(Steps):
        def on_start(self, info):
            lines["run"] = RunLines(info)

        def on_step(self, step):
            lines["run"].add(step)

    drive(Observer(), localizer=DoubtfulLocalizer())
    states = column(lines["run"].rows, "state")
    assert (states[0], states[50], states[100]) == ("ambiguous", "lost", "localized")
    found = [(one["t"], one["text"]) for one in lines["run"].events if one["kind"] == "locate"]
    assert [text for _, text in found] == ["ambiguous: 3 places", "lost", "localized"]


def test_a_goal_may_have_any_yaw(drive):
    steps = Steps()
    drive(steps, goal=(-2.0, 0.0))
    info = info_of(steps.info)
    assert info["goals"] == [[-2.0, 0.0, None]]
    assert info["time_limit_s"] > 0.0
    assert info_of(replace(steps.info, time_limit_s=math.inf))["time_limit_s"] is None


def test_points_of_a_scan_are_where_they_were_seen(drive, hall):
    steps = Steps()
    drive(steps, lidar=True)
    step = steps.steps[50]
    frame = json.loads(json.dumps(frame_of(step), allow_nan=False))
    assert len(frame["scans"]) == len(step.scans) > 0
    for scan, shown in zip(step.scans, frame["scans"], strict=True):
        x, y, z, yaw = shown["pose"]
        points = Pose2D(x, y, yaw).transform_points(unpack_array(shown["points"]) / 100.0)
        assert z == pytest.approx(scan.height, abs=1e-3)
        walls = np.minimum(np.abs(np.abs(points[:, 0]) - 4.9), np.abs(np.abs(points[:, 1]) - 3.9))
        pillar = np.abs(np.hypot(points[:, 0], points[:, 1] - 1.5) - 0.3)
        assert np.minimum(walls, pillar).max() < 0.03
        assert 20 < len(points) <= np.isfinite(scan.ranges).sum()


def test_a_scan_that_arrives_late_is_drawn_where_the_robot_was(drive):
    steps = Steps()
    drive(steps)
    moving = steps.steps[60]
    before = steps.steps[56]
    late = Scan(
        "front", before.state.time, Pose2D(0.1, 0.0), 0.3, np.linspace(-1.0, 1.0, 5), np.full(5, 2.0), 0.05, 12.0
    )
    (shown,) = frame_of(moving, scans=(late,))["scans"]
    assert shown["pose"][:2] == pytest.approx([before.state.pose.x + 0.1, before.state.pose.y], abs=0.01)


def test_a_frame_says_what_the_navigator_does(drive):
    steps = Steps()
    drive(steps)
    step = steps.steps[20]
    assert frame_of(step)["doing"] == "driving to the goal"
    blocked = replace(step, message="blocked: obstacle ahead at (1.00, 2.00)")
    assert frame_of(blocked)["doing"] == blocked.message
    spin = BehaviorRun("spin", "no valid control", "running", "", 1.0, 1.0, True)
    assert frame_of(replace(blocked, behaviors=(spin,)))["doing"] == "spin: no valid control"
    assert frame_of(replace(step, status=NavigationStatus.NO_PATH))["doing"] == "no path"
    assert frame_of(replace(step, path=None))["doing"] == "planning"


def test_events_say_what_happens(drive):
    steps = Steps()
    drive(steps)
    events = Events()
    events.start(steps.info)

    def at(index, **changes):
        step = replace(steps.steps[index], **changes)
        events.add(step)
        return step

    at(0)
    at(1, message="blocked: obstacle ahead at (1.00, 2.00)")
    at(2, message="blocked: obstacle ahead at (1.01, 2.00)")
    spin = BehaviorRun("spin", "no valid control", "running", "", 1.0, 1.0, True)
    at(3, behaviors=(spin,))
    done = {"behaviors": (replace(spin, result="failed", message="something is in the path"),)}
    at(4, **done)
    other = {**done, "path": replace(steps.steps[5].path, planner="other")}
    at(5, **other)
    touch = Contact("chassis", "pillar", 1.0, 2.0)
    at(6, state=replace(steps.steps[6].state, contacts=(touch, touch)), **other)
    at(7, state=replace(steps.steps[7].state, contacts=(touch,)), **other)
    at(8, goal=1, **other)
    assert [(event["kind"], event["text"]) for event in events.found] == [
        ("start", "nova_carter at (-3.00, 0.00), goal (3.00, 0.00)"),
        ("plan", "path of 6.00 m"),
        ("blocked", "blocked: obstacle ahead at (1.00, 2.00)"),
        ("recovery", "spin: no valid control"),
        ("recovery", "spin failed: something is in the path"),
        ("replan", "another path of 6.00 m"),
        ("contact", "chassis touches pillar at (1.00, 2.00)"),
        ("goal", "goal 1 reached"),
    ]
    assert [event["t"] for event in events.found[1:]] == [steps.steps[n].state.time for n in (0, 1, 3, 4, 5, 6, 8)]


def test_a_correction_of_the_map_is_named_once(drive):
    steps = Steps()
    drive(steps)
    events = Events()
    one, other = Correction(0.1, 0.02, 3.0, 1.0, 2.0), Correction(0.42, 0.0523598, 5.0, 3.14, 4.2)
    for index, known in enumerate(((), (one,), (one,), (other, one), (other, one))):
        track = MapTrack(np.zeros((2, 3)), np.zeros((0, 2), np.int32), known)
        events.add(replace(steps.steps[index], path=None, map_track=track))
    assert [event["text"] for event in events.found] == [
        "the estimate was corrected by 0.10 m and 1.1° at (1.0, 2.0)",
        "the estimate was corrected by 0.42 m and 3.0° at (3.1, 4.2)",
    ]


def test_the_monitor_is_reported_once_a_second(drive):
    from trundle.control.collision_monitor import MonitorReport

    steps = Steps()
    drive(steps)
    events = Events()
    for index, action in enumerate(("none", "stop", "none", "stop", "slow", *(["none"] * 20), "approach")):
        events.add(replace(steps.steps[index], path=None, monitor=MonitorReport(Twist2D(), action)))
    assert [event["text"] for event in events.found] == [
        "the collision monitor stops the robot",
        "the collision monitor slows the robot",
    ]


def test_steering_is_in_the_events(drive):
    steps = Steps()
    drive(steps)
    events = Events()
    goals = (Goal(3.0, 0.0, 0.0),)
    free = SteeringReport(False, None, "", "", 1.0, goals)
    by_hand = replace(free, manual=Twist2D(0.3, 0.0), by="page 1")
    held = replace(by_hand, held_back="an obstacle on the map")
    more = replace(free, goals=(*goals, Goal(1.0, 2.0)))
    for step, steering in zip(steps.steps, (free, by_hand, held, held, free, more), strict=False):
        events.add(replace(step, path=None, steering=steering))
    assert [(event["kind"], event["text"]) for event in events.found] == [
        ("steer", "driven by hand"),
        ("steer", "held back: an obstacle on the map"),
        ("steer", "driven by the navigator again"),
        ("goal", "goal set: (3.00, 0.00), (1.00, 2.00)"),
    ]
    assert events.found[-1]["goals"] == [[3.0, 0.0, 0.0], [1.0, 2.0, None]]


# HTML -----------------------------------------------------------------------------------------------------------------


class Elements(HTMLParser):
    """The elements of a page, with their attributes and text."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.found = []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.found.append((tag, dict(attrs), []))

    def handle_endtag(self, tag):
        self.found.append(("/", {}, []))

    def handle_data(self, data):
        if self.found:
            self.found[-1][2].append(data)

    def all(self, tag):
        return [(attrs, "".join(text)) for name, attrs, text in self.found if name == tag]


def digest(text):
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def test_the_policy_names_the_script_and_the_style_of_the_page():
    page = Elements(render({"mode": "report"}, title="a run"))
    (policy,) = [attrs["content"] for attrs, _ in page.all("meta") if "http-equiv" in attrs]
    assert policy == csp(live=False)
    rules = dict(rule.split(" ", 1) for rule in policy.split("; "))
    (_, style) = page.all("style")[0]
    boot, script = page.all("script")
    assert boot[0] == {"type": "application/json", "id": "boot"}
    assert script[0] == {}
    assert rules["script-src"] == digest(script[1])
    assert rules["style-src"] == digest(style)
    assert rules["default-src"] == "'none'"
    assert "unsafe" not in policy
    assert "connect-src" not in rules


def test_a_live_page_may_talk_to_its_server_alone():
    rules = dict(rule.split(" ", 1) for rule in csp().split("; "))
    assert rules["connect-src"] == "'self'"
    assert rules["frame-ancestors"] == "'none'"
    assert "http-equiv" not in render({"mode": "live"}, title="live")


def test_a_page_loads_nothing():
    page = Elements(render({"mode": "report"}, title="a run"))
    sources = [attrs[name] for _, attrs, _ in page.found for name in ("src", "href", "action") if name in attrs]
    assert sources == ["data:,"]


HOSTILE = "</script><script>alert(1)</script><!--<script>\u2028\"'&"


def test_names_cannot_leave_their_place():
    boot = {"mode": "report", "run": {"info": {"name": HOSTILE}}, "command": HOSTILE}
    text = render(boot, title=HOSTILE)
    page = Elements(text)
    assert len(page.all("script")) == 2
    assert json.loads(page.all("script")[0][1]) == boot
    assert page.all("title")[0][1] == HOSTILE


def test_the_same_run_gives_the_same_page():
    boot = {"mode": "report", "run": pack_json([1, 2, 3])}
    assert render(boot, title="a run") == render(boot, title="a run")
