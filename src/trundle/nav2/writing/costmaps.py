"""The two costmaps, and the servers of the masks."""

from __future__ import annotations

import math

from trundle.costmap import LayersSettings
from trundle.costmap.costs import DEFAULT_MARGIN_M
from trundle.costmap.layers import ObstacleLayerSettings
from trundle.maps import KeepoutMask, OccupancyGrid, SpeedMask
from trundle.messages.topic_names import scan_topic
from trundle.nav2.names import INFLATION_LAYER, KEEPOUT_FILTER, OBSTACLE_LAYER, SPEED_FILTER, STATIC_LAYER
from trundle.nav2.reading.costmaps import RANGES, UNKNOWN_COST
from trundle.nav2.writing.draft import Block, Draft

LOCAL_M = 6
"""Edge of the local costmap [m]: what trundle's `mppi` looks at to each side, and pure pursuit needs."""

_NOT_NAV2 = "Nav2's obstacle layer has nothing like it"


def write_costmaps(draft: Draft, grid: OccupancyGrid, keepout: KeepoutMask | None, speeds: SpeedMask | None) -> None:
    """Write both costmaps with their layers and filters, and the servers of the masks."""
    scenario = draft.scenario
    layers = LayersSettings() if scenario.layers is None else scenario.layers
    corners = [[float(x), float(y)] for x, y in draft.robot.outline]
    filters, own = _write_filters(keepout, speeds)
    inflation: Block = {
        "plugin": INFLATION_LAYER,
        "inflation_radius": float(_inflation_of(draft)),
        "cost_scaling_factor": float(scenario.cost_scaling_factor),
    }
    sensed: Block = {}
    if layers.obstacle is not None and draft.lidars:
        sensed = {"obstacle_layer": _write_obstacles(draft, layers.obstacle)}
    elif not draft.lidars:
        draft.changed("lidar", False, "no obstacle layers are written: Nav2 drives by the map alone")
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
            **{key: float(getattr(settings, key)) for key in RANGES},
        }
    for key in ("hits_to_mark", "misses_to_clear"):
        if getattr(settings, key) != 1:
            text = "Nav2 marks and clears with each scan"
            draft.left_out(f"layers.obstacle.{key}", getattr(settings, key), text)
    defaults = ObstacleLayerSettings()
    for key in ("clear_static", "static_tolerance", "source_timeout"):
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


def _write_filters(keepout: KeepoutMask | None, speeds: SpeedMask | None) -> tuple[Block, dict[str, Block]]:
    """The filters of the global costmap, and the servers of their masks."""
    filters: Block = {}
    servers: dict[str, Block] = {}
    given = (("keepout", KEEPOUT_FILTER, keepout), ("speed", SPEED_FILTER, speeds))
    for name, plugin, mask in given:
        if mask is None:
            continue
        info, topic = f"/{name}_costmap_filter_info", f"/{name}_filter_mask"
        filters[f"{name}_filter"] = {"plugin": plugin, "enabled": True, "filter_info_topic": info}
        kind, base, multiplier = 0, 0.0, 1.0
        if isinstance(mask, SpeedMask):
            kind, base, multiplier = (1 if mask.unit == "percent" else 2), mask.base, mask.multiplier
            filters[f"{name}_filter"]["speed_limit_topic"] = "/speed_limit"  # type: ignore[index]
        servers[f"{name}_filter_mask_server"] = {"topic_name": topic, "yaml_filename": f"{name}.yaml"}
        servers[f"{name}_costmap_filter_info_server"] = {
            "type": kind,
            "filter_info_topic": info,
            "mask_topic": topic,
            "base": float(base),
            "multiplier": float(multiplier),
        }
    return filters, servers
