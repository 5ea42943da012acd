"""The two costmaps, read and written: outline, layers, inflation, unknown space, window and filters."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from trundle.costmap import LayersSettings
from trundle.costmap.costs import DEFAULT_MARGIN_M
from trundle.costmap.layers import ObstacleLayerSettings
from trundle.maps import KeepoutMask, OccupancyGrid, SpeedMask
from trundle.messages.makers import scan_topic
from trundle.nav2.draft import Block, Draft
from trundle.nav2.filters import write_filters
from trundle.nav2.names import (
    INFLATION_LAYER,
    OBSTACLE_LAYER,
    STATIC_LAYER,
    VOXEL_LAYER,
    plain_plugin,
)
from trundle.nav2.notes import Notes
from trundle.nav2.outline import read_outline
from trundle.nav2.parameters import NodeParameters
from trundle.nav2.table import INFLATION, RANGES, read_rows, write_rows

UNKNOWN_COST = 252
"""What NavFn makes unknown space cost that it may cross: as much as a cell beside an obstacle."""

_MOST_WINDOW_M, _MOST_RANGE_M = 1000.0, 1000.0
"""What the layers of a scenario take."""

LOCAL_M = 6
"""Edge of the local costmap [m]: what trundle's `mppi` looks at to each side, and pure pursuit needs."""

_NOT_NAV2 = "Nav2's obstacle layer has nothing like it"


@dataclass(frozen=True, slots=True)
class _Layers:
    """The names of a costmap's layers that are switched on, by kind."""

    static: tuple[str, ...]
    obstacles: tuple[str, ...]
    inflation: tuple[str, ...]


def read_costmaps(
    planning: NodeParameters | None, local: NodeParameters | None, *, crosses_unknown: bool, notes: Notes
) -> dict[str, object]:
    """Read the settings of the costmap: those for planning from the global one, the outline from the local one.

    Args:
        planning: The global costmap.
        local: The local costmap.
        crosses_unknown: Whether the planner may cross unknown cells.
        notes: Where differences are noted.

    Raises:
        InputError: If a parameter cannot be used.
    """
    settings: dict[str, object] = {}
    outline = _read_outlines(planning, local, notes)
    if outline is not None:
        settings["assumed"] = {"footprint": [[float(x), float(y)] for x, y in outline]}
    if planning is not None:
        settings |= _read_inflation(planning, local, notes)
        settings |= _read_unknown(planning, crosses_unknown)
        if planning.has("resolution"):
            settings["resolution"] = planning.number("resolution", 0.05, above=0.0)
    return {**settings, **_read_layers(planning, local, notes)}


def _read_outlines(planning: NodeParameters | None, local: NodeParameters | None, notes: Notes) -> np.ndarray | None:
    first = None if local is None else read_outline(local, notes)
    second = None if planning is None else read_outline(planning, notes)
    if first is None:
        return second
    if planning is not None and second is not None and not np.array_equal(first, second):
        for name in ("footprint", "robot_radius", "footprint_padding"):
            notes.changed(planning, name, "trundle plans and drives with one outline: the local costmap's is taken")
    return first


def _find_layers(costmap: NodeParameters | None, notes: Notes) -> _Layers:
    found: dict[str, list[str]] = {STATIC_LAYER: [], OBSTACLE_LAYER: [], INFLATION_LAYER: []}
    for name in () if costmap is None else costmap.texts("plugins", ()):
        layer = costmap.of_plugin(name) if costmap is not None else None
        if layer is None:
            continue
        given = plain_plugin(layer.text("plugin", ""))
        plugin = OBSTACLE_LAYER if given == VOXEL_LAYER else given
        if plugin not in found:
            notes.ignored(layer, "plugin", "this layer is not known to trundle: it is left out")
        elif layer.flag("enabled", True):
            found[plugin].append(name)
    return _Layers(*(tuple(names) for names in found.values()))


def _read_inflation(planning: NodeParameters, local: NodeParameters | None, notes: Notes) -> dict[str, object]:
    names = _find_layers(planning, Notes()).inflation
    if not names:
        return {"inflation_radius": 0.0}
    values = read_rows(INFLATION, planning.of_plugin(names[0]))
    for name in _find_layers(local, Notes()).inflation:
        other = None if local is None else local.of_plugin(name)
        for row in INFLATION:
            value = values[row.setting]
            if other is not None and other.number(row.parameter, row.default) != value:
                notes.changed(other, row.parameter, f"trundle has one costmap: the global one's {value:g} is taken")
    return {**values}


