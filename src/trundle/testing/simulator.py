"""The check that every simulator must pass."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from trundle.errors import InputError, SimulationError
from trundle.geometry import Pose2D, Pose3D, Twist2D, wrap_angle
from trundle.geometry.solids import Box, Cylinder, Solid
from trundle.observation import Scan
from trundle.robots import Robot
from trundle.sim import RobotState, Simulator, Substep
from trundle.sim.kinematic import KinematicSimulator
from trundle.sim.simulator import SomeSimulator, as_simulator
from trundle.testing.conformance import expect
from trundle.worlds import World
from trundle.worlds.movers import AlongPath, Mover

_PERIOD = 0.05
_EMPTY = World("empty", ())


@dataclass(frozen=True, slots=True)
class Tolerances:
    """Allowed deviations of a simulator from the kinematic one.

    The defaults are met by MuJoCo. An engine whose wheels have wider contacts, such as PhysX, needs more; see
    docs/simulation.md, "PhysX and the width of contacts".

    Attributes:
        position_m: After five seconds of driving [m].
        yaw_rad: After five seconds of driving [rad].
        speed: Allowed excess over the speed limits, as a share of them.
        rest_m: Error of the pose after a reset, in position [m].
        wheel_speed: Error of a wheel's speed after five seconds of driving, as a share of the faster wheel's.
    """

    position_m: float = 0.010
    yaw_rad: float = math.radians(1.0)
    speed: float = 0.02
    rest_m: float = 0.002
    wheel_speed: float = 0.05


def check_simulator(
    make: Callable[[World, Robot], SomeSimulator],
    *,
    robot: str | Robot = "nova_carter",
    tolerances: Tolerances = Tolerances(),
    with_lidars: Callable[[World, Robot], SomeSimulator] | None = None,
) -> None:
    """Check that a simulator meets the contract of `trundle.sim.Simulator` and agrees with the kinematic one.

    Of its optional members those are checked that it has: what `world` and `timestep` say, that watched physics steps
    lead to the end of the control period, that an added solid is touched until the next reset, and that placing the
    robot changes its pose alone.

    Args:
        make: Creates a simulator of a robot in a world, without lidars.
        robot: The robot to drive.
        tolerances: Allowed deviations from the kinematic simulator.
        with_lidars: Creates one with all of the robot's lidars; None for a simulator that has none.

    Raises:
        ConformanceError: If it does not; the message says what was required and what was found.
    """
    machine = Robot.load(robot)

    def made(world: World, robot: Robot) -> Simulator:
        return _accept(make(world, robot))

    def made_with_lidars(world: World, robot: Robot) -> Simulator:
        return _accept((with_lidars or make)(world, robot))

    with made(_EMPTY, machine) as simulator:
        expect(simulator.robot == machine, f"its robot is {simulator.robot.name}, not {machine.name}")
        _check_reset(simulator, tolerances)
        _check_repeats(simulator)
        _check_limits(simulator, tolerances)
        _check_motion(simulator, tolerances)
        _check_period(simulator)
    _check_contacts(made, machine)
    _check_movers(made_with_lidars, machine)
    with made(_EMPTY, machine) as simulator:
        _check_optional_members(simulator)
    _check_close(made, machine)


def _accept(simulator: SomeSimulator) -> Simulator:
    """Adapt a simulator to the whole protocol; it must have the required members.

    Raises:
        ConformanceError: If it has not.
    """
    expect(isinstance(simulator, SomeSimulator), f"{type(simulator).__name__} lacks a method of trundle.sim.Simulator")
    return as_simulator(simulator)


def _check_reset(simulator: Simulator, tolerances: Tolerances) -> None:
    simulator.step(Twist2D(0.3, 0.3), _PERIOD)
    for pose in (Pose2D(0.0, 0.0), Pose2D(3.5, -2.25, 2.5)):
        state = simulator.reset(pose)
        distance = state.pose.distance_to(pose)
        turn = abs(wrap_angle(state.pose.yaw - pose.yaw))
        expect(state.time == 0.0, f"the time after a reset is {state.time} s, not 0")
        expect(distance <= tolerances.rest_m, f"a reset to {pose} puts the robot {distance:.4f} m away")
        expect(turn <= math.radians(0.1), f"a reset to {pose} turns the robot by {turn:.5f} rad")
        expect(state.twist == Twist2D(0.0, 0.0), f"the robot is not at rest after a reset: {state.twist}")
        expect(
            state.odometry.distance_to(pose) < 1e-9, f"odometry does not start at the reset's pose: {state.odometry}"
        )
        expect(tuple(state.wheel_positions) == (0.0, 0.0), f"wheels do not start at 0: {state.wheel_positions}")
        expect(not state.contacts, f"contacts in an empty world: {state.contacts}")
        for _ in range(20):
            state = simulator.step(Twist2D(0.0, 0.0), _PERIOD)
        distance = state.pose.distance_to(pose)
        expect(distance <= tolerances.rest_m, f"a robot commanded to stand still moves {distance:.4f} m in a second")


def _check_repeats(simulator: Simulator) -> None:
    runs = [_drive(simulator, Twist2D(0.3, 0.4), 1.0, seed=5) for _ in range(2)]
    expect(runs[0] == runs[1], "the same seed and commands give a different run the second time")


def _check_limits(simulator: Simulator, tolerances: Tolerances) -> None:
    limits = simulator.robot.limits
    room = 1.0 + tolerances.speed
    states = _drive(simulator, Twist2D(100.0 * limits.linear_speed, 0.0), 2.0)
    fastest = max(state.twist.v for state in states)
    expect(
        fastest <= limits.linear_speed * room, f"the robot reaches {fastest} m/s; its limit is {limits.linear_speed}"
    )
    first = states[0].twist.v
    allowed = limits.linear_acceleration * _PERIOD * room
    expect(first <= allowed + 0.005, f"{first} m/s after {_PERIOD} s; its acceleration allows {allowed}")
    states = _drive(simulator, Twist2D(0.0, 100.0 * limits.angular_speed), 2.0)
    fastest = max(state.twist.w for state in states)
    most = limits.angular_speed
    expect(fastest <= most * room, f"the robot turns at {fastest} rad/s; its limit is {most}")


def _check_motion(simulator: Simulator, tolerances: Tolerances) -> None:
    limits = simulator.robot.limits
    v, w = min(0.4, limits.linear_speed), min(0.8, limits.angular_speed)
    with KinematicSimulator(_EMPTY, simulator.robot) as reference:
        for command in (Twist2D(v, 0.0), Twist2D(0.0, w), Twist2D(0.6 * v, -0.6 * w)):
            expected, got = (_drive(each, command, 5.0)[-1] for each in (reference, simulator))
            distance = got.pose.distance_to(expected.pose)
            turn = abs(wrap_angle(got.pose.yaw - expected.pose.yaw))
            expect(abs(got.time - 5.0) < 1e-6, f"five seconds of steps end at {got.time} s")
            expect(
                distance <= tolerances.position_m, f"{command} for 5 s ends {distance:.4f} m from the expected point"
            )
            expect(turn <= tolerances.yaw_rad, f"{command} for 5 s ends with a yaw error of {math.degrees(turn):.2f}°")
            wheels, right = got.wheel_speeds, expected.wheel_speeds
            off = max(abs(wheels.left - right.left), abs(wheels.right - right.right))
            allowed = tolerances.wheel_speed * max(map(abs, right))
            expect(off <= allowed, f"{command}: the wheels turn at {wheels}, not {right}")


def _check_period(simulator: Simulator) -> None:
    for dt in (0.0, -0.05, math.nan):
        try:
            simulator.step(Twist2D(), dt)
        except InputError:
            continue
        expect(False, f"a control period of {dt} s is accepted; it must raise an InputError")


def _check_contacts(make: Callable[[World, Robot], Simulator], robot: Robot) -> None:
    front = float(robot.outline[:, 0].max())
    solid = Solid("the_box", Box((0.5, 2.0, 1.0)), Pose3D((front + 0.75, 0.0, 0.5)))
    with make(World("box", (solid,)), robot) as simulator:
        expect(not simulator.reset(Pose2D(0.0, 0.0)).contacts, "a contact is reported with a box half a metre away")
        state, steps = simulator.step(Twist2D(0.3, 0.0), _PERIOD), 1
        while not state.contacts and steps < 200:
            state, steps = simulator.step(Twist2D(0.3, 0.0), _PERIOD), steps + 1
        names = {contact.other for contact in state.contacts}
        expect(names == {"the_box"}, f"driving into the box gives contacts with {sorted(names) or 'nothing'}")
        expect(abs(state.pose.x - 0.5) < 0.04, f"the contact occurs at x = {state.pose.x:.3f} m, not at 0.5 m")
        inside = simulator.reset(Pose2D(front + 0.75, 0.0))
        names = {contact.other for contact in inside.contacts}
        expect("the_box" in names, "a reset inside a solid does not report the contact")


def _check_movers(make: Callable[[World, Robot], Simulator], robot: Robot) -> None:
    """A post that moves into the robot; a simulator without movers must refuse the world."""
    front = float(robot.outline[:, 0].max())
    post = (Solid("post", Cylinder(0.2, 2.0), Pose3D((0.0, 0.0, 1.0))),)
    motion = AlongPath(((front + 1.2, 0.0), (front + 0.15, 0.0)), 0.5)
    world = World("mover", (), movers=(Mover("the_post", post, motion),))
    try:
        simulator = make(world, robot)
    except InputError as error:
        expect("movers" in str(error), f"a world with movers is refused for another reason: {error}")
        return
    with simulator:
        state = simulator.reset(Pose2D(0.0, 0.0))
        while state.time < 1.5:
            state = simulator.step(Twist2D(), _PERIOD)
            at = motion.at(state.time)
            expect([mover.name for mover in state.movers] == ["the_post"], f"the movers are {state.movers}")
            off = math.hypot(state.movers[0].pose.x - at.x, state.movers[0].pose.y - at.y)
            expect(off < 1e-6, f"the mover is {off:.4f} m from where its motion is at {state.time:g} s")
            expect(not state.contacts, f"a contact is reported with a mover that is {at.x - front - 0.2:.2f} m away")
            for scan in state.scans:
                _check_scan(scan, robot, at.x)
        while state.time < 2.3 and not state.contacts:
            state = simulator.step(Twist2D(), _PERIOD)
        names = {contact.other for contact in state.contacts}
        expect(
            names == {"the_post"}, f"a mover that runs into the robot gives contacts with {sorted(names) or 'nothing'}"
        )


def _check_scan(scan: Scan, robot: Robot, ahead: float) -> None:
    """A scan must show a post of 0.2 m at this distance [m] ahead of base_link."""
    lidar = robot.lidars[scan.lidar]
    directions = scan.angles + scan.mount.yaw
    sensor_to_post = math.hypot(ahead - scan.mount.x, scan.mount.y)
    towards = math.atan2(-scan.mount.y, ahead - scan.mount.x)
    off = np.abs(np.remainder(directions - towards + math.pi, math.tau) - math.pi)
    nearest = int(np.argmin(off))
    if off[nearest] > math.radians(2.0):
        return  # it does not look there
    expected, found = max(sensor_to_post - 0.2, scan.range_min), float(scan.ranges[nearest])
    allowed = 0.02 + 6.0 * lidar.noise
    expect(
        abs(found - expected) <= allowed,
        f"lidar {scan.lidar} measures {found:.3f} m to a mover that is {expected:.3f} m away",
    )


def _check_optional_members(simulator: Simulator) -> None:
    """Check what a simulator in an empty world says of itself, and what can be done to it in the middle of a run."""
    world, timestep = simulator.world, simulator.timestep
    expect(
        world is None or (isinstance(world, World) and world.name == _EMPTY.name),
        f"world must be the world that it was made for, or None; found: {world!r}",
    )
    expect(
        timestep is None or (math.isfinite(timestep) and timestep > 0.0),
        f"timestep must be a positive number of seconds, or None; found: {timestep!r}",
    )
    _check_substeps(simulator)
    _check_adding(simulator)
    _check_placing(simulator)


def _check_substeps(simulator: Simulator) -> None:
    seen: list[Substep] = []
    simulator.reset(Pose2D(0.0, 0.0))
    if not simulator.watch_substeps(seen.append):
        return
    state = simulator.step(Twist2D(0.3, 0.3), _PERIOD)
    times = [substep.time for substep in seen]
    expect(times == sorted(times) and len(times) > 0, f"watched physics steps must follow each other; found: {times} s")
    last = seen[-1]
    expect(
        abs(last.time - state.time) < 1e-6 and last.pose.distance_to(state.pose) < 1e-6,
        f"the last physics step must be where the control period ends, {state.pose} at {state.time:g} s; found: "
        f"{last.pose} at {last.time:g} s",
    )
    simulator.watch_substeps(None)
    simulator.step(Twist2D(0.3, 0.3), _PERIOD)
    expect(len(seen) == len(times), "physics steps are still reported after watch_substeps(None)")


def _check_adding(simulator: Simulator) -> None:
    """Add a box around the robot: it is touched in the next control period, and not after a reset."""
    simulator.reset(Pose2D(0.0, 0.0))
    front = float(simulator.robot.outline[:, 0].max())
    box = Solid("the_added_box", Box((0.2, 2.0, 1.0)), Pose3D((front + 0.05, 0.0, 0.5)))
    try:
        simulator.add_solid(box)
    except InputError:
        return  # it cannot, and says so
    names = {contact.other for contact in simulator.step(Twist2D(0.1, 0.0), _PERIOD).contacts}
    expect("the_added_box" in names, "a solid that was added in the robot's place is not touched")
    found = simulator.reset(Pose2D(0.0, 0.0)).contacts
    expect(not found, f"a solid that was added is still there after a reset: {found}")


def _check_placing(simulator: Simulator) -> None:
    simulator.reset(Pose2D(0.0, 0.0))
    before = simulator.step(Twist2D(0.3, 0.0), _PERIOD)
    there = Pose2D(3.5, -2.25, 2.5)
    try:
        state = simulator.place(there)
    except InputError:
        return  # it cannot, and says so
    off = state.pose.distance_to(there)
    expect(off < 1e-6, f"the robot that was placed at {there} is {off:.4f} m away")
    expect(state.twist == Twist2D(0.0, 0.0), f"the robot is not at rest where it was placed: {state.twist}")
    expect(state.time == before.time, f"placing the robot changes the time from {before.time:g} to {state.time:g} s")
    moved = state.odometry.distance_to(before.odometry)
    expect(moved < 1e-6, f"placing the robot moves the odometry by {moved:.4f} m")


def _check_close(make: Callable[[World, Robot], Simulator], robot: Robot) -> None:
    simulator = make(_EMPTY, robot)
    simulator.close()
    simulator.close()
    try:
        simulator.step(Twist2D(), _PERIOD)
    except SimulationError:
        return
    expect(False, "a step after close is accepted; it must raise a SimulationError")


def _drive(simulator: Simulator, command: Twist2D, duration: float, *, seed: int = 0) -> list[RobotState]:
    simulator.reset(Pose2D(0.0, 0.0), seed=seed)
    return [simulator.step(command, _PERIOD) for _ in range(round(duration / _PERIOD))]
