"""Sessions: their steps, agents, localizers and latency, and the physics steps between."""

import math
from dataclasses import replace

import numpy as np
import pytest

import trundle
from support.observers import Recorder
from support.sessions import steps_of
from trundle.errors import InputError, ScenarioError, UnknownNameError
from trundle.geometry import Pose2D, Twist2D
from trundle.mission import Episode, Outcome, Rules, Session, Trajectory, run
from trundle.navigation import CommandScript, Latency, NavigationStatus
from trundle.observation import Estimate
from trundle.record.run_folder import RunFolder
from trundle.sim.actuation import Actuation
from trundle.sim.kinematic import KinematicSimulator
from trundle.sim.mujoco.simulator import MujocoSimulator
from trundle.worlds import World

GOAL = (3.0, 4.5)
FORWARD = [(0.4, 0.0, 2.0)]


class Drifting:
    """A localizer that believes to be ahead of the truth by some metres along x."""

    def __init__(self, ahead_m, sim):
        self.ahead_m, self.sim = ahead_m, sim

    def reset(self, pose, *, seed=0):
        self.begin, self.seed = pose, seed

    def update(self, observation):
        pose = self.begin @ observation.odometry
        return Estimate(observation.time, Pose2D(pose.x + self.ahead_m, pose.y, pose.yaw))


# Stepping -------------------------------------------------------------------------------------------------------------


def test_stepping_a_session_is_a_run(make_sim, navigator, start):
    expected = run(make_sim(), navigator, start, GOAL)
    with trundle.Session(make_sim(), navigator, start, GOAL) as session:
        assert (session.time, session.outcome, session.message) == (0.0, None, "")
        first = session.step()
        assert (first.index, session.time, first.state.time) == (1, navigator.dt, navigator.dt)
        steps = [first, *steps_of(session)]
    episode = session.finish()
    assert session.step() is None
    assert episode is session.finish()
    assert session.outcome is episode.outcome is Outcome.ARRIVED
    assert len(steps) == len(episode.trajectory) - 1
    for name in Trajectory.columns():
        np.testing.assert_array_equal(getattr(episode.trajectory, name), getattr(expected.trajectory, name))


def test_a_robot_that_is_knocked_over_is_stuck_at_once(room, navigator, start):
    with MujocoSimulator(World.from_map(room), navigator.robot) as sim:
        session = Session(sim, navigator, start, GOAL)
        while session.time < 1.0:
            session.step()
        assert session.outcome is None
        sim.data.qpos[3:7] = (math.cos(0.8), math.sin(0.8), 0.0, 0.0)
        sim.data.qpos[2] += 0.5
        session.step()
        assert session.step() is None
        episode = session.finish()
    assert (episode.outcome, len(episode.trajectory)) == (Outcome.STUCK, 22)
    assert episode.message.startswith("tipped over by 9")
    assert episode.message.endswith("after 1.1 s")


def test_a_step_has_what_the_agent_gets_and_does(make_sim, navigator, start):
    session = Session(make_sim(), navigator, start, GOAL)
    step = session.step()
    assert step.observation.time == step.estimate.time == step.state.time
    assert step.observation.odometry == step.state.odometry
    assert step.estimate.pose == step.state.pose
    assert step.costmap is navigator.costmap
    assert step.sent is step.command
    assert (step.scans, step.movers, step.monitor) == ((), (), None)


def test_a_step_has_what_the_agent_took_and_says(carter, navigator, start):
    watcher = Recorder()
    sim = KinematicSimulator(World("hall", ()), carter)
    with trundle.Session(sim, navigator, start, GOAL, observers=[watcher]) as session:
        steps_of(session)
    assert watcher.info.world is sim.world
    assert watcher.info.grid is navigator.grid
    assert watcher.steps[0].tick_s == 0.0
    assert all(step.tick_s > 0.0 for step in watcher.steps[1:])
    planned = sum(step.planning_s for step in watcher.steps)
    assert planned * 1e3 == pytest.approx(watcher.episode.metrics.planning_ms)
    assert {step.message for step in watcher.steps} == {""}
    assert watcher.steps[1].behaviors == ()


