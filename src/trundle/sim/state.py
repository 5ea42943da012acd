"""What a simulator reports: the state of the robot, its contacts, what moves around it, and every physics step."""

from __future__ import annotations

from dataclasses import dataclass

from trundle.geometry import Pose2D, Twist2D
from trundle.observation import Observation, Scan
from trundle.robots import WheelSpeeds


@dataclass(frozen=True, slots=True)
class Contact:
    """A contact between the robot and something other than the floor.

    Attributes:
        part: Part of the robot ("chassis", "wheel_left", …).
        other: Name of the touched solid; for a map with the cell: `map[row,col]`.
        x, y: Position in the map frame [m].
    """

    part: str
    other: str
    x: float
    y: float


@dataclass(frozen=True, slots=True)
class MoverState:
    """Where a moving obstacle is.

    Attributes:
        name: Name of the mover.
        pose: Pose of its frame, map frame.
        vx, vy: Velocity, map frame [m/s].
        w: Speed of rotation [rad/s], positive to the left.
        outline: Its convex outline on the floor [m], in its frame, counter-clockwise.
    """

    name: str
    pose: Pose2D
    vx: float = 0.0
    vy: float = 0.0
    w: float = 0.0
    outline: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True, slots=True)
class Substep:
    """Where the simulated robot is after one physics step, within a control period.

    Attributes:
        time: Simulated time since the reset [s].
        pose: True pose of base_link in the map frame.
        twist: True twist in base_link.
        wheel_positions: Angles of the drive wheels since the reset [rad]; None where they are not reported.
        wheel_speeds: Speeds of the drive wheels [rad/s]; likewise.
    """

    time: float
    pose: Pose2D
    twist: Twist2D
    wheel_positions: WheelSpeeds | None = None
    wheel_speeds: WheelSpeeds | None = None


@dataclass(frozen=True, slots=True)
class RobotState:
    """State of the simulated robot at one moment.

    Attributes:
        time: Simulated time since the reset [s].
        pose: True pose of base_link in the map frame.
        twist: True twist in base_link.
        wheel_positions: Angles of the drive wheels since the reset [rad].
        wheel_speeds: Speeds of the drive wheels [rad/s].
        odometry: Pose from wheel odometry, in the odom frame (REP-105), which starts at the reset's pose.
        contacts: Contacts during the last control period, except with the floor.
        scans: Lidar scans taken during the last control period, at most one per lidar.
        odometry_twist: Twist from the speeds of the wheels, base_link; None where wheels never slip: then it is the
            true one.
        movers: The world's moving obstacles now.
        tilt: Angle between the robot's vertical axis and the world's [rad]; 0 in a simulator without one.
    """

    time: float
    pose: Pose2D
    twist: Twist2D
    wheel_positions: WheelSpeeds
    wheel_speeds: WheelSpeeds
    odometry: Pose2D
    contacts: tuple[Contact, ...] = ()
    scans: tuple[Scan, ...] = ()
    odometry_twist: Twist2D | None = None
    movers: tuple[MoverState, ...] = ()
    tilt: float = 0.0

    @property
    def observation(self) -> Observation:
        """All of it that the robot could know."""
        twist = self.twist if self.odometry_twist is None else self.odometry_twist
        return Observation(self.time, twist, self.odometry, self.scans)
