"""A run in progress and its pages, by real sockets."""

import socket
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import pytest

from support.command_line import room
from support.doubtful import DoubtfulLocalizer
from support.page_attack import attack
from support.page_visitor import OpenPage, Visitor
from trundle.mission import Observer, Session
from trundle.navigation import Navigator
from trundle.robots import Robot
from trundle.serve.choosing import Choices
from trundle.serve.hub import Hub
from trundle.serve.run_feed import Watch
from trundle.serve.server import Page, PageServer
from trundle.serve.steerer import Steerer
from trundle.sim import world_of
from trundle.sim.kinematic import KinematicSimulator
from trundle.worlds import World


class LiveRoom:
    """A robot that drives in a room, in a thread, and the server of its page."""

    def __init__(self, server: PageServer, steerer: Steerer, hub: Hub) -> None:
        self.server, self.steerer, self.hub = server, steerer, hub

    def visit(self) -> Visitor:
        return Visitor(self.server)


@contextmanager
def _driving(
    goal: tuple[float, float] = (6.5, 3.5), observers: Sequence[Observer] = (), **options: Any
) -> Iterator[LiveRoom]:
    grid, robot = room(), Robot.load("nova_carter")
    simulator = KinematicSimulator(World.from_map(grid), robot)
    hub, steerer = Hub(choices=Choices(None)), Steerer()
    hub.controls = steerer

    def make(_: int | None) -> Session:
        watch = Watch(hub, 1, None, world=lambda: world_of(simulator), steering=steerer.steering)
        return Session(
            simulator,
            Navigator(grid, robot),
            (1.0, 1.0),
            goal,
            observers=[watch, watch.recorded, *observers],
            steering=steerer.steering,
            **options,
        )

    with PageServer(hub, Page("<!doctype html>", "default-src 'none'"), port=0) as server:
        thread = threading.Thread(target=steerer.drive, args=(make,))
        with Visitor(server).open() as driver:
            driver.wait("hello")
            thread.start()
            driver.wait("run")
            live = LiveRoom(server, steerer, hub)
            live.driver = driver  # type: ignore[attr-defined]
            yield live
            if thread.is_alive():
                driver.send("end")
            thread.join(60.0)
            assert not thread.is_alive()


@pytest.fixture
def live() -> Iterator[LiveRoom]:
    with _driving() as one:
        yield one


def _rows(page: OpenPage) -> list[list]:
    rows: list[list] = []
    for message in page.got:
        if message["type"] == "log":
            assert message.get("from", 0) == len(rows)
            rows += message["rows"]
    return rows


def test_a_paused_run_holds_the_time_and_one_step_is_one_period(live: LiveRoom) -> None:
    page: OpenPage = live.driver  # type: ignore[attr-defined]
    page.send("pause", paused=True)
    before = page.wait("frame", lambda message: message["paused"])["t"]
    page.send("step")
    after = page.wait("frame", lambda message: message["t"] != before)
    assert (round(after["t"] - before, 4), after["paused"]) == (0.05, True)


def test_a_page_that_comes_late_or_again_has_the_whole_log(live: LiveRoom) -> None:
    first: OpenPage = live.driver  # type: ignore[attr-defined]
    first.send("speed", factor="max")
    first.wait("end")
    for _ in range(2):
        with live.visit().open() as late:
            late.wait("end")
            rows = _rows(late)
            assert rows == _rows(first)
            assert [row[0] for row in rows] == pytest.approx([0.05 * index for index in range(len(rows))], abs=1e-3)
            events = [event["kind"] for message in late.got if message["type"] == "log" for event in message["events"]]
            assert (events[0], events[-1]) == ("start", "end")


def test_a_robot_driven_by_hand_stops_when_the_connection_is_cut(live: LiveRoom) -> None:
    visitor = live.visit()
    page: OpenPage = live.driver  # type: ignore[attr-defined]
    with visitor.open() as other:
        mine = other.wait("hello")["client"]
        for _ in range(40):
            page.send("manual", v=0.0, w=0.5)
            if page.wait("frame")["manual"] is not None and abs(page.got[-1]["row"][5]) > 0.2:
                break
        page.socket.socket.shutdown(socket.SHUT_RDWR)
        other.wait("drivers", lambda message: message["driver"] is None)
        other.wait("frame", lambda message: abs(message["row"][5]) < 1e-3 and abs(message["row"][4]) < 1e-3)
        other.send("drive")
        other.wait("drivers", lambda message: message["driver"] == mine)
        other.send("end")
        other.wait("end")


def test_a_box_is_shown_and_a_goal_outside_the_map_is_refused_in_words(live: LiveRoom) -> None:
    page: OpenPage = live.driver  # type: ignore[attr-defined]
    page.send("box", x=4.0, y=4.0, yaw=0.0, size=[0.3, 0.3, 0.3])
    assert page.wait("solid")["instances"][0]["shape"] == "box"
    page.send("goal", pose=[100.0, 100.0, None])
    assert "100" in page.wait("error")["text"]


def test_a_pose_is_refused_in_words_where_the_robot_knows_its_own(live: LiveRoom) -> None:
    page: OpenPage = live.driver  # type: ignore[attr-defined]
    page.send("pose", pose=[2.0, 2.0, 0.5], covariance=[[0.25, 0, 0], [0, 0.25, 0], [0, 0, 0.07]])
    assert "there is no localizer" in page.wait("error")["text"]
    page.send("reinitialize")
    assert "there is no localizer" in page.wait("error")["text"]


