"""The check that every localizer must pass."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import cast, get_args

import numpy as np

from trundle.errors import InputError, SensorWarning
from trundle.geometry import Pose2D, Pose3D, Twist2D, wrap_angle
from trundle.geometry.solids import Box, Solid
from trundle.localization import Localizer, create_localizer
from trundle.localization.localizer import LocalizerLike
from trundle.maps import OccupancyGrid
from trundle.observation import Estimate, LocalizationState, Observation
from trundle.robots import Robot
from trundle.sim.kinematic import KinematicSimulator
from trundle.testing.conformance import ConformanceError, accept, expect
from trundle.worlds import World

_DT = 0.05
_START = Pose2D(-2.0, -1.0, 0.4)
_NEAR = 1e-6
_ODOM_ORIGIN = Pose2D(7.0, -3.0, 2.0)
"""Where the map's origin is in the odom frame of the check: odometry does not start where the map does."""


@dataclass(frozen=True, slots=True)
class LocalizerTolerances:
    """Allowed errors of a localizer's estimates, in a room that its map shows, with exact odometry.

    Attributes:
        position_m: Largest error of the position [m].
        yaw_rad: Largest error of the yaw [rad].
    """

    position_m: float = 0.3
    yaw_rad: float = math.radians(10.0)


def check_localizer(
    localizer: LocalizerLike,
    *,
    robot: Robot | None = None,
    tolerances: LocalizerTolerances = LocalizerTolerances(),
) -> None:
    """Check that a localizer meets the contract of `trundle.localization.Localizer`.

    A robot drives through a room, with exact odometry that starts anywhere. Estimates carry the time of their
    observation, fit the odometry through `T_map_odom`, and stay near the truth. The same seed and
    observations give the same estimates, after a reset and in another localizer; two localizers share no state.
    Observations need no scans, and the estimate follows them alone: it has no other access to a simulation. A time that
    does not increase raises an `InputError`, after which the localizer continues.

    Args:
        localizer: A localizer in any of the ways of `LocalizerLike`, or a function that makes one of map and robot.
        robot: The robot to drive; Nova Carter by default.
        tolerances: Allowed errors of the estimates.

    Raises:
        ConformanceError: If a requirement is not met.
    """
    driven = Robot.load("nova_carter") if robot is None else robot
    world = _room()
    grid = OccupancyGrid.from_world(world, resolution=0.05, z_range=driven.z_range)
    truths, observations = _drive(world, driven)

    def make(grid: OccupancyGrid, robot: Robot) -> Localizer:
        return accept(lambda given: create_localizer(cast("LocalizerLike", given), grid, robot), localizer)

    used = make(grid, driven)
    estimates = _follow(used, _START, observations)
    for truth, observation, estimate in zip(truths, observations, estimates, strict=True):
        _check_estimate(estimate, observation)
        _check_near(estimate, truth, tolerances)
    _check_repeats(make, grid, driven, used, observations, estimates)
    _check_observations_alone(make(grid, driven), tolerances)
    _check_times(make(grid, driven), observations)
    _check_without_pose(make(grid, driven), observations)


def _follow(localizer: Localizer, start: Pose2D, observations: Sequence[Observation], seed: int = 3) -> list[Estimate]:
    localizer.reset(start, seed=seed)
    try:
        return [localizer.update(observation) for observation in observations]
    except InputError as error:
        raise ConformanceError(str(error)) from error


def _check_estimate(estimate: Estimate, observation: Observation) -> None:
    time = observation.time
    expect(isinstance(estimate, Estimate), f"update must return an Estimate, not {type(estimate).__name__}")
    expect(
        estimate.time == time, f"an estimate must have the time of its observation, {time:g} s; found: {estimate.time}"
    )
    odom = estimate.odom_pose
    expect(
        odom.distance_to(observation.odometry) <= _NEAR
        and abs(wrap_angle(odom.yaw - observation.odometry.yaw)) <= _NEAR,
        f"pose must be T_map_odom @ odometry; the odometry is {observation.odometry}, and T_map_odom makes it {odom}",
    )
    states = get_args(LocalizationState)
    expect(estimate.state in states, f"state must be one of {', '.join(states)}; found: {estimate.state!r}")
    particles = estimate.particles
    expect(
        particles is None or (particles.ndim == 2 and particles.shape[1] == 4 and bool(np.isfinite(particles).all())),
        "particles must be finite, of the shape (N, 4): x, y, yaw and weight",
    )
    expect(all(0.0 <= one.weight <= 1.0 for one in estimate.hypotheses), "the weight of a hypothesis must be 0 to 1")
    covariance = estimate.covariance
    if covariance is not None:
        matrix = np.asarray(covariance)
        expect(matrix.shape == (3, 3), f"a covariance must have the shape (3, 3); found: {matrix.shape}")
        good = np.isfinite(matrix).all() and np.allclose(matrix, matrix.T)
        expect(bool(good), f"a covariance must be finite and symmetric; found: {matrix.tolist()}")
        least = float(np.linalg.eigvalsh(matrix)[0])
        expect(least >= -1e-9, f"a covariance must have no negative eigenvalue; found: {least}")


