"""`SceneRenderer`: pictures of a robot in a world, one after another."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Self

import mujoco
import numpy as np
import numpy.typing as npt

from trundle.errors import InputError, SimulationError
from trundle.geometry import FloatArray, Pose2D
from trundle.robots import Robot, WheelSpeeds
from trundle.sim.mujoco.model import build_spec
from trundle.sim.mujoco.world_parts import FLOOR
from trundle.solids import Solid
from trundle.viewer.cameras import Camera, aim
from trundle.viewer.painters import Painter, Pixels, RendererKind, open_painter
from trundle.worlds import World

MAX_SIZE = 4096
"""Largest width and height of a picture, in pixels."""

_GROUP_MARKS = 4
_PATH_COLOR = (0.05, 0.55, 0.95, 1.0)
_GOAL_COLOR = (0.10, 0.72, 0.35, 1.0)
_MAX_MARKS = 500
_AT_REST = WheelSpeeds(0.0, 0.0)


class SceneRenderer:
    """Draws a robot in a world for one pose after another, with OpenGL where there is a driver, else with rays.

    Args:
        world: What stands on the floor.
        robot: Who drives.
        size: Width and height of the pictures, in pixels.
        camera: One of `CAMERAS` or a fixed `Camera`.
        path: Waypoints [m] in the map frame, shape (N, 2) or more columns, drawn on the floor.
        goal: Drawn on the floor as a disc.
        samples: Samples a pixel at edges (OpenGL alone); 0 is quickest, 4 looks best.
        shadow_size: Edge of the shadow map (OpenGL alone), in pixels.

    Raises:
        InputError: If the size is out of range.
        WorldError: If a solid cannot be modelled.
    """

    def __init__(
        self,
        world: World,
        robot: Robot,
        *,
        size: tuple[int, int] = (1280, 720),
        camera: str | Camera = "chase",
        path: npt.ArrayLike | None = None,
        goal: Pose2D | None = None,
        samples: int = 0,
        shadow_size: int = 1024,
    ) -> None:
        width, height = (int(edge) for edge in size)
        if not (1 <= width <= MAX_SIZE and 1 <= height <= MAX_SIZE):
            raise InputError(f"a picture's size must be 1 to {MAX_SIZE} pixels each way, got {width} x {height}")
        self._world, self._robot, self._camera = world, robot, camera
        self._aspect = width / height
        spec = build_spec(world, robot)
        spec.visual.global_.offwidth, spec.visual.global_.offheight = width, height
        spec.visual.quality.offsamples, spec.visual.quality.shadowsize = samples, shadow_size
        if path is not None:
            _add_path(spec, np.asarray(path, dtype=np.float64))
        if goal is not None:
            _add_goal(spec, goal, robot)
        _lay_slab(spec, world)
        self._model = spec.compile()
        self._data = mujoco.MjData(self._model)
        self._walls = _outer_walls(world, self._model)
        self._sight = np.array([1, 1, 0, 0, 0, 0], dtype=np.uint8)
        self._painter: Painter | None = open_painter(self._model, (width, height))
        self._kind: RendererKind = self._painter.kind

    @property
    def kind(self) -> RendererKind:
        """How it draws: `egl`, `osmesa` or `rays`."""
        return self._kind

    def render(self, pose: Pose2D | Sequence[float], *, wheel_positions: WheelSpeeds = _AT_REST) -> Pixels:
        """Draw the robot at a pose.

        Args:
            pose: Of base_link in the map frame.
            wheel_positions: Angles of the drive wheels [rad].

        Returns:
            RGB, shape (height, width, 3).

        Raises:
            SimulationError: If it was closed.
        """
        if self._painter is None:
            raise SimulationError("this SceneRenderer was closed; make a new one")
        pose = Pose2D.of(pose)
        self._place(pose, wheel_positions)
        camera = self._camera
        if isinstance(camera, str):
            camera = aim(camera, self._world, self._robot, pose, self._aspect, self._is_clear)
        self._hide_walls_before(camera)
        return self._painter.paint(self._data, camera)

    def close(self) -> None:
        """Release the driver's context; closing twice does nothing."""
        if self._painter is not None:
            self._painter.close()
            self._painter = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _place(self, pose: Pose2D, wheels: WheelSpeeds) -> None:
        upright = (math.cos(pose.yaw / 2.0), 0.0, 0.0, math.sin(pose.yaw / 2.0))
        self._data.joint("base_link").qpos[:] = (pose.x, pose.y, 0.0, *upright)
        drive = self._robot.drive
        for name, angle in ((drive.left_joint, wheels.left), (drive.right_joint, wheels.right)):
            self._data.joint(name).qpos[0] = angle
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_comPos(self._model, self._data)
        mujoco.mj_camlight(self._model, self._data)

    def _is_clear(self, target: tuple[float, float, float], eye: tuple[float, float, float]) -> bool:
        start, ray = np.array(target), np.subtract(eye, target)
        met = mujoco.mj_ray(self._model, self._data, start, ray, self._sight, True, -1, None)
        return not 0.0 <= met <= 1.0

    def _hide_walls_before(self, camera: Camera) -> None:
        """Let a camera outside of the building look in: an outer wall on its side is not drawn."""
        low, high = self._world.bounds
        for geom, side, alpha in self._walls:
            x, y = camera.eye[:2]
            outside = {"west": x < low[0], "east": x > high[0], "south": y < low[1], "north": y > high[1]}[side]
            self._model.geom_rgba[geom, 3] = 0.0 if outside else alpha


