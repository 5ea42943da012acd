import math

import pytest

from trundle.errors import InputError
from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.geometry.solids import Box, Solid
from trundle.robots import Robot
from trundle.sim import Simulator, world_of
from trundle.sim.actuation import Actuation
from trundle.sim.kinematic import KinematicSimulator
from trundle.sim.mujoco.simulator import MujocoSimulator
from trundle.sim.wrapper import DelayedSimulator
from trundle.worlds import World

EMPTY = World("empty", ())
CARTER = Robot.load("nova_carter")
DT = 0.05


def drive(simulator, command, periods=60, start=Pose2D(0.0, 0.0)):
    states = [simulator.reset(start)]
    states += [simulator.step(command, DT) for _ in range(periods)]
    return states


@pytest.mark.parametrize("latency", [0.02, 0.05, 0.12, 0.3])
@pytest.mark.parametrize("kind", [KinematicSimulator, MujocoSimulator])
def test_latency_shifts_the_run_in_time(kind, latency):
    with kind(EMPTY, CARTER) as exact, DelayedSimulator(kind(EMPTY, CARTER), latency) as late:
        punctual = drive(exact, Twist2D(0.6, 0.3), 80)
        delayed = drive(late, Twist2D(0.6, 0.3), 80)
    shift = Pose2D(punctual[-1].twist.v * latency, 0.0)
    behind = delayed[-1].pose
    assert [state.time for state in delayed] == pytest.approx([state.time for state in punctual])
    assert delayed[0].pose == delayed[math.floor(latency / DT)].pose or kind is MujocoSimulator
    assert behind.distance_to(punctual[-1].pose) == pytest.approx(shift.x, abs=0.01)


def test_a_reset_forgets_commands_that_are_on_their_way():
    with DelayedSimulator(KinematicSimulator(EMPTY, CARTER), 0.2) as sim:
        drive(sim, Twist2D(0.5, 0.0), 2)
        sim.reset(Pose2D(1.0, 0.0))
        for _ in range(10):
            state = sim.step(Twist2D(), DT)
    assert state.pose == Pose2D(1.0, 0.0)


def test_contacts_of_all_parts_of_a_period_are_reported():
    wall = World("wall", (Solid("wall", Box((0.1, 4.0, 1.0)), Pose3D((0.9, 0.0, 0.5))),))
    with DelayedSimulator(KinematicSimulator(wall, CARTER), 0.03) as sim:
        touched = [state.contacts for state in drive(sim, Twist2D(0.5, 0.0))]
    with KinematicSimulator(wall, CARTER) as exact:
        expected = [state.contacts for state in drive(exact, Twist2D(0.5, 0.0))]
    first, reference = (next(k for k, each in enumerate(some) if each) for some in (touched, expected))
    assert first in (reference, reference + 1)
    assert {contact.other for contact in touched[first]} == {"wall"}


def test_it_is_a_simulator_of_the_same_world():
    with DelayedSimulator(KinematicSimulator(EMPTY, CARTER), 0.1) as sim:
        assert isinstance(sim, Simulator)
        assert world_of(sim) is EMPTY
        assert sim.robot is CARTER


def test_odometry_of_other_wheels_counts_late_commands():
    with DelayedSimulator(Actuation(wheel_radius=1.05).simulate(KinematicSimulator(EMPTY, CARTER)), 0.03) as sim:
        state = drive(sim, Twist2D(0.5, 0.0))[-1]
    assert state.odometry.x == pytest.approx(state.pose.x / 1.05)


# Other physics steps and control periods ------------------------------------------------------------------------------


class Minimal:
    """A simulator with the required members only, of which each period is one call."""

    def __init__(self, sim):
        self._sim, self.robot, self.reset, self.close = sim, sim.robot, sim.reset, sim.close
        self.calls = []

    def step(self, command, dt):
        self.calls.append((command.v, dt))
        return self._sim.step(command, dt)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


def moves_at(sim, inner, period, seconds):
    """When the first physics step ends that moves a robot which is sent a command at the time 0."""
    steps = []
    inner.on_substep = steps.append
    sim.reset(Pose2D(0.0, 0.0))
    for _ in range(round(seconds / period)):
        sim.step(Twist2D(0.5, 0.0), period)
    return next(each.time for each in steps if each.wheel_speeds.left > 1e-3)


