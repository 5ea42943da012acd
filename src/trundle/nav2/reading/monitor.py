"""The collision monitor: its polygons as widths around the footprint."""

from __future__ import annotations

import numpy as np

from trundle.geometry import FloatArray
from trundle.nav2.parameters import NodeParameters
from trundle.nav2.reading.notes import Notes
from trundle.nav2.reading.outline import read_points

_DECIMALS = 6
_NEVER_S = 3600.0
_ACTIONS = ("stop", "slowdown", "approach", "limit")


def read_monitor(node: NodeParameters, outline: FloatArray, notes: Notes) -> dict[str, object] | bool:
    """Settings of a collision monitor; False where it is switched off.

    Args:
        node: Its parameters.
        outline: The robot's outline in base_link [m], shape (N, 2).
        notes: Where differences are noted.

    Raises:
        InputError: If a parameter cannot be used.
    """
    if not node.flag("enabled", True):
        return False
    zones = [node.of_plugin(name) for name in node.texts("polygons", ())]
    zones = [zone for zone in zones if zone.flag("enabled", True)]
    settings: dict[str, object] = {"stop_padding": 0.0, "slowdown_padding": 0.0, "time_before_collision": 0.0}
    points: list[int] = []
    for zone in zones:
        action = zone.text("action_type", "")
        if action not in _ACTIONS:
            raise zone.wrong("action_type", f"must be {', '.join(_ACTIONS[:-1])} or {_ACTIONS[-1]}")
        if action == "limit":
            notes.ignored(zone, "action_type", "trundle's monitor has no limit zones: use a speed mask")
            continue
        points.append(_least_points(zone))
        if action == "approach":
            settings["time_before_collision"] = zone.number("time_before_collision", 2.0, least=0.0)
            settings["simulation_time_step"] = zone.number("simulation_time_step", 0.1, above=0.0)
            continue
        padding = _read_padding(zone, outline, notes)
        if padding is None:
            continue
        if action == "stop":
            settings["stop_padding"] = padding
        else:
            settings["slowdown_padding"] = padding
            settings["slowdown_ratio"] = zone.number("slowdown_ratio", 0.5, above=0.0, most=1.0)
    if points:
        settings["min_points"] = min(points)
        if len(set(points)) > 1:
            notes.changed(node, "polygons", f"trundle has one number of points for all of them: {min(points)}")
    timeout = node.number("source_timeout", 2.0, least=0.0)
    if timeout == 0.0:
        notes.changed(node, "source_timeout", f"never is {_NEVER_S:g} s in trundle")
    settings["source_timeout"] = timeout or _NEVER_S
    return settings


def _least_points(zone: NodeParameters) -> int:
    if zone.has("min_points"):
        return zone.integer("min_points", 4, least=1)
    return zone.integer("max_points", 3, least=0) + 1  # Humble's


def _read_padding(zone: NodeParameters, outline: FloatArray, notes: Notes) -> float | None:
    """How far a zone reaches past the footprint on its nearest side [m]; None where it has no shape."""
    kind = zone.text("type", "polygon")
    if kind == "circle":
        radius = zone.number("radius", 0.0, above=0.0)
        room = radius - float(np.hypot(outline[:, 0], outline[:, 1]).max())
        name = "radius"
    elif kind == "polygon" and zone.has("points"):
        room = _least_distance(outline, read_points(zone, "points"))
        name = "points"
    elif kind == "polygon":
        zone.text("footprint_topic", "")
        return 0.0  # the footprint itself
    else:
        notes.ignored(zone, "type", "trundle's zones are the footprint, wider on all sides by the same distance")
        return None
    padding = round(max(0.0, room), _DECIMALS)
    notes.changed(
        zone,
        name,
        f"trundle's zone is the footprint, wider by {padding:g} m: what it is wider on its nearest side",
    )
    return padding


def _least_distance(outline: FloatArray, zone: FloatArray) -> float:
    """How far every edge of an outline can be moved outwards within a zone [m]; negative where it is not inside."""
    corners = outline if _area(outline) > 0.0 else outline[::-1]
    edges = np.roll(corners, -1, axis=0) - corners
    normals = np.column_stack([edges[:, 1], -edges[:, 0]]) / np.hypot(edges[:, 0], edges[:, 1])[:, None]
    reach = (zone @ normals.T).max(axis=0)
    return float((reach - (corners * normals).sum(axis=1)).min())


def _area(points: FloatArray) -> float:
    after = np.roll(points, -1, axis=0)
    return 0.5 * float((points[:, 0] * after[:, 1] - after[:, 0] * points[:, 1]).sum())