def test_the_page_tells_the_localizer_where_the_robot_is() -> None:
    localizer = DoubtfulLocalizer(shift=0.0)
    with _driving(localizer=localizer) as live:
        page: OpenPage = live.driver  # type: ignore[attr-defined]
        page.send("pose", pose=[2.0, 2.0, 0.5], covariance=[[0.25, 0, 0], [0, 0.25, 0], [0, 0, 0.07]])
        frame = page.wait("frame", lambda one: abs(one["belief"]["pose"][1] - 2.0) < 0.3)
        assert frame["belief"]["state"] == "ambiguous"
        assert localizer.covariance is not None
        assert localizer.covariance.tolist() == [[0.25, 0.0, 0.0], [0.0, 0.25, 0.0], [0.0, 0.0, 0.07]]
        page.send("reinitialize")
        page.ping()
        page.send("end")
        page.wait("end")
    assert localizer.searches == 1


def test_a_page_that_does_not_read_delays_nobody(live: LiveRoom) -> None:
    visitor = live.visit()
    page: OpenPage = live.driver  # type: ignore[attr-defined]
    with socket.create_connection(("127.0.0.1", visitor.port)) as slow:
        slow.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        slow.sendall(
            f"GET /ws HTTP/1.1\r\nHost: {visitor.host}\r\nOrigin: http://{visitor.host}\r\nCookie: {visitor.cookie}\r\n"
            "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
            "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n".encode()
        )
        page.wait("drivers", lambda message: message["clients"] == 2)
        page.send("speed", factor="max")
        assert page.wait("end")["outcome"] == "arrived"
        assert len(_rows(page)) > 20


def test_an_attack_leaves_the_run_and_its_page_as_they_are(live: LiveRoom) -> None:
    page: OpenPage = live.driver  # type: ignore[attr-defined]
    page.send("speed", factor=0.1)  # so that the run lasts longer than the attack
    attacker = threading.Thread(target=attack, args=(live.visit(), 1500), kwargs={"seed": 1})
    attacker.start()
    while attacker.is_alive():
        seen = len(page.got)
        page.wait("frame")
        if any(message["type"] == "drivers" and message["request"] is not None for message in page.got[seen:]):
            page.send("drive", answer="refuse")
    attacker.join()
    page.send("speed", factor="max")
    assert page.wait("end")["outcome"] == "arrived"
    rows = _rows(page)
    assert [row[0] for row in rows] == pytest.approx([0.05 * index for index in range(len(rows))], abs=1e-3)
    assert live.visit().get("/")[0] == 401


class _Held:
    """Holds a run at its end, as one does that writes a large folder."""

    def __init__(self) -> None:
        self.at_end, self.let_go, self.count = threading.Event(), threading.Event(), 0

    def on_start(self, run: object) -> None:
        pass

    def on_step(self, step: object) -> None:
        pass

    def on_end(self, episode: object) -> None:
        self.count += 1
        if self.count == 1:
            self.at_end.set()
            assert self.let_go.wait(30.0)


def test_clicks_while_a_run_ends_do_not_reach_the_one_that_a_restart_begins() -> None:
    held = _Held()
    with _driving(observers=[held]) as live:
        page: OpenPage = live.driver  # type: ignore[attr-defined]
        page.send("restart", seed=None)
        assert held.at_end.wait(30.0)
        page.send("pause", paused=True)
        page.send("end")
        assert [page.wait("error")["text"] for _ in range(2)] == ["the run has ended"] * 2
        held.let_go.set()
        page.wait("run")
        page.send("speed", factor="max")
        assert page.wait("end")["outcome"] == "arrived"
    assert held.count == 2


def test_an_order_reaches_the_run_of_its_number_alone() -> None:
    with _driving() as live:
        page: OpenPage = live.driver  # type: ignore[attr-defined]
        first = page.got[-1] if page.got[-1]["type"] == "run" else page.wait("run")
        page.send("restart", seed=None, run=first["orders"])
        second = page.wait("run")
        assert second["orders"] == first["orders"] + 1
        page.send("end", run=first["orders"])
        page.send("pause", paused=True, run=second["orders"] + 1)
        said = [page.wait("error")["text"] for _ in range(2)]
        assert said == [f"run {first['orders']} has ended", f"run {second['orders'] + 1} has not begun"]
        page.send("pause", paused=True, run=second["orders"])
        page.wait("frame", lambda message: message["paused"])


def test_a_page_that_drove_an_earlier_run_by_hand_stops_no_later_one_as_it_leaves() -> None:
    with _driving() as live, live.visit().open() as other:
        page: OpenPage = live.driver  # type: ignore[attr-defined]
        page.send("manual", v=0.0, w=0.3)
        page.wait("frame", lambda message: message["manual"] is not None)
        page.send("restart", seed=None)
        page.wait("run")
        page.wait("frame", lambda message: message["manual"] is None)
        page.close()
        other.wait("drivers", lambda message: message["driver"] is None)
        mine = next(message for message in other.got if message["type"] == "hello")["client"]
        other.send("drive")
        other.wait("drivers", lambda message: message["driver"] == mine)
        other.send("speed", factor="max")
        assert other.wait("end")["outcome"] == "arrived"