def _check_near(estimate: Estimate, truth: Pose2D, tolerances: LocalizerTolerances) -> None:
    off, turned = estimate.pose.distance_to(truth), abs(wrap_angle(estimate.pose.yaw - truth.yaw))
    expect(
        off <= tolerances.position_m and turned <= tolerances.yaw_rad,
        f"with exact odometry an estimate must stay near the truth; after {estimate.time:.2f} s it is {off:.3f} m and "
        f"{math.degrees(turned):.1f}° off",
    )


def _check_repeats(
    make: Callable[[OccupancyGrid, Robot], Localizer],
    grid: OccupancyGrid,
    robot: Robot,
    used: Localizer,
    observations: Sequence[Observation],
    estimates: Sequence[Estimate],
) -> None:
    other = make(grid, robot)
    other.reset(Pose2D(1.0, 1.0, -2.0), seed=9)
    used.reset(_START, seed=3)
    again: list[Estimate] = []
    for observation in observations:
        other.update(observation)
        again.append(used.update(observation))
    _expect_same(
        estimates,
        again,
        "after a reset with the same seed, while another localizer is used, the same observations give other estimates",
    )
    fresh = _follow(make(grid, robot), _START, observations)
    _expect_same(estimates, fresh, "two localizers of the same seed give different estimates")


def _expect_same(estimates: Sequence[Estimate], others: Sequence[Estimate], message: str) -> None:
    for one, other in zip(estimates, others, strict=True):
        same = (one.pose, one.T_map_odom) == (other.pose, other.T_map_odom) and _equal(one, other)
        expect(same, f"{message}; at {one.time:.2f} s: {one.pose} and {other.pose}")


def _equal(one: Estimate, other: Estimate) -> bool:
    if one.covariance is None or other.covariance is None:
        return one.covariance is other.covariance
    return bool(np.array_equal(one.covariance, other.covariance))


def _check_observations_alone(localizer: Localizer, tolerances: LocalizerTolerances) -> None:
    """Odometry of a motion that no simulator makes, without scans: one that needs them may warn."""
    localizer.reset(Pose2D(0.0, 0.0, 0.0), seed=1)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SensorWarning)
        for step in range(41):
            odometry = _ODOM_ORIGIN @ Pose2D(0.025 * step, 0.0, 0.0)
            observation = Observation(_DT * step, Twist2D(0.5, 0.0), odometry)
            _check_estimate(localizer.update(observation), observation)
        last = localizer.update(Observation(_DT * 41, Twist2D(), _ODOM_ORIGIN @ Pose2D(1.0, 0.0)))
    off = last.pose.distance_to(Pose2D(1.0, 0.0))
    expect(
        off <= tolerances.position_m,
        f"without scans an estimate must follow the odometry: after 1 m ahead it is {off:.3f} m from there",
    )


def _check_times(localizer: Localizer, observations: Sequence[Observation]) -> None:
    localizer.reset(_START, seed=3)
    for observation in observations[:3]:
        localizer.update(observation)
    for late in (observations[2], observations[0]):
        try:
            localizer.update(late)
        except InputError:
            continue
        except Exception as error:
            raise ConformanceError(
                f"an observation that is not after the last one must raise an InputError, not {type(error).__name__}: "
                f"{error}"
            ) from error
        expect(False, f"an observation of {late.time:g} s after one of {observations[2].time:g} s is accepted")
    _check_estimate(localizer.update(observations[3]), observations[3])
    localizer.reset(_START, seed=3)
    _check_estimate(localizer.update(observations[0]), observations[0])


def _check_without_pose(localizer: Localizer, observations: Sequence[Observation]) -> None:
    """A start with a covariance, and none: the localizer searches, or says with an InputError that it cannot."""
    localizer.reset(_START, covariance=np.diag([0.01, 0.01, 0.001]), seed=3)
    _check_estimate(localizer.update(observations[0]), observations[0])
    for forget in (localizer.reinitialize_global, lambda: localizer.reset(None, seed=3)):
        try:
            forget()
        except InputError:
            continue
        localizer.update(observations[1])
        localizer.reset(_START, seed=3)
        localizer.update(observations[0])


def _drive(world: World, robot: Robot) -> tuple[list[Pose2D], list[Observation]]:
    """True poses of a robot that drives an arc, and what it observes."""
    speed, turn = min(0.4, robot.limits.linear_speed), min(0.3, robot.limits.angular_speed)
    with KinematicSimulator(world, robot, lidar=True) as sim:
        states = [sim.reset(_START, seed=2)]
        states += [sim.step(Twist2D(speed, turn), _DT) for _ in range(80)]
    truths = [state.pose for state in states]
    observations = [
        Observation(state.time, state.observation.twist, _ODOM_ORIGIN @ state.odometry, state.scans) for state in states
    ]
    return truths, observations


def _room() -> World:
    """Return a room of 8 by 6 m with two boxes, so that every place in it looks different."""
    boxes = (
        ("north", (8.4, 0.2), (0.0, 3.1)),
        ("south", (8.4, 0.2), (0.0, -3.1)),
        ("west", (0.2, 6.0), (-4.1, 0.0)),
        ("east", (0.2, 6.0), (4.1, 0.0)),
        ("cupboard", (1.0, 0.6), (2.5, 2.6)),
        ("pillar", (0.5, 0.5), (-0.5, -2.0)),
    )
    solids = (Solid(name, Box((length, width, 2.0)), Pose3D((x, y, 1.0))) for name, (length, width), (x, y) in boxes)
    return World("room", tuple(solids))
