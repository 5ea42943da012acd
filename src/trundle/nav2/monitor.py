"""The collision monitor, read and written: its polygons are widths around the footprint."""

from __future__ import annotations

import numpy as np

from trundle.control import MonitorSettings
from trundle.geometry import FloatArray
from trundle.messages.makers import scan_topic
from trundle.nav2.draft import Block, Draft
from trundle.nav2.notes import Notes
from trundle.nav2.outline import read_points
from trundle.nav2.parameters import NodeParameters
from trundle.nav2.table import APPROACH, SLOWDOWN, read_rows, write_rows

_PADDING_DECIMALS = 6

_NEVER_S = 3600.0
"""What a `source_timeout` of 0 becomes, with which Nav2's monitor never takes a source for lost [s]."""

_ACTIONS = ("stop", "slowdown", "approach", "limit")

_OWN = ("moving_padding", "moving_clearance", "moving_time")
_CORNER_DECIMALS = 9


def read_monitor(node: NodeParameters, outline: FloatArray, notes: Notes) -> dict[str, object] | bool:
    """Read the settings of a collision monitor, or False if it is switched off.

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
            settings |= read_rows(APPROACH, zone)
            continue
        padding = _read_padding(zone, outline, notes)
        if padding is None:
            continue
        if action == "stop":
            settings["stop_padding"] = padding
        else:
            settings["slowdown_padding"] = padding
            settings |= read_rows(SLOWDOWN, zone)
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
    """Return how far a zone reaches past the footprint on its nearest side [m], or None if it has no shape."""
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
    padding = round(max(0.0, room), _PADDING_DECIMALS)
    notes.changed(
        zone,
        name,
        f"trundle's zone is the footprint, wider by {padding:g} m: what it is wider on its nearest side",
    )
    return padding


def _least_distance(outline: FloatArray, zone: FloatArray) -> float:
    """Return how far every edge of an outline can be moved outwards within a zone [m]; it is negative outside."""
    corners = outline if _area(outline) > 0.0 else outline[::-1]
    edges = np.roll(corners, -1, axis=0) - corners
    normals = np.column_stack([edges[:, 1], -edges[:, 0]]) / np.hypot(edges[:, 0], edges[:, 1])[:, None]
    reach = (zone @ normals.T).max(axis=0)
    return float((reach - (corners * normals).sum(axis=1)).min())


def _area(points: FloatArray) -> float:
    after = np.roll(points, -1, axis=0)
    return 0.5 * float((points[:, 0] * after[:, 1] - after[:, 0] * points[:, 1]).sum())


def monitor_of(draft: Draft) -> MonitorSettings | None:
    """Return the settings of a scenario's monitor, or None if it has none, or no scans."""
    given = draft.scenario.collision_monitor
    if given is False or not draft.lidars:
        return None
    return given if isinstance(given, MonitorSettings) else MonitorSettings()


def write_monitor(draft: Draft) -> None:
    """Write the collision monitor, also one that is switched off."""
    settings = monitor_of(draft)
    if settings is None:
        draft.nodes["collision_monitor"] = {"enabled": False}
        return
    zones: Block = {}
    if settings.stop_padding > 0.0:
        zones["Stop"] = {"type": "polygon", "action_type": "stop", **_write_outline(draft, settings.stop_padding)}
    if settings.slowdown_padding > 0.0:
        zones["Slowdown"] = {
            "type": "polygon",
            "action_type": "slowdown",
            **write_rows(SLOWDOWN, settings),
            **_write_outline(draft, settings.slowdown_padding),
        }
    if settings.time_before_collision > 0.0 or not zones:
        zones["Approach"] = {
            "type": "polygon",
            "action_type": "approach",
            "footprint_topic": "/local_costmap/published_footprint",
            **write_rows(APPROACH, settings),
        }
    points: Block = {"min_points": settings.min_points}
    if draft.distro == "humble":
        points = {"max_points": settings.min_points - 1}
    sources: Block = {
        name: {"type": "scan", "topic": scan_topic(name, draft.robot), "enabled": True} for name in draft.lidars
    }
    if settings.moving_padding > 0.0:
        for name in _OWN:
            draft.left_out(
                f"collision_monitor.{name}", getattr(settings, name), "Nav2's monitor does not know what moves"
            )
    if settings.sources is not None:
        draft.left_out("collision_monitor.sources", ", ".join(settings.sources), "Nav2 waits for all of its sources")
    zones = {name: {**zone, **points, "enabled": True} for name, zone in zones.items() if isinstance(zone, dict)}
    draft.nodes["collision_monitor"] = {
        "base_frame_id": "base_link",
        "odom_frame_id": "odom",
        "cmd_vel_in_topic": "cmd_vel_smoothed",
        "cmd_vel_out_topic": "cmd_vel",
        "state_topic": "collision_monitor_state",
        "transform_tolerance": 0.2,
        "source_timeout": float(settings.source_timeout),
        "base_shift_correction": True,
        "stop_pub_timeout": 2.0,
        "polygons": list(zones),
        **zones,
        "observation_sources": list(draft.lidars),
        **sources,
    }


def _write_outline(draft: Draft, padding: float) -> Block:
    corners = draft.robot.planar.padded(padding).outline.round(_CORNER_DECIMALS).tolist()
    if draft.distro == "humble":
        return {"points": [number for corner in corners for number in corner]}
    return {"points": str(corners)}
