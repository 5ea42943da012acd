"""`SceneModel`: a MuJoCo model of a robot in a world with its movers and their trails, for rendering."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import mujoco
import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray, Pose2D
from trundle.geometry.solids import OccupancyCells, Solid
from trundle.robots import Robot, WheelSpeeds
from trundle.sim.mover_history import ShownMovers
from trundle.sim.movers import MoverField
from trundle.sim.mujoco.model import build_spec
from trundle.sim.mujoco.mover_bodies import place_movers
from trundle.sim.mujoco.world_parts import FLOOR, MOVER
from trundle.viewer.cameras import Camera, aim
from trundle.viewer.map_look import GROUP_MARKS, add_edges
from trundle.viewer.route import (
    GOAL_COLOR,
    GOAL_HALF_HEIGHT_M,
    PATH_COLOR,
    PATH_HEIGHT_M,
    PATH_RADIUS_M,
    goal_radius,
    path_pieces,
)
from trundle.worlds import World
from trundle.worlds.map_look import DrawnSolid, drawn_solids, shown_bounds
from trundle.worlds.movers.crowd import each_body

SHOWN_GROUPS = (1, 1, 1, 0, 1, 0)
"""Geom groups in pictures: everything but the robot's colliders."""

AT_REST = WheelSpeeds(0.0, 0.0)

_EDGES = ("west", "east", "south", "north")
_CLEAR = 1.1  # the line of sight must be clear up to this multiple of the camera's distance
_AT_EDGE = 0.35  # walls within this distance of the world's edge are outer walls [m]

TRAIL_COLOR = (0.85, 0.42, 0.05, 1.0)
_DOTS = 12
_DOT_RADIUS_M, _DOT_HALF_HEIGHT_M = 0.05, 0.004
_BELOW_M = -50.0  # where dots are kept that are not shown [m]


class SceneModel:
    """A robot in a world, to be posed and drawn.

    Args:
        world: The world.
        robot: The robot.
        size: Width and height of the pictures, in pixels.
        path: Waypoints [m] in the map frame, shape (N, 2) or more columns, drawn on the floor.
        goal: Drawn on the floor as a disc.
        samples: Samples per pixel at edges.
        shadow_size: Edge of the shadow map, in pixels.

    Raises:
        InputError: If the path is invalid.
        WorldError: If a solid cannot be modelled.
    """

    def __init__(
        self,
        world: World,
        robot: Robot,
        *,
        size: tuple[int, int],
        path: npt.ArrayLike | None = None,
        goal: Pose2D | None = None,
        samples: int = 0,
        shadow_size: int = 1024,
    ) -> None:
        self.world, self.robot = world, robot
        self._aspect = size[0] / size[1]
        self._bounds = shown_bounds(world.solids)
        drawn = drawn_solids(world.solids)
        shown = [one.solid for one in drawn if not isinstance(one.solid.shape, OccupancyCells)]
        spec = build_spec(replace(world, solids=tuple(shown)), robot)
        sides = _outer_walls(drawn, self._bounds)
        for side in (*_EDGES, None):
            added = add_edges(spec, f"viewer:{side}", [one for one in drawn if sides.get(one.solid.name) == side])
            sides |= {name: side for name in added if side}
        spec.visual.global_.offwidth, spec.visual.global_.offheight = size
        spec.visual.quality.offsamples, spec.visual.quality.shadowsize = samples, shadow_size
        # With sunlight and matte surfaces, boxes need no subdivision for lighting; rendering takes half as long.
        spec.visual.quality.numquads = 1
        spec.visual.map.zfar = 100.0  # depth of shadows: other values give a speckled floor
        if path is not None:
            _add_path(spec, path)
        if goal is not None:
            _add_goal(spec, goal, robot)
        self._moving = MovingBodies(spec, world, GROUP_MARKS) if world.movers else None
        if sides or any(one.of_map for one in drawn):
            _lay_slab(spec, self._bounds)
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        geoms = [(self.model.geom(name).id, side) for name, side in sides.items()]
        self._walls = [(geom, side, float(self.model.geom_rgba[geom, 3])) for geom, side in geoms]
        self._sight = np.array([1, 1, 0, 0, 0, 0], dtype=np.uint8)
        self.place(Pose2D(0.0, 0.0))

    def place(self, pose: Pose2D, wheel_positions: WheelSpeeds = AT_REST, movers: ShownMovers | None = None) -> None:
        """Put the robot at a pose (map frame), with its drive wheels turned by these angles [rad], and the movers."""
        if self._moving is not None and movers is not None:
            self._moving.place(self.model, self.data, movers)
        upright = (math.cos(pose.yaw / 2.0), 0.0, 0.0, math.sin(pose.yaw / 2.0))
        self.data.joint("base_link").qpos[:] = (pose.x, pose.y, 0.0, *upright)
        for wheel in self.robot.drive.wheels:
            turned = wheel_positions.left if wheel.side > 0 else wheel_positions.right
            self.data.joint(wheel.joint).qpos[0] = turned
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_comPos(self.model, self.data)
        mujoco.mj_camlight(self.model, self.data)

    def aim(self, camera: str | Camera, pose: Pose2D) -> Camera:
        """Place a camera by name for a robot at `pose`, and let it see past the outer walls on its side."""
        for geom, _, alpha in self._walls:
            self.model.geom_rgba[geom, 3] = alpha
        if isinstance(camera, str):
            camera = aim(camera, self.world, self.robot, pose, self._aspect, self.is_clear)
        (west, south, _), (east, north, _) = self._bounds
        x, y = camera.eye[:2]
        outside = {"west": x < west, "east": x > east, "south": y < south, "north": y > north}
        for geom, side, _ in self._walls:
            if outside[side]:
                self.model.geom_rgba[geom, 3] = 0.0
        return camera

    def is_clear(self, target: tuple[float, float, float], eye: tuple[float, float, float]) -> bool:
        """Return whether no solid is between two points [m], map frame."""
        start, ray = np.array(target), np.subtract(eye, target)
        met = mujoco.mj_ray(self.model, self.data, start, ray, self._sight, True, -1, None)
        return not 0.0 <= met <= _CLEAR


