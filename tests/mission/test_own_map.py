"""Runs in which the localizer makes a map: the agent gets it, the run folder has it, and explorations end with it."""

import json

import numpy as np
import pytest

import trundle
from support.marking_mapper import MarkingLocalizer
from support.sensed_rooms import GOAL, ROBOT, START, block, room
from trundle.errors import InputError, ScenarioError
from trundle.geometry import Pose2D, Twist2D
from trundle.localization import create_localizer
from trundle.maps import OccupancyGrid
from trundle.mission import Outcome, Scenario, Session, SetPose, Steering
from trundle.mission.exploring import exploring
from trundle.mission.fields import StartError
from trundle.mission.own_map import Correction, describe_corrections
from trundle.navigation import Navigator
from trundle.navigation.agents import CommandScript
from trundle.observation import Observation
from trundle.record.run_folder import RunFolder
from trundle.sim import simulate


class Listener(CommandScript):
    """Drives straight on, and keeps the maps that it gets."""

    def __init__(self, seconds):
        super().__init__([(0.3, 0.0, seconds)])
        self.got = []

    def set_map(self, grid, *, corrected):
        self.got.append((grid, corrected))


def listen(localizer, seconds=4.0, jump_at=None):
    agent, world = Listener(seconds), room(block("box", 4.6, 2.5, 5.4, 3.5))
    with (
        simulate(world, ROBOT, backend="kinematic", lidar=True) as sim,
        Session(sim, agent, START, localizer=localizer) as session,
    ):
        times, steps = [], []
        while (step := session.step()) is not None:
            if len(agent.got) > len(times):
                times.append(step.state.time)
            steps.append(step)
            if jump_at is not None and abs(step.state.time - jump_at) < 1e-6:
                localizer.jump(0.0, 0.4)
        return agent.got, times, steps, session.finish()


def test_the_agent_gets_the_map_once_a_second():
    got, times, steps, episode = listen(MarkingLocalizer(ROBOT))
    assert np.diff(times) == pytest.approx(1.0, abs=0.06)
    assert not any(corrected for _, corrected in got)
    assert steps[-1].map is got[-1][0]
    assert episode.own_map is not None
    assert episode.own_map.corrections == ()


def test_a_correction_brings_the_map_at_once_and_is_named():
    got, times, _, episode = listen(MarkingLocalizer(ROBOT), jump_at=2.5)
    assert [corrected for _, corrected in got].count(True) == 1
    assert any(abs(time - 2.55) < 0.06 for time in times)
    (named,) = episode.own_map.corrections
    assert (named.moved_m, named.time) == pytest.approx((0.4, 2.55), abs=0.06)


def test_the_localizer_finishes_its_map_once_at_the_end():
    localizer = MarkingLocalizer(ROBOT)
    listen(localizer)
    assert localizer.finished == 1


def test_slam_says_with_the_map_where_it_comes_from():
    _, _, steps, episode = listen("slam")
    track = steps[-1].map_track
    assert len(track.poses) > 2
    assert track.poses[:, 0] == pytest.approx(np.sort(track.poses[:, 0]))
    assert (track.loops.shape[1], track.corrections) == (2, ())
    assert len(episode.own_map.track.poses) >= len(track.poses)


def test_other_localizers_make_none():
    _, times, steps, episode = listen("odometry")
    assert times == []
    assert (steps[-1].map, steps[-1].map_track) == (None, None)
    assert episode.own_map is None


def test_one_of_another_package_is_asked_for_its_map_too():
    class Foreign:
        corrections = 3

        def reset(self, pose):
            self.pose = pose

        def update(self, observation):
            return self.pose

        def map(self):
            return OccupancyGrid(np.zeros((3, 3), np.int8), 0.05)

    adapted = create_localizer(Foreign(), None, ROBOT)
    assert adapted.map().shape == (3, 3)
    assert adapted.corrections == 3
    adapted.finish()
    plain = create_localizer(lambda observation: Pose2D(0.0, 0.0), None, ROBOT)
    assert (plain.map(), plain.corrections) == (None, 0)


def test_corrections_in_words():
    assert describe_corrections(()) == "none of 0.05 m or more"
    one = Correction(0.42, 0.0523598, 83.2, 3.14, 4.2)
    assert describe_corrections([one]) == "0.42 m and 3.0° at 83 s, at (3.1, 4.2)"


def test_the_run_folder_has_the_map_and_its_pictures(tmp_path):
    with (
        simulate(room(), ROBOT, backend="kinematic", lidar=True) as sim,
        RunFolder(tmp_path / "run", page=False) as folder,
    ):
        episode = trundle.run(
            sim, Navigator(None, ROBOT), START, GOAL, localizer=MarkingLocalizer(ROBOT), observers=[folder]
        )
    assert episode.arrived
    grid = OccupancyGrid.load(tmp_path / "run" / "own_map.yaml")
    assert (grid.data == 0).sum() * 0.05**2 > 50.0
    names = {path.name for path in (tmp_path / "run").iterdir()}
    assert {"overlay.png", "own_map.png", "own_map_overlay.png"} <= names
    assert names & {"own_map.mp4", "own_map.gif"}
    assert json.loads((tmp_path / "run" / "episode.json").read_text())["own_map"]["corrections"] == []


