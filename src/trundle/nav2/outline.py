"""The outline of the robot: `footprint` or `robot_radius`, with `footprint_padding`."""

from __future__ import annotations

import math

import numpy as np

from trundle.errors import InputError
from trundle.files.yaml_config import plain_value
from trundle.files.yaml_nodes import compose_text
from trundle.geometry import FloatArray, Footprint, convex_hull
from trundle.nav2.notes import Notes
from trundle.nav2.parameters import NodeParameters

PADDING_M = 0.01
"""Nav2's default of `footprint_padding`."""

_CORNERS = 16
"""Corners of the polygon that Nav2 makes of a circle."""

_MOST_CORNERS = 64
DECIMALS = 9


def read_outline(node: NodeParameters, notes: Notes) -> FloatArray | None:
    """Read the corners of a costmap's padded footprint in base_link [m], shape (N, 2), or None without one.

    Raises:
        InputError: If it is no outline around base_link.
    """
    padding = node.number("footprint_padding", PADDING_M)
    corners = _read_corners(node)
    if corners is None:
        if not node.has("robot_radius"):
            return None
        radius = node.number("robot_radius", 0.1, above=0.0)
        angles = np.arange(_CORNERS) * (2.0 * math.pi / _CORNERS)
        corners = radius * np.column_stack([np.cos(angles), np.sin(angles)])
    elif node.has("robot_radius"):
        notes.ignored(node, "robot_radius", "the footprint counts, as in Nav2")
    # As Nav2 pads: each coordinate away from 0, and none that is 0.
    corners = np.round(np.where(np.abs(corners) < 1e-9, 0.0, corners), DECIMALS)
    padded = np.round(corners + np.sign(corners) * padding, DECIMALS)
    name = "robot_radius" if node.value("footprint") in (None, "[]", "") else "footprint"
    try:
        return Footprint(padded).outline
    except InputError:
        pass
    try:
        outline = Footprint(convex_hull(padded, least_turn=1e-12)).outline
    except InputError as error:
        raise node.wrong(name, f"is no outline around base_link: {error}") from None
    notes.changed(node, name, "trundle's outlines are convex: the convex hull of the corners is taken")
    return outline


def _read_corners(node: NodeParameters) -> FloatArray | None:
    """Read the corners as the file gives them, or None if it does not give any."""
    found = node.find("footprint")
    if found is None or found.value in ("", "[]", None, []):
        return None
    return read_points(node, "footprint")


def read_points(node: NodeParameters, name: str) -> FloatArray:
    """Read the points of a polygon: text such as `[[0.3, 0.2], …]`, a list of pairs, or a flat list as in Humble.

    Raises:
        InputError: If it is none of these, or has fewer than 3 points or more than 64.
    """
    found = node.find(name)
    value = None if found is None else found.value
    if found is not None and isinstance(value, str):
        try:
            value = plain_value(compose_text(value, found.where), found.where)
        except InputError:
            raise node.wrong(name, 'must be a list of points, as "[[0.3, 0.2], [-0.3, 0.2], …]"') from None
    try:
        points = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        points = np.zeros(1)  # no points
    if points.ndim == 1 and points.size % 2 == 0:
        points = points.reshape(-1, 2)
    if points.ndim != 2 or points.shape[-1] != 2 or not np.isfinite(points).all():
        raise node.wrong(name, 'must be a list of points, as "[[0.3, 0.2], [-0.3, 0.2], …]"')
    if not 3 <= len(points) <= _MOST_CORNERS:
        raise node.wrong(name, f"must have 3 to {_MOST_CORNERS} points")
    return points
