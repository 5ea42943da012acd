import json

import numpy as np

from trundle.geometry import Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.mission import LiveStatus, MapTrack, Step
from trundle.navigation import NavigationStatus
from trundle.serve import run_feed
from trundle.serve.run_feed import RunFeed, RunLog
from trundle.sim import RobotState


def _read_all(log: RunLog) -> list[dict]:
    cursor, messages = 0, []
    while (found := log.read(cursor)) is not None:
        text, cursor = found
        messages.append(json.loads(text))
    return messages


def test_an_empty_log_has_nothing_to_read() -> None:
    log = RunLog()
    log.add([], [], [])
    assert log.read(0) is None


def test_what_was_added_is_read_in_order_and_once() -> None:
    log = RunLog()
    log.add([[0.0, 1], [0.1, 2]], [{"t": 0}], [])
    first, cursor = log.read(0) or ("", 0)
    log.add([[0.2, 3]], [], [{"kind": "goal"}])
    assert json.loads(first)["rows"] == [[0.0, 1], [0.1, 2]]
    second, cursor = log.read(cursor) or ("", 0)
    assert json.loads(second) == {
        "type": "log",
        "from": 2,
        "rows": [[0.2, 3]],
        "paths": [],
        "events": [{"kind": "goal"}],
    }
    assert log.read(cursor) is None


def test_what_comes_before_the_first_row_is_not_dropped_by_what_follows() -> None:
    log = RunLog()
    log.add([], [], [{"kind": "start"}])
    first, cursor = log.read(0) or ("", 0)
    log.add([[0.0, 1]], [], [{"kind": "plan"}])
    second, _ = log.read(cursor) or ("", 0)
    assert json.loads(first)["from"] == 0
    assert "from" not in json.loads(second)
    assert json.loads((log.read(0) or ("", 0))[0])["events"] == [{"kind": "start"}, {"kind": "plan"}]


def test_a_client_that_comes_late_gets_everything_in_few_messages_of_limited_size() -> None:
    log = RunLog()
    rows = [[index / 20, index * 0.123456] for index in range(40_000)]
    for row in rows:
        log.add([row], [], [])
    messages = _read_all(log)
    assert [row for message in messages for row in message["rows"]] == rows
    assert 2 <= len(messages) <= 10
    for message in messages:
        assert message["rows"][0] == rows[message["from"]]


def test_numbers_that_json_has_not_become_null() -> None:
    log = RunLog()
    log.add([[float("nan"), float("inf"), 1.0]], [], [])
    assert _read_all(log)[0]["rows"] == [[None, None, 1.0]]


# The map that the robot makes -----------------------------------------------------------------------------------------


def _show(feed: RunFeed, now: float, step: Step, monkeypatch) -> dict | None:
    """The `map` message that a step leads to at a time of the clock, or None."""
    before = feed.map.number
    monkeypatch.setattr(run_feed.time, "monotonic", lambda: now)
    feed._step = step
    feed.encode(LiveStatus("running"), watched=True)
    return json.loads(feed.map.text) if feed.map.number > before else None


def _step(grid: OccupancyGrid | None, track: MapTrack | None = None) -> Step:
    state = RobotState(1.0, Pose2D(0.0, 0.0), Twist2D(), (0.0, 0.0), (0.0, 0.0), Pose2D(0.0, 0.0))
    return Step(1, state, Twist2D(), 0, None, NavigationStatus.DRIVING, map=grid, map_track=track)


def test_a_map_that_grows_is_sent_once_and_a_new_one_after_a_second(monkeypatch) -> None:
    feed = RunFeed(1, "{}")
    first, second = (OccupancyGrid(np.full((20, 10 * n), 37, np.int8), 0.05) for n in (1, 2))
    track = MapTrack(np.zeros((3, 3)), np.array([(0, 2)], np.int32))
    shown = _show(feed, 10.0, _step(first, track), monkeypatch)
    assert (shown["width"], shown["height"], shown["poses"]["shape"], shown["loops"]["shape"]) == (
        10,
        20,
        [3, 2],
        [1, 4],
    )
    assert _show(feed, 12.0, _step(first), monkeypatch) is None
    assert _show(feed, 12.1, _step(second), monkeypatch)["width"] == 20
    assert _show(feed, 12.9, _step(first), monkeypatch) is None
    assert _show(feed, 13.2, _step(first), monkeypatch)["width"] == 10
    assert feed.newest == (feed.frame, feed.map, feed.costmap)


def test_a_large_map_comes_less_often(monkeypatch) -> None:
    feed, rng = RunFeed(1, "{}"), np.random.default_rng(0)
    cells = (rng.random((2000, 2000)) < 0.5).astype(np.int8) * 100  # the worst that can be: half a megabyte
    grids = [OccupancyGrid(cells, 0.05), OccupancyGrid(cells, 0.05)]
    shown = _show(feed, 10.0, _step(grids[0]), monkeypatch)
    assert shown is not None
    waits = len(feed.map.text) / 400_000
    assert waits > 1.2
    assert _show(feed, 10.0 + 0.95 * waits, _step(grids[1]), monkeypatch) is None
    assert _show(feed, 10.0 + 1.05 * waits, _step(grids[1]), monkeypatch) is not None


def test_a_run_without_such_a_map_sends_none(monkeypatch) -> None:
    feed = RunFeed(1, "{}")
    assert _show(feed, 10.0, _step(None), monkeypatch) is None
    assert feed.map.number == 0
