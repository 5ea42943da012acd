"""The robot in PhysX: the pose of its base_link, how its wheels turned, and what it touches, by name."""

from __future__ import annotations

import math

import numpy as np

from trundle.errors import InputError, SimulationError
from trundle.geometry import FloatArray, Pose2D, Pose3D, Twist2D, integrate_twist, wrap_angle
from trundle.robots import Robot, WheelSpeeds
from trundle.sim.footprint import CellNames
from trundle.sim.physx.attachment import Attachment
from trundle.sim.physx.scene import ROBOT, Scene
from trundle.sim.state import Contact
from trundle.worlds import World

FLOOR_BAND = 0.02
"""In somebody else's stage contacts up to this far above the lowest one [m] are with the floor."""

_CHASSIS = "chassis"


class ContactReader:
    """Reads contacts of the robot with everything but the floor.

    Solids have the names of the world that trundle wrote, or their prims' paths in any other stage.

    Args:
        scene: The stage.
        world: Used for the names of cells.
    """

    def __init__(self, scene: Scene, world: World) -> None:
        self._scene = scene
        self._floor: float | None = None
        self._added: dict[str, str] = {}
        self._labels: dict[str, str] = {}
        self._chassis = scene.root.rpartition("/")[2]
        self.change_world(world, {})

    def change_world(self, world: World, added: dict[str, str]) -> None:
        """Name the cells of another world from now on, and the solids that were added to the stage, by path."""
        self._cells = CellNames(world)
        self._added = added
        self._labels.clear()

    def attached(self) -> None:
        """Forget handles, which another attachment may give to other prims, and the floor: it is below the start."""
        self._harmless: set[int] = set()
        self._floor = None if self._scene.knows_floor else self._scene.height

    def find_floor(self, attachment: Attachment) -> None:
        """Take the lowest contact of the robot at rest as the height of the floor, if the stage does not tell it."""
        if not self._scene.knows_floor:
            heights = [float(points[:, 2].min()) for _, _, points in attachment.contacts()]
            self._floor = min(heights, default=0.0)

    def read(self, attachment: Attachment, touched: dict[tuple[str, str], Contact]) -> None:
        """Add the robot's current contacts to `touched`, by part and solid; the first position of each pair is kept."""
        colliders = attachment.touched_colliders()
        if colliders <= self._harmless:
            return
        lowest = -float("inf") if self._floor is None else self._floor + FLOOR_BAND
        for body, collider, points in attachment.contacts():
            if collider in self._harmless:
                continue
            path = attachment.path(collider)
            if self._is_harmless(path, lowest):
                self._harmless.add(collider)
                continue
            above = points[points[:, 2] > lowest]
            part = self._part(body)
            for x, y in above[:, :2].tolist():
                # All cells of a map are one collider.
                name = self._cells.name(self._name(path), x, y)
                touched.setdefault((part, name), Contact(part, name, x, y))

    def _is_harmless(self, path: str, lowest: float) -> bool:
        """Return whether a collider is the robot's own, or lies below the height at which contacts count."""
        if path == ROBOT or path.startswith(f"{ROBOT}/"):
            return True
        return self._floor is not None and self._scene.top(path) <= lowest

    def _part(self, body: str) -> str:
        name = body.rpartition("/")[2]
        return _CHASSIS if name == self._chassis and self._scene.knows_floor else name

    def _name(self, path: str) -> str:
        if path not in self._labels:
            self._labels[path] = self._added.get(path) or self._scene.name(path)
        return self._labels[path]