def _outer_walls(drawn: Sequence[DrawnSolid], bounds: tuple[FloatArray, FloatArray]) -> dict[str, str]:
    """Return the side of each wall at the edges of a world, by its name."""
    sides = {one.solid.name: _side(one.solid, *bounds) for one in drawn}
    return {name: side for name, side in sides.items() if side is not None}


def _side(solid: Solid, low: FloatArray, high: FloatArray) -> str | None:
    """Return the edge of its world that a wall lies along, if it does."""
    if solid.kind != "wall":
        return None
    solid_low, solid_high = solid.bounds()
    reaches = {
        "west": solid_high[0] - low[0],
        "east": high[0] - solid_low[0],
        "south": solid_high[1] - low[1],
        "north": high[1] - solid_low[1],
    }
    return next((name for name, reach in reaches.items() if reach < _AT_EDGE), None)


def _lay_slab(spec: mujoco.MjSpec, bounds: tuple[FloatArray, FloatArray]) -> None:
    """Distinguish the floor of a building from the ground around it, which is darker."""
    low, high = bounds
    spec.add_material(name="viewer:ground", rgba=(0.60, 0.64, 0.68, 1.0), specular=0.0)
    floor = spec.geom(FLOOR)
    slab = _add_mark(spec, mujoco.mjtGeom.mjGEOM_PLANE, (1.0, 1.0, 1.0, 1.0))
    slab.material, floor.material = floor.material, "viewer:ground"
    slab.size = (*((high - low)[:2] / 2.0), 0.05)
    slab.pos = (*((high + low)[:2] / 2.0), 0.001)


def _add_path(spec: mujoco.MjSpec, path: npt.ArrayLike) -> None:
    """Draw a line on the floor; a straight part is a single piece, which renders faster."""
    for start, end in path_pieces(path):
        geom = _add_mark(spec, mujoco.mjtGeom.mjGEOM_CAPSULE, PATH_COLOR)
        geom.size = (PATH_RADIUS_M, 0.0, 0.0)
        geom.fromto = (*start, PATH_HEIGHT_M, *end, PATH_HEIGHT_M)


def _add_goal(spec: mujoco.MjSpec, goal: Pose2D, robot: Robot) -> None:
    geom = _add_mark(spec, mujoco.mjtGeom.mjGEOM_CYLINDER, GOAL_COLOR)
    geom.size = (goal_radius(robot.circumscribed_radius), GOAL_HALF_HEIGHT_M, 0.0)
    geom.pos = (goal.x, goal.y, 0.005)


def _add_mark(spec: mujoco.MjSpec, kind: mujoco.mjtGeom, color: tuple[float, float, float, float]) -> mujoco.MjsGeom:
    """Add a geom that does not collide."""
    return spec.worldbody.add_geom(type=kind, rgba=color, contype=0, conaffinity=0, mass=0.0, group=GROUP_MARKS)


class MovingBodies:
    """Adds dots for the trails of movers to a model, and then places movers and dots.

    Args:
        spec: The model with the world; its movers are bodies already.
        world: The world.
        group: Geom group of the dots.
    """

    def __init__(self, spec: mujoco.MjSpec, world: World, group: int) -> None:
        self._names = [name for name, _ in each_body(world.movers)]
        for name in self._names:
            for dot in range(_DOTS):
                body = spec.worldbody.add_body(name=_dot_name(name, dot), mocap=True, pos=(0.0, 0.0, _BELOW_M))
                body.add_geom(
                    type=mujoco.mjtGeom.mjGEOM_CYLINDER,
                    size=(_DOT_RADIUS_M, _DOT_HALF_HEIGHT_M, 0.0),
                    rgba=TRAIL_COLOR,
                    contype=0,
                    conaffinity=0,
                    mass=0.0,
                    group=group,
                )

    def place(self, model: mujoco.MjModel, data: mujoco.MjData, shown: ShownMovers) -> None:
        """Put the movers where they are, with dots evenly along each trail; those not shown stay where they are."""
        at = {state.name: index for index, state in enumerate(shown.states)}
        for name in self._names:
            if name not in at:
                continue
            pose = shown.states[at[name]].pose
            slots = np.array([model.body(f"{MOVER}{name}").mocapid[0]])
            place_movers(data, slots, np.array([pose.as_tuple()]))
            trail = shown.trails[at[name]] if at[name] < len(shown.trails) else np.zeros((0, 2))
            picked = np.linspace(0, len(trail) - 1, _DOTS + 1).round().astype(int)[:-1] if len(trail) > _DOTS else []
            for dot in range(_DOTS):
                slot = int(model.body(_dot_name(name, dot)).mocapid[0])
                data.mocap_pos[slot] = (*trail[picked[dot]], 0.004) if dot < len(picked) else (0.0, 0.0, _BELOW_M)


def movers_at_start(world: World, robot: Robot, pose: Pose2D) -> ShownMovers:
    """Return where the movers of a world are when a run with seed 0 begins.

    Raises:
        WorldError: If there is no room for a crowd.
    """
    if not world.movers:
        return ShownMovers()
    field = MoverField(world, robot)
    field.reset(0, pose)
    return ShownMovers(field.states())


def _dot_name(name: str, dot: int) -> str:
    return f"viewer:trail:{name}:{dot}"
