"""The visuals of a robot, from its footprint, wheels, casters and lidars; they do not collide."""

from __future__ import annotations

import math
from collections.abc import Sequence

import mujoco
import numpy as np

from trundle.geometry import FloatArray
from trundle.robots import Robot

GROUP_LOOKS = 2

_DARK = (0.09, 0.10, 0.11, 1.0)
_GREY = (0.20, 0.21, 0.23, 1.0)
_STEEL = (0.62, 0.64, 0.66, 1.0)
_TYRE = (0.05, 0.05, 0.055, 1.0)
_GLASS = (0.03, 0.05, 0.07, 1.0)
_LIGHT = (0.95, 0.97, 0.90, 1.0)
_PUCK_RADIUS = 0.045

_ACROSS_Y = (math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0)
"""Quaternion that lays a cylinder along y."""


def add_prism_mesh(spec: mujoco.MjSpec, name: str, outline: FloatArray, low: float, high: float) -> None:
    """Add a mesh: a convex outline [m], counter-clockwise, shape (N, 2), extruded from `low` to `high` [m]."""
    count = len(outline)
    vertices = np.vstack([np.c_[outline, np.full(count, z)] for z in (low, high)])
    faces: list[tuple[int, int, int]] = []
    for i in range(count):
        j = (i + 1) % count
        faces += [(i, j, count + j), (i, count + j, count + i)]
    for i in range(1, count - 1):
        faces += [(0, i + 1, i), (count, count + i, count + i + 1)]
    spec.add_mesh(name=name, uservert=vertices.ravel().tolist(), userface=np.ravel(faces).tolist())


def add_looks(spec: mujoco.MjSpec, base: mujoco.MjsBody, robot: Robot, wheels: Sequence[tuple[str, int]]) -> None:
    """Add visuals to a robot's existing bodies: chassis, wheels, casters, lidar pucks and a light at the front.

    Args:
        spec: The model to add to.
        base: base_link.
        robot: The robot.
        wheels: Bodies of the visible wheels, with +1 on the left and -1 on the right.
    """
    spec.add_material(name="robot:glow", rgba=_LIGHT, emission=0.6)
    _add_sun(base)
    _dress_chassis(spec, base, robot)
    drive = robot.drive
    for name, sign in wheels:
        body = base.find_child(name)
        _add_roller(body, drive.wheel_radius, drive.wheel_width, _TYRE)
        _add_roller(body, 0.62 * drive.wheel_radius, 1.04 * drive.wheel_width, _STEEL)
        _add_spokes(body, 0.56 * drive.wheel_radius, sign * 0.525 * drive.wheel_width)
    for index, caster in enumerate(robot.casters):
        body = base.find_child(f"caster_{index}")
        if not caster.is_swivel:
            _add(body, mujoco.mjtGeom.mjGEOM_SPHERE, (caster.radius, 0.0, 0.0), (0.0, 0.0, 0.0), _STEEL)
            continue
        _add_roller(body, caster.radius, caster.width, _TYRE)
        _add_roller(body, 0.55 * caster.radius, 1.06 * caster.width, _STEEL)
        fork = base.find_child(f"caster_{index}_fork")
        for sign in (1.0, -1.0):
            size = (0.6 * caster.trail, 0.1 * caster.width, 0.6 * caster.radius)
            at = (-caster.trail / 2.0, sign * 0.68 * caster.width, 0.5 * caster.radius)
            _add(fork, mujoco.mjtGeom.mjGEOM_BOX, size, at, _GREY)


def _add_sun(base: mujoco.MjsBody) -> None:
    """A light that moves with the robot: its shadow map covers only the surroundings and stays sharp."""
    base.add_light(
        name="robot:sun",
        type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
        mode=mujoco.mjtCamLight.mjCAMLIGHT_TRACK,
        pos=(-1.5, -1.2, 6.0),
        dir=(0.25, 0.2, -1.0),
        diffuse=(0.55, 0.54, 0.52),
        specular=(0.12, 0.12, 0.12),
        castshadow=True,
    )


def _dress_chassis(spec: mujoco.MjSpec, base: mujoco.MjsBody, robot: Robot) -> None:
    """A dark body with a band in the robot's colour, a deck under the lowest lidar, and a tower on taller robots."""
    low, top = robot.body.clearance, robot.body.height
    span = top - low
    accent = (*robot.body.color, 1.0)
    mounts = [lidar.z for lidar in robot.lidars.values()]
    deck = min([top, *(z - min(0.035, 0.1 * top) for z in mounts)])
    deck = max(deck, low + 0.4 * span)
    wide = _shrunk(robot.outline, 0.985)
    band_low, band_high = deck - 0.30 * (deck - low), deck - 0.12 * (deck - low)
    _add_prism(spec, base, "skirt", _between_wheels(robot), low, band_low, _DARK)
    _add_prism(spec, base, "band", wide, band_low, band_high, accent)
    _add_prism(spec, base, "deck", _shrunk(robot.outline, 0.97), band_high, deck, _GREY)
    front = _front(robot.outline)
    half_width = float(np.abs(robot.outline[:, 1]).max())
    height = band_low - low
    eyes = (0.012, 0.42 * half_width, 0.10 * height)
    _add(base, mujoco.mjtGeom.mjGEOM_BOX, eyes, (0.965 * front, 0.0, low + 0.72 * height), _GLASS)
    light = (0.012, 0.62 * half_width, 0.035 * height)
    _add(base, mujoco.mjtGeom.mjGEOM_BOX, light, (0.967 * front, 0.0, low + 0.45 * height), _LIGHT, glow=True)
    _add_arrow(spec, base, robot, deck, accent)
    if top - deck > 0.08 * top:
        _add_tower(spec, base, robot, deck, accent)
    for lidar in robot.lidars.values():
        radius = min(_PUCK_RADIUS, 0.35 * half_width)
        half = min(0.03, 0.12 * top)
        _add(base, mujoco.mjtGeom.mjGEOM_CYLINDER, (radius, half, 0.0), (lidar.x, lidar.y, lidar.z), _DARK)
        _add(
            base, mujoco.mjtGeom.mjGEOM_CYLINDER, (1.03 * radius, 0.3 * half, 0.0), (lidar.x, lidar.y, lidar.z), _GLASS
        )