def _read_unknown(planning: NodeParameters, crosses: bool) -> dict[str, object]:
    if not planning.flag("track_unknown_space", False):
        return {"unknown": "free"}
    return {"unknown": "costly", "unknown_cost": UNKNOWN_COST} if crosses else {"unknown": "blocked"}


def _read_layers(planning: NodeParameters | None, local: NodeParameters | None, notes: Notes) -> dict[str, object]:
    """Read the settings of the layers, and whether there are lidars and a map."""
    if planning is None and local is None:
        return {}
    sensed = [
        (costmap, name)
        for costmap in (local, planning)
        if costmap is not None
        for name in _find_layers(costmap, notes).obstacles
    ]
    layers: dict[str, object] = {"obstacle": None}
    settings: dict[str, object] = {"layers": layers}
    if sensed:
        sensed.sort(key=lambda found: not _takes_scans(found[0].of_plugin(found[1])))  # those with scans first
        costmap, name = sensed[0]
        layers["obstacle"] = _read_obstacles(costmap.of_plugin(name), notes)
        settings["lidar"] = True
        for other, second in sensed[1:]:
            _compare_obstacles(other.of_plugin(second), costmap.name, layers["obstacle"], notes)
    if planning is None:
        return settings
    if planning.flag("rolling_window", False):
        layers["rolling_window"] = True
        for side in ("width", "height"):
            layers[side] = planning.number(side, 5.0, above=0.0, most=_MOST_WINDOW_M)
    if not _find_layers(planning, Notes()).static and planning.has("plugins") and sensed:
        notes.changed(planning, "plugins", "no static layer: the robot drives without the map, by its lidars")
        settings["known_map"] = False
    return settings


def _sources(layer: NodeParameters) -> list[NodeParameters]:
    return [layer.of_plugin(name) for name in layer.texts("observation_sources", ())]


def _takes_scans(layer: NodeParameters) -> bool:
    return any(source.text("data_type", "LaserScan") == "LaserScan" for source in _sources(layer))


def _read_obstacles(layer: NodeParameters, notes: Notes) -> dict[str, object]:
    """Read the obstacle layer: it has the widest ranges of its sources, and marks and clears with each scan."""
    sources = _sources(layer)
    found: dict[str, object] = {"hits_to_mark": 1, "misses_to_clear": 1}
    for row in RANGES:
        name = row.parameter
        values = [read_rows((row,), source)[row.setting] for source in sources] or [row.default]
        chosen = (min if "min_range" in name else max)(values)
        for source, value in zip(sources, values, strict=False):
            if value != chosen:
                notes.changed(source, name, f"trundle has one range for all lidars: {chosen:g}")
            elif value > _MOST_RANGE_M:
                notes.changed(source, name, f"trundle's ranges are at most {_MOST_RANGE_M:g} m")
        found[name] = min(chosen, _MOST_RANGE_M)
    for kind in ("obstacle", "raytrace"):
        least, most = float(str(found[f"{kind}_min_range"])), float(str(found[f"{kind}_max_range"]))
        if not least < most:
            raise layer.wrong(f"{kind}_max_range", f"{most:g} must be above {kind}_min_range, {least:g}")
    kept = max((source.number("observation_persistence", 0.0, least=0.0) for source in sources), default=0.0)
    found["observation_persistence"] = kept if kept > 0.0 else None
    found["footprint_clearing_enabled"] = layer.flag("footprint_clearing_enabled", True)
    for source in sources:
        if source.text("data_type", "LaserScan") != "LaserScan":
            notes.changed(source, "data_type", "the layer takes scans: the robot's lidars are its sources")
        for name in ("marking", "clearing"):
            if not source.flag(name, name == "marking") and source.has(name):
                notes.changed(source, name, "trundle's scans mark and clear")
    return found


def _compare_obstacles(layer: NodeParameters, taken: str, chosen: object, notes: Notes) -> None:
    """Note what differs in a layer that is not taken."""
    own = _read_obstacles(layer, Notes())
    if isinstance(chosen, dict) and own == chosen:
        return
    for source in _sources(layer):
        for name in (*(row.parameter for row in RANGES), "observation_persistence"):
            if isinstance(chosen, dict) and own[name] != chosen[name]:
                notes.changed(source, name, f"trundle has one obstacle layer: that of {taken} is taken")


