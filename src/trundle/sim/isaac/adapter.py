"""The interface of an adapter to one generation of Isaac Sim's API: the minimum that a simulator needs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from trundle.geometry import FloatArray, Pose2D, Twist2D, rotation_matrices
from trundle.robots import Robot


@dataclass(frozen=True, slots=True)
class BodyState:
    """Motion of the robot's articulation root, in the world frame.

    Attributes:
        position: [m], shape (3,).
        quaternion: wxyz, shape (4,).
        linear: Velocity of its centre of mass [m/s], shape (3,): PhysX gives that, and not the one of its origin.
        angular: Velocity [rad/s], shape (3,).
        center: Centre of mass in the root's own frame [m], shape (3,).
    """

    position: FloatArray
    quaternion: FloatArray
    linear: FloatArray
    angular: FloatArray
    center: FloatArray


def placement(pose: Pose2D, height: float) -> tuple[FloatArray, FloatArray]:
    """Return the position [m], shape (3,), and quaternion (wxyz), shape (4,), of a pose at a height [m]."""
    half = pose.yaw / 2.0
    return np.array([pose.x, pose.y, height]), np.array([math.cos(half), 0.0, 0.0, math.sin(half)])


def planar_pose(body: BodyState) -> Pose2D:
    """Return the body's pose on the floor."""
    w, x, y, z = (float(number) for number in body.quaternion)
    yaw = math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    return Pose2D(float(body.position[0]), float(body.position[1]), yaw)


def base_motion(body: BodyState, root: Pose2D) -> tuple[Pose2D, Twist2D]:
    """Return the pose and twist of base_link, for an articulation whose root is at `root` in base_link."""
    at_root = planar_pose(body)
    pose = at_root @ root.inverse()
    w = float(body.angular[2])
    center = rotation_matrices(body.quaternion)[0] @ body.center
    at_origin = body.linear - np.cross(body.angular, center)
    vx = float(at_origin[0]) - w * (pose.y - at_root.y)
    vy = float(at_origin[1]) + w * (pose.x - at_root.x)
    return pose, Twist2D(vx * math.cos(pose.yaw) + vy * math.sin(pose.yaw), w)


class Adapter(Protocol):
    """One robot in one stage. Call order: open_stage, load_robot, place, then steps."""

    def open_stage(self, path: str) -> bool:
        """Open a USD file instead of the current stage; False on failure."""
        ...

    def is_loading(self) -> bool:
        """Return whether the stage is still being loaded."""
        ...

    def stage_units(self) -> tuple[float, str]:
        """Return metres per unit, and the up axis."""
        ...

    def add_robot(self, usd: str, path: str) -> None:
        """Add a reference to a robot's USD file at a prim path."""
        ...

    def load_robot(self, robot: Robot, path: str, timestep: float) -> None:
        """Load the articulation at a prim path, and prepare physics with steps of `timestep` [s]."""
        ...

    def place(self, position: FloatArray, quaternion: FloatArray) -> None:
        """Stop, write a pose (wxyz) on the robot's prim, and play: everything restarts from there."""
        ...

    def joint_names(self) -> list[str]:
        """Return the names of the articulation's degrees of freedom, in its order."""
        ...

    def drive(self, v: float, w: float) -> None:
        """Command a twist [m/s, rad/s] through Isaac Sim's DifferentialController."""
        ...

    def step(self) -> None:
        """Do one physics step without rendering."""
        ...

    def draw(self) -> None:
        """Render, and process window events, without a physics step."""
        ...

    def is_playing(self) -> bool:
        """Return whether the timeline runs; somebody may have paused or stopped it in the window."""
        ...

    def is_stopped(self) -> bool:
        """Return whether the timeline was stopped."""
        ...

    def halt(self) -> None:
        """Set the robot's velocities to 0 at its current pose."""
        ...

    def body(self) -> BodyState:
        """Return the motion of the articulation's root."""
        ...

    def wheel_positions(self) -> tuple[float, float]:
        """Return the angles [rad] of the left and the right wheel."""
        ...

    def wheel_speeds(self) -> tuple[float, float]:
        """Return the speeds [rad/s] of the left and the right wheel."""
        ...

    def look(self, eye: FloatArray, target: FloatArray, camera: str) -> None:
        """Put a camera at `eye` [m], looking at `target` [m]."""
        ...

    def close(self) -> None:
        """Stop, and release the world; the application keeps running."""
        ...