def test_a_session_that_is_left_early_is_aborted(make_sim, navigator, start):
    with Session(make_sim(), navigator, start, GOAL) as session:
        session.step()
    assert session.outcome is Outcome.ABORTED
    assert "ended from outside" in session.finish().message
    assert session.error is None


def test_what_aborts_a_session_can_be_seen(make_sim, navigator, start):
    session = Session(make_sim(breaks_at=0.2), navigator, start, GOAL)
    steps_of(session)
    assert session.outcome is Outcome.ABORTED
    assert "left the world" in str(session.error)


def test_the_agent_and_the_localizer_get_the_seed(make_sim, carter, start):
    class Seeded(CommandScript):
        def reset(self, *, seed=0):
            super().reset()
            self.seed = seed

    sim = make_sim()
    script, localizer = Seeded(FORWARD), Drifting(0.0, sim)
    Session(sim, script, start, localizer=localizer, seed=11)
    assert (script.seed, localizer.seed, sim.seeds) == (11, 11, [11])


# Agents ---------------------------------------------------------------------------------------------------------------


def test_an_agent_without_a_goal_drives_until_it_is_finished(make_sim, start, tmp_path):
    with RunFolder(tmp_path / "run", video=False) as folder:
        episode = run(make_sim(), CommandScript(FORWARD), start, None, observers=[folder])
    assert episode.observer_errors == ()
    assert episode.outcome is Outcome.FINISHED
    assert (episode.goals, episode.goals_reached, episode.planner) == ((), 0, "none")
    assert episode.controller == "CommandScript"
    assert episode.trajectory.x[-1] == pytest.approx(start.x + 0.8)
    assert (episode.metrics.min_clearance_m, episode.metrics.measured_on) == (None, "nothing")
    again = Episode.load(tmp_path / "run")
    assert again.metrics == episode.metrics
    assert again.time_limit_s == math.inf
    assert (tmp_path / "run" / "overlay.png").is_file()


def test_an_agent_without_a_goal_can_be_limited_in_time(make_sim, start):
    episode = run(make_sim(), CommandScript(FORWARD), start, None, time_limit_s=1.0)
    assert episode.outcome is Outcome.TIMED_OUT
    assert episode.metrics.time_s == pytest.approx(1.0)


def test_a_script_with_a_goal_is_finished_beside_it(make_sim, start):
    assert run(make_sim(), CommandScript(FORWARD), start, GOAL).outcome is Outcome.FINISHED


def test_periods_may_differ_in_length(make_sim, start):
    episode = run(make_sim(), CommandScript([(0.4, 0.0, 0.12)]), start, None)
    assert np.diff(episode.trajectory.time).tolist() == pytest.approx([0.05, 0.05, 0.02])


def test_a_navigator_needs_a_goal(make_sim, navigator, start):
    with pytest.raises(ScenarioError, match="a goal is"):
        Session(make_sim(), navigator, start)


def test_an_agent_that_claims_to_have_arrived_must_be_there(make_sim, start):
    class Claiming(CommandScript):
        def update(self, observation, estimate):
            self.status = NavigationStatus.ARRIVED
            return Twist2D()

    assert run(make_sim(), Claiming([]), start, GOAL).outcome is Outcome.STUCK
    assert run(make_sim(), Claiming([]), start, start).outcome is Outcome.ARRIVED
    assert run(make_sim(), Claiming([]), start, None).outcome is Outcome.FINISHED


# Localizers -----------------------------------------------------------------------------------------------------------


def test_exact_odometry_drives_as_the_truth_does(make_sim, navigator, start):
    episode = run(make_sim(), navigator, start, GOAL, localizer="odometry")
    assert episode.outcome is Outcome.ARRIVED
    assert episode.metrics.position_error_m == pytest.approx(0.0, abs=1e-9)
    np.testing.assert_allclose(episode.trajectory.estimates, episode.trajectory.poses, atol=1e-9)


