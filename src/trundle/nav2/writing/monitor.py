"""The collision monitor."""

from __future__ import annotations

from trundle.control import MonitorSettings
from trundle.messages.topic_names import scan_topic
from trundle.nav2.writing.draft import Block, Draft

_OWN = ("moving_padding", "moving_clearance", "moving_time")
_DECIMALS = 9


def monitor_of(draft: Draft) -> MonitorSettings | None:
    """The settings of the monitor that a scenario has; none without one, or without scans."""
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
            "slowdown_ratio": float(settings.slowdown_ratio),
            **_write_outline(draft, settings.slowdown_padding),
        }
    if settings.time_before_collision > 0.0 or not zones:
        zones["Approach"] = {
            "type": "polygon",
            "action_type": "approach",
            "footprint_topic": "/local_costmap/published_footprint",
            "time_before_collision": float(settings.time_before_collision),
            "simulation_time_step": float(settings.simulation_time_step),
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
    corners = draft.robot.planar.padded(padding).outline.round(_DECIMALS).tolist()
    if draft.distro == "humble":
        return {"points": [number for corner in corners for number in corner]}
    return {"points": str(corners)}