@pytest.mark.parametrize("timestep", [0.001, 0.002, 1 / 300, 1 / 240, 0.005])
@pytest.mark.parametrize("delay", [0.0, 0.001, 0.05, 0.1, 1.0])
@pytest.mark.parametrize("steps", [1, 6, 15])
def test_a_command_takes_effect_at_the_first_physics_step_after_the_delay(timestep, delay, steps):
    inner = KinematicSimulator(EMPTY, CARTER, timestep=timestep)
    at = moves_at(DelayedSimulator(inner, delay), inner, steps * timestep, delay + 0.2)
    assert at == pytest.approx((math.ceil(delay / timestep - 1e-6) + 1) * timestep)


@pytest.mark.parametrize("timestep", [0.002, 1 / 300, 1 / 240, 0.005])
def test_a_robot_in_mujoco_moves_after_the_delay_at_every_timestep(timestep):
    inner = MujocoSimulator(EMPTY, CARTER, timestep=timestep)
    period = timestep * round(0.02 / timestep)
    with DelayedSimulator(inner, 0.05) as sim:
        at = moves_at(sim, inner, period, 0.3)
        state = sim.step(Twist2D(0.5, 0.0), period)
    assert 0.05 < at < 0.05 + 4 * timestep
    assert state.time == pytest.approx(period * (round(0.3 / period) + 1))


@pytest.mark.parametrize(("period", "delay"), [(0.002, 0.05), (0.002, 1.0), (0.05, 0.05), (0.05, 0.12), (0.03, 0.1)])
def test_no_more_commands_wait_than_fit_into_the_delay(period, delay):
    sim = DelayedSimulator(KinematicSimulator(EMPTY, CARTER, timestep=0.002 if period < 0.03 else 0.01), delay)
    sim.reset(Pose2D(0.0, 0.0))
    sent = []
    for number in range(round(3.0 / period)):
        sent.append(Twist2D(0.0001 * number, 0.0))
        sim.step(sent[-1], period)
        assert len(sim._pending) <= math.ceil(delay / period - 1e-6) + 1


@pytest.mark.parametrize("delay", [0.001, 0.05, 0.1, 1.0])
def test_in_a_simulator_that_does_not_say_how_long_its_steps_are_a_command_takes_effect_in_the_next_period(delay):
    sim = Minimal(KinematicSimulator(EMPTY, CARTER, timestep=1 / 300))
    delayed = DelayedSimulator(sim, delay)
    delayed.reset(Pose2D(0.0, 0.0))
    for _ in range(30):
        delayed.step(Twist2D(0.5, 0.0), 0.05)
    assert {dt for _, dt in sim.calls} == {0.05}
    assert [v for v, _ in sim.calls].index(0.5) == math.ceil(delay / 0.05 - 1e-6)
    assert delayed.delay_in(0.05) == pytest.approx(0.05 * math.ceil(delay / 0.05 - 1e-6))


def test_control_periods_of_changing_length_keep_the_delay():
    sim = Minimal(KinematicSimulator(EMPTY, CARTER, timestep=0.001))
    sim.timestep = 0.001
    delayed = DelayedSimulator(sim, 0.01)
    delayed.reset(Pose2D(0.0, 0.0))
    for v, dt in ((0.1, 0.004), (0.2, 0.02), (0.3, 0.001), (0.4, 0.05)):
        delayed.step(Twist2D(v, 0.0), dt)
    changes, clock = {}, 0
    for v, dt in sim.calls:
        changes.setdefault(v, clock)
        clock += round(dt * 1000)
    assert changes == {0.0: 0, 0.1: 10, 0.2: 14, 0.3: 34, 0.4: 35}


def test_a_period_that_is_no_multiple_of_the_physics_step_is_refused_as_without_a_delay():
    messages = []
    for delay in (0.0, 0.05):
        sim = KinematicSimulator(EMPTY, CARTER)
        sim = DelayedSimulator(sim, delay) if delay else sim
        sim.reset(Pose2D(0.0, 0.0))
        with pytest.raises(InputError, match=r"control period of 0\.033") as caught:
            sim.step(Twist2D(), 1 / 30)
        messages.append(str(caught.value))
    assert messages[0] == messages[1]


@pytest.mark.parametrize("timestep", [0.0, -0.01, math.nan, "5 ms"])
def test_a_timestep_that_is_none_is_refused(timestep):
    sim = Minimal(KinematicSimulator(EMPTY, CARTER))
    sim.timestep = timestep
    with pytest.raises(InputError, match="timestep"):
        DelayedSimulator(sim, 0.1).step(Twist2D(), 0.05)
