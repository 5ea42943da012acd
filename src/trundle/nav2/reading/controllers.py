"""The controller: regulated pure pursuit and MPPI; of others the speeds."""

from __future__ import annotations

from dataclasses import asdict

from trundle.control.pursuit_settings import PursuitSettings
from trundle.nav2.names import DWB, GRACEFUL, MPPI, ROTATION_SHIM, RPP, plain_plugin
from trundle.nav2.parameters import NodeParameters
from trundle.nav2.reading.mppi import read_mppi
from trundle.nav2.reading.notes import Notes
from trundle.nav2.reading.plugins import choose_plugin

Options = dict[str, object]

_OTHERS = ("min_lookahead_dist", "regulated_linear_scaling_min_radius", "cost_scaling_dist")

SPEED_NAMES = ("max_linear_vel", "desired_linear_vel")
"""Of regulated pure pursuit's speed: Lyrical's name, and the one before."""

SAME = {
    "lookahead_dist": 0.6,
    "rotate_to_heading_min_angle": 0.785,
    "rotate_to_heading_angular_vel": 1.8,
    "regulated_linear_scaling_min_speed": 0.25,
    "approach_velocity_scaling_dist": 0.6,
    "min_approach_linear_velocity": 0.05,
}
"""Parameters of regulated pure pursuit that mean the same, with Nav2's defaults."""


def read_controller(server: NodeParameters, notes: Notes) -> dict[str, object]:
    """The controller of a scenario, as a choice.

    Raises:
        InputError: If a parameter cannot be used.
    """
    name, plugin = choose_plugin(server, ("controller_plugins",), "FollowPath", DWB, notes)
    block = server.of_plugin(name)
    if plugin == ROTATION_SHIM:
        notes.changed(
            block,
            "plugin",
            "trundle's controllers turn in place by themselves: the primary controller is taken",
        )
        plugin = plain_plugin(block.text("primary_controller", DWB))
    if plugin == RPP:
        return {"name": "regulated_pure_pursuit", "options": read_pursuit(block, notes)}
    if plugin == MPPI:
        return {"name": "mppi", "options": read_mppi(block, notes)}
    known = {DWB: "DWB", GRACEFUL: "the graceful controller"}
    what = f"{known[plugin]} has no counterpart" if plugin in known else f"{plugin} is not known"
    text = f"{what}: regulated_pure_pursuit is used, with its speeds; --controller chooses another"
    notes.default(block, "plugin", plugin, text)
    return {"name": "regulated_pure_pursuit", "options": _read_speeds(block)}


def _read_speeds(block: NodeParameters) -> Options:
    """The top speeds of a controller without counterpart."""
    linear = [name for name in ("max_vel_x", "max_speed_xy", "v_linear_max") if block.has(name)]
    turning = [name for name in ("max_vel_theta", "v_angular_max", "rotate_to_heading_angular_vel") if block.has(name)]
    usual = asdict(PursuitSettings())
    options: Options = {name: usual[name] for name in (*SAME, *_OTHERS)}
    if linear:
        options["desired_linear_vel"] = min(block.number(name, 0.0, least=0.0) for name in linear)
    if turning:
        options["rotate_to_heading_angular_vel"] = min(block.number(name, 0.0, least=0.0) for name in turning)
    return options


def read_pursuit(block: NodeParameters, notes: Notes) -> Options:
    """Options of regulated pure pursuit.

    Raises:
        InputError: If a parameter cannot be used.
    """
    speed = 0.5
    for name in SPEED_NAMES:
        if block.has(name):
            speed = block.number(name, speed, least=0.0)
            break
    options: Options = {"desired_linear_vel": speed}
    values = {name: block.number(name, default, least=0.0) for name, default in SAME.items()}
    options |= values
    lookahead = _read_lookahead(block, speed, values["lookahead_dist"], notes)
    options |= lookahead
    radius = block.number("regulated_linear_scaling_min_radius", 0.9, least=0.0)
    options["regulated_linear_scaling_min_radius"] = _or_off(block, "use_regulated_linear_velocity_scaling", radius)
    near = block.number("cost_scaling_dist", 0.6, least=0.0)
    options["cost_scaling_dist"] = _or_off(block, "use_cost_regulated_linear_velocity_scaling", near)
    if not block.flag("use_rotate_to_heading", True):
        notes.changed(block, "use_rotate_to_heading", "trundle's turns in place at sharp bends all the same")
    if not block.flag("use_collision_detection", True):
        notes.changed(block, "use_collision_detection", "trundle's sends only commands after which it can stop")
    if block.flag("allow_reversing", False):
        notes.changed(block, "allow_reversing", "trundle's drives backwards where the planner's path does")
    return options


def _read_lookahead(block: NodeParameters, speed: float, distance: float, notes: Notes) -> dict[str, float]:
    least = block.number("min_lookahead_dist", 0.3, above=0.0)
    if block.flag("use_velocity_scaled_lookahead_dist", False):
        most = block.number("max_lookahead_dist", 0.9, above=0.0)
        time = block.number("lookahead_time", 1.5, above=0.0)
        distance = round(max(least, min(most, speed * time)), 9)
        notes.changed(
            block,
            "use_velocity_scaled_lookahead_dist",
            f"trundle's lookahead does not grow with the speed: {distance:g} m, that of the top speed",
        )
    elif distance >= least:
        notes.changed(
            block,
            "min_lookahead_dist",
            "in trundle the lookahead along tight curves, and where the usual one is blocked",
        )
    if distance < least:
        notes.default(block, "min_lookahead_dist", least, f"above lookahead_dist: {distance:g} is taken")
        least = distance
    return {"lookahead_dist": distance, "min_lookahead_dist": least}


def _or_off(block: NodeParameters, switch: str, value: float) -> float:
    """A distance, or 0 where it is switched off."""
    return value if block.flag(switch, True) else 0.0
