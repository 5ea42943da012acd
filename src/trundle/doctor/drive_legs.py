"""The legs of a drive check, a straight, a spin and a circle from rest, and the effect of each wheel fitted to them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from trundle.geometry import Pose2D, Twist2D, wrap_angle
from trundle.mission import Session
from trundle.navigation import CommandScript
from trundle.robots import DifferentialDrive, Limits
from trundle.sim import RobotState, Simulator

PERIOD = 0.05
"""Control period [s]."""

_STANDSTILL_S = 0.5
_GENTLE_RAMP_S = 3.0  # A longer ramp slips less, but needs more of the 3 m of free floor.
_SETTLE_S = 1.0
_CRUISE_S = 3.0


@dataclass(frozen=True, slots=True)
class Travel:
    """Rotation of both wheels [rad]; distance of the base along its heading [m], and its rotation [rad]."""

    left: float
    right: float
    forward: float
    turn: float


@dataclass(frozen=True, slots=True)
class Wheel:
    """The robot's motion per radian of a wheel.

    Attributes:
        forward: Forward [m].
        turn: Counter-clockwise [rad].
    """

    forward: float
    turn: float

    @property
    def radius(self) -> float:
        """Effective radius [m]: with the other wheel held, the middle of the axle moves half as far as the wheel."""
        return 2.0 * abs(self.forward)

    @property
    def track(self) -> float:
        """Effective distance to the other wheel [m]; infinity if it does not turn the robot."""
        return self.radius / abs(self.turn) if self.turn else float("inf")

    @property
    def reversed(self) -> bool:
        """Whether a positive speed drives backward."""
        return self.forward < 0.0

    @property
    def on_left(self) -> bool:
        """Whether it is on the left: driving forward, it then turns the robot clockwise."""
        return self.turn * self.forward < 0.0


@dataclass(frozen=True, slots=True)
class Leg:
    """One leg from rest to steady motion.

    Attributes:
        hard: Whether it started at the robot's maximum acceleration.
        start: Travel from rest until one second after the command became constant.
        cruise: Travel in steady motion.
        tracking: Speed of the wheels in steady motion as a share of the commanded speed.
        commanded_turn: Commanded rotation in steady motion [rad].
        touched: Names of the touched solids.
    """

    hard: bool
    start: Travel
    cruise: Travel
    tracking: float
    commanded_turn: float
    touched: frozenset[str] = field(default_factory=frozenset)

    def lost(self, left: Wheel, right: Wheel) -> float:
        """Return the share of the wheels' travel that was lost at the start; 0 if nothing was."""
        forward = left.forward * self.start.left + right.forward * self.start.right
        turned = left.turn * self.start.left + right.turn * self.start.right
        radius, track = (left.radius + right.radius) / 2.0, (left.track + right.track) / 2.0
        expected = abs(forward) + abs(turned) * track / 2.0
        seen = abs(self.start.forward) + abs(self.start.turn) * track / 2.0
        return max(0.0, 1.0 - seen / expected) if expected > 1e-3 * radius else 0.0


def drive_legs(simulator: Simulator, drive: DifferentialDrive, start: Pose2D) -> list[Leg]:
    """Drive straight, spin and circle gently, then straight and spin at the maximum accelerations."""
    limits, half = simulator.robot.limits, drive.track_width / 2.0
    fast, spin = min(0.4, 0.5 * limits.linear_speed), min(0.8, 0.7 * limits.angular_speed)
    # A reversed wheel turns a straight into a spin and a spin into a straight: both must stay below the limits.
    v, w = min(fast, 0.9 * limits.angular_speed * half), min(spin, 0.9 * limits.linear_speed / half)
    plan = [
        (Twist2D(v, 0.0), False),
        (Twist2D(0.0, w), False),
        (Twist2D(0.5 * v, 0.5 * w), False),
        (Twist2D(fast, 0.0), True),
        (Twist2D(0.0, spin), True),
    ]
    return [_drive_leg(simulator, drive, start, target, hard=hard) for target, hard in plan]