def _lay_slab(spec: mujoco.MjSpec, world: World) -> None:
    """Tell the floor of a building from the ground around it: the ground is darker."""
    low, high = world.bounds
    if not any(solid.kind == "wall" and _side(solid, low, high) for solid in world.solids):
        return
    spec.add_material(name="viewer:ground", rgba=(0.60, 0.64, 0.68, 1.0), specular=0.0)
    floor = spec.geom(FLOOR)
    slab = _add_mark(spec, mujoco.mjtGeom.mjGEOM_PLANE, (1.0, 1.0, 1.0, 1.0))
    slab.material, floor.material = floor.material, "viewer:ground"
    slab.size = (*((high - low)[:2] / 2.0), 0.05)
    slab.pos = (*((high + low)[:2] / 2.0), 0.001)


def _outer_walls(world: World, model: mujoco.MjModel) -> list[tuple[int, str, float]]:
    """Geom, side and opacity of the long walls at the edges of a world."""
    low, high = world.bounds
    walls: list[tuple[int, str, float]] = []
    for solid in world.solids:
        side = _side(solid, low, high) if solid.kind == "wall" else None
        if side is not None:
            walls.append((model.geom(solid.name).id, side, float(solid.color[3])))
    return walls


def _side(solid: Solid, low: FloatArray, high: FloatArray) -> str | None:
    solid_low, solid_high = solid.bounds()
    near = 0.35
    sides = (
        ("west", solid_high[0] - low[0]),
        ("east", high[0] - solid_low[0]),
        ("south", solid_high[1] - low[1]),
        ("north", high[1] - solid_low[1]),
    )
    return next((name for name, reach in sides if reach < near), None)


def _add_path(spec: mujoco.MjSpec, path: FloatArray) -> None:
    """Draw a line on the floor, of at most `_MAX_MARKS` pieces."""
    if path.ndim != 2 or path.shape[1] < 2 or not np.isfinite(path[:, :2]).all():
        raise InputError(f"a path to draw needs finite waypoints of shape (N, 2), got {path.shape}")
    keep = np.unique(np.linspace(0, len(path) - 1, min(len(path), _MAX_MARKS)).round().astype(int))
    points = path[keep, :2]
    for start, end in itertools.pairwise(points):
        if np.hypot(*(end - start)) < 1e-6:
            continue
        geom = _add_mark(spec, mujoco.mjtGeom.mjGEOM_CAPSULE, _PATH_COLOR)
        geom.size = (0.02, 0.0, 0.0)
        geom.fromto = (*start, 0.012, *end, 0.012)


def _add_goal(spec: mujoco.MjSpec, goal: Pose2D, robot: Robot) -> None:
    geom = _add_mark(spec, mujoco.mjtGeom.mjGEOM_CYLINDER, _GOAL_COLOR)
    geom.size = (max(0.08, 0.5 * robot.circumscribed_radius), 0.004, 0.0)
    geom.pos = (goal.x, goal.y, 0.004)


def _add_mark(spec: mujoco.MjSpec, kind: mujoco.mjtGeom, color: tuple[float, float, float, float]) -> mujoco.MjsGeom:
    return spec.worldbody.add_geom(type=kind, rgba=color, contype=0, conaffinity=0, mass=0.0, group=_GROUP_MARKS)