class RobotBody:
    """Reads and writes the pose of base_link.

    Args:
        attachment: The robot as it is in its stage: its prim, which is base_link, stands upright at (0, 0).
        robot: The robot.
        height: Height at which the prim stands in the stage [m].
        centre: The root body's centre of mass [m], in its frame: PhysX gives the velocity of that.
        timestep: Length of a physics step [s], for messages.

    Attributes:
        rest: How high and how tilted base_link stands on the floor; at first as in the stage.

    Raises:
        SimulationError: If the root is far from base_link.
    """

    def __init__(
        self, attachment: Attachment, robot: Robot, *, height: float, centre: FloatArray, timestep: float
    ) -> None:
        self._centre, self._timestep = centre, timestep
        self.rest = Pose3D((0.0, 0.0, height))
        at_root = self._root(attachment)[0]
        self._T_root_base = at_root.inverse() @ self.rest
        self._T_base_root = self._T_root_base.inverse()
        x, y, _ = self._T_base_root.position
        if math.hypot(x, y) > robot.circumscribed_radius:
            raise SimulationError(
                f"the root of the robot's articulation is {math.hypot(x, y):.2f} m away from its prim: is it a body of "
                "the robot, and is the robot's prim at base_link?"
            )

    def _root(self, attachment: Attachment) -> tuple[Pose3D, FloatArray, FloatArray]:
        try:
            return attachment.root()
        except InputError as error:
            raise SimulationError(
                f"the physics diverged: {error}; use a smaller physics_dt than {self._timestep} s, and check the "
                "robot's masses and colliders"
            ) from error

    def pose(self, attachment: Attachment) -> Pose3D:
        """Return the pose of base_link, map frame.

        Raises:
            SimulationError: If the physics diverged.
        """
        return self._root(attachment)[0] @ self._T_root_base

    def motion(self, attachment: Attachment) -> tuple[Pose2D, Twist2D, float]:
        """Return the pose and twist of base_link on the floor, and its tilt [rad].

        Raises:
            SimulationError: If the physics diverged.
        """
        T_world_root, linear, angular = self._root(attachment)
        T_world_base = T_world_root @ self._T_root_base
        arm = np.array(T_world_base.position) - T_world_root.transform_points([self._centre])[0]
        vx, vy, _ = (linear + np.cross(angular, arm)).tolist()
        x, y, _ = T_world_base.position
        yaw = T_world_base.yaw()
        twist = Twist2D(vx * math.cos(yaw) + vy * math.sin(yaw), float(angular[2]))
        return Pose2D(x, y, yaw), twist, tilt_of(T_world_base)

    def put(self, attachment: Attachment, T_world_base: Pose3D) -> None:
        """Put base_link at a pose, at rest; the joints stay where they are."""
        attachment.place_root(T_world_base @ self._T_base_root)
        attachment.stop_joints()

    def stand(self, attachment: Attachment, pose: Pose2D) -> None:
        """Put it on the floor at a pose, at rest."""
        self.put(attachment, Pose3D.planar(pose.x, pose.y, 0.0, pose.yaw) @ self.rest)

    def keep_rest(self, attachment: Attachment) -> Pose3D:
        """Keep how high and how tilted it stands now as `rest`; return its pose."""
        T_world_base = self.pose(attachment)
        x, y, _ = T_world_base.position
        self.rest = Pose3D.planar(x, y, 0.0, T_world_base.yaw()).inverse() @ T_world_base
        return T_world_base


def tilt_of(pose: Pose3D) -> float:
    """Return the angle of a pose's z axis from the vertical [rad]."""
    _, qx, qy, _ = pose.quaternion
    return math.acos(max(-1.0, 1.0 - 2.0 * (qx * qx + qy * qy)))


_LARGEST_TURN = 1.5
"""Largest rotation of a wheel [rad] between two readings: angles are wrapped at a full turn."""

_MOST_STEPS = 10
"""Physics steps between two readings, whose odometry is an arc in between: in 50 ms that is 0.01 mm off."""


class WheelOdometry:
    """Follows the angles of the two wheels.

    Args:
        robot: The robot.
        timestep: Length of a physics step [s].

    Attributes:
        steps_between: Physics steps after which the angles must be read again, at most.
        turned: Rotation of the wheels since the reset [rad].
    """

    def __init__(self, robot: Robot, timestep: float) -> None:
        self._drive = robot.drive
        limits = robot.limits
        fastest = limits.linear_speed / robot.drive.wheel_radius
        fastest += limits.angular_speed * robot.drive.track_width / (2.0 * robot.drive.wheel_radius)
        self.steps_between = max(1, min(_MOST_STEPS, math.floor(_LARGEST_TURN / (fastest * timestep))))
        self.turned = WheelSpeeds(0.0, 0.0)
        self._place = (0.0, 0.0, 0.0)
        self._angles = (0.0, 0.0)

    @property
    def pose(self) -> Pose2D:
        """Pose in the odom frame, which starts at the reset's pose."""
        x, y, yaw = self._place
        return Pose2D(x, y, wrap_angle(yaw))

    def reset(self, pose: Pose2D) -> None:
        """Begin at a pose."""
        self.turned = WheelSpeeds(0.0, 0.0)
        self._place = pose.as_tuple()

    def skip_to(self, angles: tuple[float, float]) -> None:
        """Go on from other angles [rad], without a motion."""
        self._angles = angles

    def follow(self, angles: tuple[float, float]) -> None:
        """Add the rotation since the last reading; angles that are wrapped at a full turn are unwrapped."""
        left, right = (math.remainder(new - old, math.tau) for new, old in zip(angles, self._angles, strict=True))
        self._angles = angles
        self.turned = WheelSpeeds(self.turned.left + left, self.turned.right + right)
        radius, track = self._drive.wheel_radius, self._drive.track_width
        x, y, yaw = integrate_twist(*self._place, radius * (left + right) / 2.0, radius * (right - left) / track, 1.0)
        self._place = (float(x), float(y), float(yaw))