def _add_tower(spec: mujoco.MjSpec, base: mujoco.MjsBody, robot: Robot, deck: float, accent: tuple[float, ...]) -> None:
    """A narrower upper part between the lidars, with a round one on top: it ends at the robot's height."""
    low, high = robot.outline.min(axis=0), robot.outline.max(axis=0)
    middle = (low + high) / 2.0
    outline = (robot.outline - middle) * (0.46, 0.72) + middle
    top = robot.body.height
    roof = deck + 0.62 * (top - deck)
    _add_prism(spec, base, "tower", outline, deck, roof - 0.1 * (top - deck), _DARK)
    _add_prism(spec, base, "roof", _shrunk(outline, 1.05), roof - 0.1 * (top - deck), roof, accent)
    half = (top - roof) / 2.0
    at = (float(middle[0]), float(middle[1]), roof + half)
    radius = min(0.052, 0.3 * float((high - low).min()))
    _add(base, mujoco.mjtGeom.mjGEOM_CYLINDER, (radius, half, 0.0), at, _DARK)
    _add(base, mujoco.mjtGeom.mjGEOM_CYLINDER, (1.02 * radius, 0.35 * half, 0.0), at, _STEEL)


def _add_arrow(spec: mujoco.MjSpec, base: mujoco.MjsBody, robot: Robot, deck: float, accent: tuple[float, ...]) -> None:
    """A wedge on the deck that points forward."""
    front = _front(robot.outline)
    size = 0.30 * float(np.abs(robot.outline[:, 1]).max())
    tip = 0.93 * front
    outline = np.array([[tip, 0.0], [tip - size, 0.8 * size], [tip - size, -0.8 * size]])
    bright = tuple(min(1.0, 0.25 + 1.6 * value) for value in accent[:3])
    _add_prism(spec, base, "arrow", outline, deck, deck + 0.006, (*bright, 1.0))


def _add_roller(body: mujoco.MjsBody, radius: float, width: float, color: tuple[float, ...]) -> None:
    geom = _add(body, mujoco.mjtGeom.mjGEOM_CYLINDER, (radius, width / 2.0, 0.0), (0.0, 0.0, 0.0), color)
    geom.quat = _ACROSS_Y


def _add_spokes(body: mujoco.MjsBody, reach: float, y: float) -> None:
    """Three bars on the outer face, so that the wheel's rotation is visible."""
    for turn in (0.0, math.pi / 3.0, 2.0 * math.pi / 3.0):
        geom = _add(body, mujoco.mjtGeom.mjGEOM_BOX, (reach, 0.002, 0.13 * reach), (0.0, y, 0.0), _DARK)
        geom.quat = (math.cos(turn / 2.0), 0.0, math.sin(turn / 2.0), 0.0)


def _add_prism(
    spec: mujoco.MjSpec,
    body: mujoco.MjsBody,
    name: str,
    outline: FloatArray,
    low: float,
    high: float,
    color: tuple[float, ...],
) -> None:
    add_prism_mesh(spec, f"robot:{name}", outline, low, high)
    geom = _add(body, mujoco.mjtGeom.mjGEOM_MESH, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), color)
    geom.meshname = f"robot:{name}"


def _add(
    body: mujoco.MjsBody,
    kind: mujoco.mjtGeom,
    size: tuple[float, float, float],
    at: tuple[float, float, float],
    color: tuple[float, ...],
    *,
    glow: bool = False,
) -> mujoco.MjsGeom:
    geom = body.add_geom(
        type=kind, size=size, pos=at, rgba=color, contype=0, conaffinity=0, mass=0.0, group=GROUP_LOOKS
    )
    if glow:
        geom.material = "robot:glow"
    return geom


def _shrunk(outline: FloatArray, scale: float) -> FloatArray:
    middle = (outline.min(axis=0) + outline.max(axis=0)) / 2.0
    return (outline - middle) * scale + middle


def _between_wheels(robot: Robot) -> FloatArray:
    """Return the outline, narrowed so that wheels inside it are visible from the side."""
    half_width = float(np.abs(robot.outline[:, 1]).max())
    inside = robot.drive.track_width / 2.0 - 0.55 * robot.drive.wheel_width
    across = inside / half_width if 0.5 * half_width < inside < half_width else 1.0
    return _shrunk(robot.outline, 0.97) * (1.0, min(1.0, across))


def _front(outline: FloatArray) -> float:
    """Return where the x axis crosses the front of the outline [m]."""
    return float(outline[:, 0].max())