def test_a_goal_that_is_reached_only_by_the_estimate_is_not_reached(make_sim, navigator, start):
    sim = make_sim()
    episode = run(sim, navigator, start, GOAL, localizer=Drifting(-0.5, sim))
    assert episode.outcome is Outcome.ARRIVED_BY_ESTIMATE
    assert not episode.arrived
    assert episode.metrics.position_error_m == pytest.approx(0.5)
    assert episode.metrics.spl == 0.0
    assert "0.50 m from where the robot is" in episode.message
    np.testing.assert_allclose(episode.trajectory.estimate_x, episode.trajectory.x - 0.5)


class Wandering(Drifting):
    """Is off by more and more, and says so for a while."""

    def update(self, observation):
        step = round(observation.time / 0.05)
        self.ahead_m = 0.001 * min(step, 100)
        state = "lost" if 20 <= step < 30 else "ambiguous" if 30 <= step < 40 else "localized"
        return replace(super().update(observation), state=state)


def test_the_error_of_the_estimate_is_measured_over_the_run_and_time_not_localized_is_counted(
    make_sim, navigator, start
):
    sim = make_sim()
    metrics = run(sim, navigator, start, GOAL, localizer=Wandering(0.0, sim)).metrics
    periods = round(metrics.time_s / 0.05)
    errors = np.minimum(np.arange(periods + 1), 100) * 0.001
    assert metrics.localization_error_m == pytest.approx(errors.mean())
    assert metrics.localization_error_p95_m == pytest.approx(np.percentile(errors, 95.0))
    assert metrics.position_error_m == pytest.approx(errors[-1])
    assert metrics.lost_s == pytest.approx(20 * 0.05)


def test_without_a_localizer_there_is_no_error_and_nothing_is_lost(make_sim, navigator, start):
    metrics = run(make_sim(), navigator, start, GOAL).metrics
    assert (metrics.localization_error_m, metrics.localization_error_p95_m, metrics.lost_s) == (0.0, 0.0, 0.0)


def test_arrival_is_judged_by_the_estimate_for_the_robot_and_by_the_truth_for_the_metrics(make_sim, navigator, start):
    """It stops where its estimate is at the goal. Where the truth is not, the run is no success."""
    for offset, outcome in ((-0.2, Outcome.ARRIVED), (-0.4, Outcome.ARRIVED_BY_ESTIMATE)):
        sim = make_sim()
        episode = run(sim, navigator, start, GOAL, localizer=Drifting(offset, sim))
        believed, true = episode.trajectory.estimates[-1], episode.trajectory.poses[-1]
        assert np.hypot(*(believed[:2] - GOAL[:2])) <= 0.25
        assert (np.hypot(*(true[:2] - GOAL[:2])) <= 0.25) == (outcome is Outcome.ARRIVED)
        assert episode.outcome is outcome
        assert (episode.metrics.spl > 0.0) == (outcome is Outcome.ARRIVED)


def test_a_goal_within_the_error_is_reached(make_sim, navigator, start):
    sim = make_sim()
    episode = run(sim, navigator, start, GOAL, localizer=Drifting(0.01, sim))
    assert episode.outcome is Outcome.ARRIVED
    assert episode.metrics.position_error_m == pytest.approx(0.01)


def test_an_unknown_localizer_is_refused(make_sim, navigator, start):
    with pytest.raises(UnknownNameError, match="odometry"):
        Session(make_sim(), navigator, start, GOAL, localizer="odometri")


# Arrival by the rules of a benchmark ----------------------------------------------------------------------------------


def test_by_the_rules_of_a_benchmark_the_run_ends_where_the_robot_truly_is(make_sim, navigator, start):
    sim = make_sim()
    rules = Rules(arrival_radius=1.0)
    episode = run(sim, navigator, start, GOAL, rules=rules, localizer=Drifting(-0.1, sim))
    assert episode.outcome is Outcome.ARRIVED
    assert 0.9 < math.dist(episode.trajectory.poses[-1, :2], GOAL) <= 1.0
    assert math.dist(episode.trajectory.poses[-2, :2], GOAL) > 1.0
    assert episode.goals_reached == 1
    assert episode.metrics.spl == pytest.approx(1.0, abs=0.05)


