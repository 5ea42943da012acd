"""Where there is no path, the episode says whether the search was complete."""

import json

import pytest

import trundle
from trundle.errors import BlockedPoseError, NoPathError, OutsideMapError, PlanningError, PlanningStoppedError
from trundle.mission.episode import Episode, Outcome
from trundle.record import RunFolder


class Planner:
    """Raises this error at the first plan."""

    def __init__(self, error):
        self.error = error

    def plan(self, costmap, start, goal):
        raise self.error


def drive(planner, folder):
    world = trundle.World.generate("office", seed=3)
    grid = trundle.OccupancyGrid.from_world(world)
    navigator = trundle.Navigator(grid, "nova_carter", planner=planner)
    start, goal = trundle.sample_mission(navigator.costmap, 0)
    with trundle.simulate(world, "nova_carter", backend="kinematic") as sim, RunFolder(folder, video=False) as record:
        return trundle.run(sim, navigator, start, goal, observers=[record])


@pytest.mark.parametrize(
    ("error", "complete"),
    [
        (NoPathError("walls"), True),
        (PlanningStoppedError("too long", status="exhausted"), False),
        (PlanningError("none found"), False),
    ],
)
def test_an_episode_without_a_path_says_whether_the_search_was_complete(error, complete, tmp_path):
    episode = drive(Planner(error), tmp_path / "run")
    assert (episode.outcome, episode.complete) == (Outcome.NO_PATH, complete)
    assert Episode.load(tmp_path / "run").complete is complete
    page = (tmp_path / "run" / "report.html").read_text()
    assert ("complete: there is none" in page, "not complete: none found" in page) == (complete, not complete)


def test_ends_that_cannot_be_reached_need_no_search():
    assert BlockedPoseError("a wall").complete
    assert OutsideMapError("far away").complete


def test_a_record_of_an_older_version_does_not_say_it(tmp_path):
    drive(Planner(NoPathError("walls")), tmp_path / "run")
    file = tmp_path / "run" / "episode.json"
    values = json.loads(file.read_text())
    assert values.pop("search_complete") is True
    file.write_text(json.dumps(values))
    assert Episode.load(tmp_path / "run").complete is None