# Explorations ---------------------------------------------------------------------------------------------------------


def test_a_maze_is_explored_by_slam():
    exploration = trundle.explore("maze", seed=1, backend="kinematic", time_limit_s=12.0)
    assert not exploration.finished
    assert "not finished within 12.0 s" in exploration.message
    assert (exploration.grid.data == 0).sum() * 0.05**2 > 5.0
    assert len(exploration.graph.poses) > 3
    assert exploration.open


def test_mppi_explores_among_people():
    people = [{"crowd": "person", "count": 3}]
    exploration = trundle.explore(
        "maze", seed=2, backend="kinematic", controller="mppi", movers=people, time_limit_s=5.0
    )
    assert exploration.episode.metrics.contacts == ()
    assert exploration.episode.metrics.distance_m > 1.0
    assert len(exploration.graph.poses) > 3


@pytest.mark.parametrize("settings", [{"start_error": {"distance": 0.3}}, {"lidar_errors": {"dropouts": 0.01}}])
@pytest.mark.parametrize("given", [Scenario.make(world="maze", agent="explorer"), "maze"], ids=["scenario", "name"])
def test_an_exploration_takes_settings_of_its_lidars_and_its_localizer(given, settings):
    exploration = trundle.explore(given, backend="kinematic", time_limit_s=0.5, **settings)
    assert exploration.episode.outcome is Outcome.TIMED_OUT
    assert exploration.grid is not None


def test_an_exploration_without_lidars_is_refused():
    with pytest.raises(ScenarioError, match="give lidar: true"):
        trundle.explore("maze", lidar=False)


def test_an_exploration_has_no_goal_and_no_other_agent():
    with pytest.raises(ScenarioError, match="has no goal"):
        trundle.explore("maze", goal=(3.0, 1.0))
    with pytest.raises(ScenarioError, match="driven by the agent 'explorer'"):
        exploring(Scenario.make(world={"name": "maze"}, agent="mine.py:Agent"))


@pytest.mark.parametrize(("options", "kept"), [({}, False), ({"low_objects": True}, True)])
@pytest.mark.parametrize("name", ["warehouse", "office", "lot"])
def test_what_no_lidar_sees_is_left_out_unless_it_is_asked_for(name, options, kept):
    scenario = exploring(Scenario.make(world={"name": name, "options": options}))
    assert scenario.world.options["low_objects"] is kept
    assert (scenario.known_map, scenario.localizer.name, scenario.agent.name) == (False, "slam", "explorer")


# Told where it is -----------------------------------------------------------------------------------------------------


def test_a_pose_that_is_set_on_the_way_keeps_the_map_and_corrects_nothing():
    agent, steering = Listener(3.0), Steering()
    with (
        simulate(room(block("box", 4.6, 2.5, 5.4, 3.5)), ROBOT, backend="kinematic", lidar=True) as sim,
        Session(sim, agent, START, localizer="slam", steering=steering) as session,
    ):
        while session.time < 2.0:
            step = session.step()
        nodes, known = len(step.map_track.poses), (step.map.data >= 0).sum()
        there = step.estimate.pose
        steering.put(SetPose((there.x + 1.0, there.y, there.yaw)))
        first = session.step()
        while (step := session.step()) is not None:
            last = step
        episode = session.finish()
    assert first.estimate.pose.x == pytest.approx(there.x + 1.0, abs=0.1)
    assert any(corrected for _, corrected in agent.got)
    assert len(last.map_track.poses) > nodes
    assert (last.map.data >= 0).sum() >= known
    assert episode.own_map.corrections == ()


class Told:
    """A localizer of another package, which keeps what it was told."""

    def __init__(self):
        self.told = []

    def reset(self, pose):
        self.told.append(("reset", pose))

    def relocate(self, pose, *, covariance):
        self.told.append(("relocate", pose, covariance))

    def update(self, observation):
        return observation.odometry


def test_a_localizer_of_another_package_may_be_told_on_the_way_or_starts_over():
    told = create_localizer(Told(), None, ROBOT)
    told.relocate(START, covariance=np.eye(3), seed=1)
    assert told.localizer.told[0][:2] == ("relocate", START)
    other = create_localizer("odometry", None, ROBOT)
    other.relocate(START)
    assert other.update(Observation(1.0, Twist2D(), Pose2D(5.0, 5.0))).pose == START


def test_how_often_the_map_changed_never_goes_back():
    localizer = create_localizer("slam", None, ROBOT)
    counts = [localizer.corrections]
    for reset in (localizer.reset, localizer.reset, localizer.relocate):
        reset(Pose2D(1.0, 2.0))
        counts.append(localizer.corrections)
    assert (np.diff(counts) > 0).all()


def test_goals_need_a_known_start_where_the_localizer_makes_the_map():
    with simulate(room(), ROBOT, backend="kinematic", lidar=True) as sim:
        unknown = StartError(unknown=True)
        for localizer in ("slam", MarkingLocalizer(ROBOT)):
            with pytest.raises(InputError, match="goals need a known start"):
                Session(sim, Navigator(None, ROBOT), START, GOAL, localizer=localizer, start_error=unknown)
        Session(sim, Listener(1.0), START, localizer="slam", start_error=unknown).finish()