def test_the_radius_of_arrival_is_of_the_last_goal(make_sim, navigator, start):
    goals = [(3.0, 4.0), GOAL]  # the first within the radius of the last
    episode = run(make_sim(), navigator, start, goals, rules=Rules(arrival_radius=1.0))
    assert (episode.outcome, episode.goals_reached) == (Outcome.ARRIVED, 2)
    assert min(math.dist(pose[:2], goals[0]) for pose in episode.trajectory.poses) <= 0.25


# Latency --------------------------------------------------------------------------------------------------------------


class Listening(CommandScript):
    """Keeps when it got scans of which time, and its latency."""

    def reset(self, *, seed=0):
        super().reset()
        self.heard = []

    def set_latency(self, latency):
        self.latency = latency

    def update(self, observation, estimate):
        self.heard += [(round(observation.time, 3), round(scan.time, 3)) for scan in observation.scans]
        return super().update(observation, estimate)


def test_scans_arrive_late_with_their_own_time(carter, start):
    agent, latency = Listening(FORWARD), Latency(scan_age_s=0.12)
    with KinematicSimulator(World("empty", ()), carter, lidar=["front"]) as sim:
        run(sim, agent, start, None, latency=latency, monitor=False)
    assert agent.latency is latency
    assert len(agent.heard) > 30
    assert all(0.12 - 1e-9 <= now - measured <= 0.12 + 0.05 for now, measured in agent.heard)
    assert [measured for _, measured in agent.heard] == sorted({measured for _, measured in agent.heard})


def test_commands_arrive_late(carter, start):
    script = CommandScript([(0.4, 0.0, 1.0)])
    with KinematicSimulator(World("empty", ()), carter) as sim:
        punctual = run(sim, script, start, None).trajectory
        late = run(sim, script, start, None, latency=Latency(command_delay_s=0.2)).trajectory
    np.testing.assert_array_equal(late.x[:5], start.x)
    np.testing.assert_allclose(late.x[4:], punctual.x[:-4])


def test_a_latency_is_a_latency(make_sim, navigator, start):
    with pytest.raises(InputError, match="a run's latency"):
        Session(make_sim(), navigator, start, GOAL, latency=0.1)


# Substeps -------------------------------------------------------------------------------------------------------------


class Fine:
    """Follows the physics steps, and may fail at one."""

    def __init__(self, fails_at=None):
        self.substeps, self.steps, self.fails_at = [], [], fails_at

    def on_start(self, run):
        pass

    def on_substep(self, substep):
        if len(self.substeps) == self.fails_at:
            raise RuntimeError("full")
        self.substeps.append(substep)

    def on_step(self, step):
        self.steps.append(step)

    def on_end(self, episode):
        pass


@pytest.mark.parametrize("kind", [KinematicSimulator, MujocoSimulator])
def test_an_observer_can_follow_the_physics_steps_and_changes_nothing(kind, carter, start):
    script, fine = CommandScript([(0.4, 0.3, 1.0)]), Fine()
    with kind(World("empty", ()), carter) as sim:
        alone = run(sim, script, start, None)
        watched = run(Actuation(wheel_radius=1.0001).simulate(sim), script, start, None, observers=[fine])
        same = run(sim, script, start, None, observers=[fine, Fine(fails_at=7)])
        run(sim, script, start, None)
    assert watched.observer_errors == ()
    assert [type(error) for error in same.observer_errors] == [RuntimeError]
    np.testing.assert_array_equal(alone.trajectory.poses, same.trajectory.poses)
    assert len(fine.substeps) == 2 * 200
    assert [substep.time for substep in fine.substeps[:200]] == pytest.approx(np.arange(1, 201) * 0.005)
    at_ends = fine.substeps[9:200:10]
    assert [substep.pose for substep in at_ends] == [step.state.pose for step in fine.steps[1:21]]
    assert [substep.twist for substep in at_ends] == [step.state.twist for step in fine.steps[1:21]]


def test_a_simulator_without_substeps_runs_without_them(make_sim, start):
    fine = Fine()
    assert run(make_sim(), CommandScript(FORWARD), start, None, observers=[fine]).observer_errors == ()
    assert fine.substeps == []
    assert len(fine.steps) == 41