def _ramp_time(limits: Limits, target: Twist2D, *, hard: bool) -> float:
    """Return the ramp time of the command [s]: the shortest if hard, else four times as long and at least 3 s."""
    shortest = max(abs(target.v) / limits.linear_acceleration, abs(target.w) / limits.angular_acceleration)
    return shortest if hard else max(_GENTLE_RAMP_S, 4.0 * shortest)


def _drive_leg(simulator: Simulator, drive: DifferentialDrive, pose: Pose2D, target: Twist2D, *, hard: bool) -> Leg:
    ramp = _ramp_time(simulator.robot.limits, target, hard=hard)
    commands: list[tuple[float, float, float]] = []

    def drive_on(seconds: float, *, share: float | None) -> int:
        """Command some seconds at a share of the target, ramped if None; return the index of the last period."""
        steps = math.ceil(seconds / PERIOD - 1e-9)
        for step in range(1, steps + 1):
            part = min(1.0, step * PERIOD / ramp) if share is None else share
            twist = simulator.robot.drive.twist(drive.wheel_speeds(Twist2D(part * target.v, part * target.w)))
            commands.append((twist.v, twist.w, PERIOD))
        return len(commands) - 1

    rest = drive_on(_STANDSTILL_S, share=0.0)
    drive_on(ramp, share=None)
    # The start includes one second at constant command: wheels that spin still lose travel there.
    settled = drive_on(_SETTLE_S, share=1.0)
    end = drive_on(_CRUISE_S, share=1.0)
    states = _drive_commands(simulator, pose, commands)
    touched = {contact.other for state in states for contact in state.contacts}
    cruise = _travel(states[settled : end + 1])
    # With a very wrong configuration the simulator clamps the twist to the robot's limits: that is not a wheel fault.
    robot = simulator.robot
    twist = robot.limits.clamp(robot.drive.twist(drive.wheel_speeds(target)))
    commanded = robot.drive.wheel_speeds(twist)
    seconds = states[end].time - states[settled].time
    expected = (abs(commanded.left) + abs(commanded.right)) * seconds
    return Leg(
        hard,
        _travel(states[rest : settled + 1]),
        cruise,
        (abs(cruise.left) + abs(cruise.right)) / expected,
        twist.w * seconds,
        frozenset(touched),
    )


def _drive_commands(simulator: Simulator, pose: Pose2D, commands: list[tuple[float, float, float]]) -> list[RobotState]:
    """Drive the commands, and return the state at the end of each one's period."""
    script = CommandScript(commands, period_s=PERIOD)
    session = Session(simulator, script, pose, monitor=False, stop_on_contact=False, measure=None)
    states: list[RobotState] = []
    while (step := session.step()) is not None:
        states.append(step.state)
    if session.error is not None:
        raise session.error
    return states


def _travel(states: list[RobotState]) -> Travel:
    """Return how far the wheels turned and the base went, the latter along its own heading."""
    poses = np.array([state.pose.as_tuple() for state in states])
    turns = np.array([wrap_angle(turn) for turn in np.diff(poses[:, 2])])
    headings = poses[:-1, 2] + turns / 2.0
    steps = np.diff(poses[:, :2], axis=0)
    first, last = states[0].wheel_positions, states[-1].wheel_positions
    return Travel(
        left=last.left - first.left,
        right=last.right - first.right,
        forward=float((steps[:, 0] * np.cos(headings) + steps[:, 1] * np.sin(headings)).sum()),
        turn=float(turns.sum()),
    )


def fit_wheels(legs: Sequence[Leg]) -> tuple[Wheel, Wheel]:
    """Fit the effect of the left and right wheel by least squares over the steady parts of the legs.

    The ratio of the wheels' speeds must differ between legs, as it does between a straight and a spin.
    """
    turned = np.array([[leg.cruise.left, leg.cruise.right] for leg in legs])
    moved = np.array([[leg.cruise.forward, leg.cruise.turn] for leg in legs])
    by_wheel, *_ = np.linalg.lstsq(turned, moved, rcond=None)
    (left_forward, left_turn), (right_forward, right_turn) = by_wheel.tolist()
    return Wheel(left_forward, left_turn), Wheel(right_forward, right_turn)