def write_costmaps(draft: Draft, grid: OccupancyGrid, keepout: KeepoutMask | None, speeds: SpeedMask | None) -> None:
    """Write both costmaps with their layers and filters, and the servers of the masks."""
    scenario = draft.scenario
    layers = LayersSettings() if scenario.layers is None else scenario.layers
    corners = [[float(x), float(y)] for x, y in draft.robot.outline]
    filters, own = write_filters(keepout, speeds)
    inflation: Block = {
        "plugin": INFLATION_LAYER,
        "inflation_radius": float(_inflation_of(draft)),
        "cost_scaling_factor": float(scenario.cost_scaling_factor),
    }
    sensed: Block = {}
    if layers.obstacle is not None and draft.lidars:
        sensed = {"obstacle_layer": _write_obstacles(draft, layers.obstacle)}
    elif not draft.lidars:
        draft.changed("lidar", False, "the robot has no lidars, so no obstacle layers: Nav2 drives by the map alone")
    if draft.lidars and draft.scenario.lidar is False:
        draft.changed("lidar", False, "Nav2's robot cannot do without: it localises itself and stops by its lidars")
    common: Block = {
        "robot_base_frame": "base_link",
        "footprint": str(corners),
        "footprint_padding": 0.0,
        "resolution": float(grid.resolution),
        "transform_tolerance": 0.2,
    }
    draft.nodes["local_costmap"] = {
        "global_frame": "odom",
        "update_frequency": 5.0,
        "publish_frequency": 2.0,
        "rolling_window": True,
        "width": LOCAL_M,
        "height": LOCAL_M,
        **common,
        "plugins": [*sensed, "inflation_layer"],
        **sensed,
        "inflation_layer": inflation,
    }
    static: Block = {}
    if scenario.known_map:
        static = {"static_layer": {"plugin": STATIC_LAYER, "map_subscribe_transient_local": True}}
    draft.nodes["global_costmap"] = {
        "global_frame": "map",
        "update_frequency": 1.0,
        "publish_frequency": 1.0,
        **_write_window(draft, layers),
        **common,
        "track_unknown_space": scenario.unknown != "free",
        "plugins": [*static, *sensed, "inflation_layer"],
        **static,
        **sensed,
        "inflation_layer": dict(inflation),
        **({"filters": list(filters), **filters} if filters else {}),
    }
    draft.nodes.update(own)
    _note_unknown(draft)


def _inflation_of(draft: Draft) -> float:
    given = draft.scenario.inflation_radius
    return round(draft.robot.circumscribed_radius + DEFAULT_MARGIN_M, 6) if given is None else given


def _write_window(draft: Draft, layers: LayersSettings) -> Block:
    if not layers.rolling_window and draft.scenario.known_map:
        return {}
    sides = {"width": math.ceil(layers.width), "height": math.ceil(layers.height)}
    for name, value in sides.items():
        if value != getattr(layers, name):
            draft.changed(f"layers.{name}", getattr(layers, name), f"Nav2's windows are whole metres: {value}")
    return {"rolling_window": layers.rolling_window, **sides}


def _write_obstacles(draft: Draft, settings: ObstacleLayerSettings) -> Block:
    scans: Block = {}
    for name in draft.lidars:
        scans[name] = {
            "topic": scan_topic(name, draft.robot),
            "data_type": "LaserScan",
            "marking": True,
            "clearing": True,
            "inf_is_valid": draft.robot.lidars[name].inf_is_valid,
            "max_obstacle_height": 2.0,
            "observation_persistence": float(settings.observation_persistence or 0.0),
            **write_rows(RANGES, settings),
        }
    for key in ("hits_to_mark", "misses_to_clear"):
        if getattr(settings, key) != 1:
            text = "Nav2 marks and clears with each scan"
            draft.left_out(f"layers.obstacle.{key}", getattr(settings, key), text)
    defaults = ObstacleLayerSettings()
    for key in ("clear_static", "doubt_static", "static_tolerance", "source_timeout", "mover_persistence"):
        if getattr(settings, key) != getattr(defaults, key):
            draft.left_out(f"layers.obstacle.{key}", getattr(settings, key), _NOT_NAV2)
    return {
        "plugin": OBSTACLE_LAYER,
        "enabled": True,
        "footprint_clearing_enabled": settings.footprint_clearing_enabled,
        "observation_sources": " ".join(scans),
        **scans,
    }


def _note_unknown(draft: Draft) -> None:
    scenario = draft.scenario
    if scenario.unknown == "costly" and scenario.unknown_cost != UNKNOWN_COST:
        value = scenario.unknown_cost
        draft.changed("unknown_cost", value, f"Nav2's planners make unknown space cost {UNKNOWN_COST}")
