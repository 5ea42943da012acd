"""`SceneModel`: a MuJoCo model of a robot in a world with movers and trails, and how maps look in it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import mujoco
import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray, Pose2D
from trundle.geometry.solids import Box, Color, OccupancyCells, Solid
from trundle.robots import Robot, WheelSpeeds
from trundle.sim.mover_history import ShownMovers
from trundle.sim.movers import MoverField
from trundle.sim.mujoco.model import build_spec
from trundle.sim.mujoco.mover_bodies import place_movers
from trundle.sim.mujoco.world_parts import FLOOR, GROUP_WORLD, MOVER
from trundle.viewer.cameras import Camera, aim
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
from trundle.worlds.map_look import CAP_COLOR, FOOT_COLOR, DrawnSolid, drawn_solids, shown_bounds
from trundle.worlds.movers.crowd import each_body
from trundle.worlds.walls import merge_cells

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


GROUP_MARKS = 4
"""Geom group of what is drawn only; lines of sight ignore it."""

_CAP_M, _FOOT_M = 0.05, 0.07  # heights of the dark top and of the foot
_PROUD_M = 0.012  # how far both stand out from the wall
_NORMALS = np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)], dtype=np.float64)
_TANGENTS = np.roll(_NORMALS, 1, axis=1)
_SIDES, _WITH_TOP = 4, 5  # how many faces of a box are drawn: nobody sees those below


def add_edges(spec: mujoco.MjSpec, name: str, drawn: Sequence[DrawnSolid]) -> list[str]:
    """Add the edges of a map's solids, and the walls of those that are fields of cells; return the geoms' names.

    Args:
        spec: The model to add to.
        name: Beginning of the names.
        drawn: Solids, of which those of a map count.
    """
    added: list[str] = []
    caps: list[FloatArray] = []
    feet: list[FloatArray] = []
    for one in drawn:
        boxes = _boxes(one.solid)
        if not one.of_map or not len(boxes):
            continue
        if isinstance(one.solid.shape, OccupancyCells):
            added.append(_add_faces(spec, f"{name}:{one.solid.name}", [boxes], _WITH_TOP, one.solid.color, GROUP_WORLD))
        high = float(boxes[0, 5])
        feet.append(_between(boxes, 0.0, min(_FOOT_M, high)))
        if one.capped:
            caps.append(_between(boxes, high - min(_CAP_M, high), high + 0.1 * _PROUD_M))
    if caps:
        added.append(_add_faces(spec, f"{name}:tops", caps, _WITH_TOP, CAP_COLOR, GROUP_MARKS))
    if feet:
        added.append(_add_faces(spec, f"{name}:feet", feet, _SIDES, FOOT_COLOR, GROUP_MARKS))
    return added


def _boxes(solid: Solid) -> FloatArray:
    """Return boxes (x, y, half width, half depth, yaw, top) [m, rad] that a map's solid consists of, shape (N, 6)."""
    match solid.shape:
        case Box((width, depth, height)):
            x, y, _ = solid.pose.position
            return np.array([(x, y, width / 2.0, depth / 2.0, solid.pose.yaw(), height)])
        case OccupancyCells(blocked, resolution, height):
            found = merge_cells(blocked.view(np.uint8), most=blocked.size)
            if found is None:
                return np.zeros((0, 6))
            row, row_end, col, col_end = (resolution * edge.astype(np.float64) for edge in found[:4])
            middle = np.c_[(col + col_end) / 2.0, (row + row_end) / 2.0, np.zeros(len(row))]
            places = solid.pose.transform_points(middle)[:, :2]
            half = np.c_[(col_end - col) / 2.0, (row_end - row) / 2.0]
            return np.c_[places, half, np.full(len(row), solid.pose.yaw()), np.full(len(row), height)]
        case _:
            return np.zeros((0, 6))


def _between(boxes: FloatArray, low: float, high: float) -> FloatArray:
    """Return slightly wider boxes between two heights [m]: x, y, half width, half depth, yaw, low, high."""
    wider = boxes[:, :5].copy()
    wider[:, 2:4] += _PROUD_M
    return np.c_[wider, np.full(len(boxes), low), np.full(len(boxes), high)]


def _add_faces(
    spec: mujoco.MjSpec, name: str, boxes: Sequence[FloatArray], faces: int, color: Color, group: int
) -> str:
    """Add the first so many faces of boxes as one mesh, which renders faster than so many geoms."""
    parts = [part if part.shape[1] == 7 else np.insert(part, 5, 0.0, axis=1) for part in boxes]
    x, y, half_x, half_y, yaw, low, high = np.concatenate(parts).T
    half = np.c_[half_x, half_y, (high - low) / 2.0]
    middle = np.c_[x, y, (high + low) / 2.0]
    normals, across = _NORMALS[:faces], _TANGENTS[:faces]
    up = np.cross(normals, across)
    square = [normals - across - up, normals + across - up, normals + across + up, normals - across + up]
    corners = np.stack(square, axis=1)[None] * half[:, None, None, :]
    cos, sin = np.cos(yaw), np.sin(yaw)
    turn = np.zeros((len(x), 3, 3))
    turn[:, 0, 0], turn[:, 0, 1], turn[:, 1, 0], turn[:, 1, 1], turn[:, 2, 2] = cos, -sin, sin, cos, 1.0
    points = np.einsum("nij,nfkj->nfki", turn, corners) + middle[:, None, None, :]
    outward = np.broadcast_to(np.einsum("nij,fj->nfi", turn, normals)[:, :, None, :], points.shape)
    first = 4 * np.arange(len(x) * faces)[:, None]
    triangles: npt.NDArray[np.int64] = np.concatenate(
        [first + np.array([0, 1, 2]), first + np.array([0, 2, 3])], axis=1
    )
    mesh = spec.add_mesh(name=name, inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL)
    mesh.uservert, mesh.usernormal = points.ravel().tolist(), outward.ravel().tolist()
    mesh.userface = mesh.userfacenormal = triangles.ravel().tolist()
    spec.worldbody.add_geom(
        name=name,
        type=mujoco.mjtGeom.mjGEOM_MESH,
        meshname=name,
        rgba=color,
        contype=0,
        conaffinity=0,
        mass=0.0,
        group=group,
    )
    return name
