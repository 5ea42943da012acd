"""The controller server, read and written: checkers, regulated pure pursuit, and of other controllers the speeds."""

from __future__ import annotations

import math
from dataclasses import asdict

from trundle.control import GoalChecker, ProgressChecker
from trundle.control.pursuit_settings import PursuitSettings
from trundle.nav2.draft import NOT_IN_CONTROLLER, Block, Draft
from trundle.nav2.mppi import read_mppi, write_mppi
from trundle.nav2.names import (
    DWB,
    GRACEFUL,
    MPPI,
    POSE_PROGRESS,
    POSITION_GOAL,
    ROTATION_SHIM,
    RPP,
    SIMPLE_GOAL,
    SIMPLE_PROGRESS,
    STOPPED_GOAL,
    plain_plugin,
)
from trundle.nav2.notes import Notes, choose_plugin
from trundle.nav2.parameters import NodeParameters
from trundle.nav2.table import (
    GOAL,
    PROGRESS,
    PURSUIT,
    PURSUIT_SWITCHED,
    read_rows,
    read_switched,
    write_rows,
    write_switched,
)

Options = dict[str, object]

_OPTIONS = (
    *(row.setting for row in PURSUIT),
    "min_lookahead_dist",
    *(row.parameter for row in PURSUIT_SWITCHED),
)
"""The options of regulated pure pursuit that Nav2 has, besides its speed."""

SPEED_NAMES = ("max_linear_vel", "desired_linear_vel")
"""Names of regulated pure pursuit's speed: Lyrical's, and the one before."""

_FREQUENCIES = (0.1, 1000.0)
"""The control frequencies that a scenario may have [Hz]."""

_TURNING_RAD = 0.5
"""Nav2's default of `required_movement_angle`."""


def read_controller(server: NodeParameters, notes: Notes) -> dict[str, object]:
    """Read the controller of a scenario, as a choice.

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
    what = known.get(plugin, f"{plugin}, which is not known,")
    text = f"{what} is replaced by regulated_pure_pursuit with its speeds; --controller chooses another"
    notes.default(block, "plugin", plugin, text)
    return {"name": "regulated_pure_pursuit", "options": _read_speeds(block)}


def _read_speeds(block: NodeParameters) -> Options:
    """Read the top speeds of a controller without counterpart."""
    linear = [name for name in ("max_vel_x", "max_speed_xy", "v_linear_max") if block.has(name)]
    turning = [name for name in ("max_vel_theta", "v_angular_max", "rotate_to_heading_angular_vel") if block.has(name)]
    usual = asdict(PursuitSettings())
    options: Options = {name: usual[name] for name in _OPTIONS}
    if linear:
        options["desired_linear_vel"] = min(block.number(name, 0.0, least=0.0) for name in linear)
    if turning:
        options["rotate_to_heading_angular_vel"] = min(block.number(name, 0.0, least=0.0) for name in turning)
    return options


def read_pursuit(block: NodeParameters, notes: Notes) -> Options:
    """Read the options of regulated pure pursuit.

    Raises:
        InputError: If a parameter cannot be used.
    """
    speed = 0.5
    for name in SPEED_NAMES:
        if block.has(name):
            speed = block.number(name, speed, least=0.0)
            break
    values = read_rows(PURSUIT, block)
    options: Options = {
        "desired_linear_vel": speed,
        **values,
        **_read_lookahead(block, speed, values["lookahead_dist"], notes),
        **read_switched(PURSUIT_SWITCHED, block),
    }
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


def read_checkers(server: NodeParameters, notes: Notes) -> dict[str, object]:
    """Read the settings of the goal checker, the progress checker and the control frequency.

    Raises:
        InputError: If a parameter cannot be used.
    """
    given = server.number("controller_frequency", 20.0, above=0.0)
    frequency = min(max(given, _FREQUENCIES[0]), _FREQUENCIES[1])
    if frequency != given:
        notes.changed(server, "controller_frequency", f"trundle takes {_FREQUENCIES[0]:g} to {_FREQUENCIES[1]:g} Hz")
    return {"control_frequency": frequency, **_read_progress(server, notes), **_read_goal(server, notes)}


def _read_progress(server: NodeParameters, notes: Notes) -> dict[str, object]:
    lists = ("progress_checker_plugins", "progress_checker_plugin")
    name, plugin = choose_plugin(server, lists, "progress_checker", SIMPLE_PROGRESS, notes)
    block = server.of_plugin(name)
    usual = ProgressChecker().required_movement_angle
    if plugin == POSE_PROGRESS:
        if block.number("required_movement_angle", _TURNING_RAD, least=0.0) != usual:
            notes.changed(block, "required_movement_angle", f"in trundle a turn by {usual:g} rad is progress")
    elif plugin == SIMPLE_PROGRESS:
        notes.changed(block, "plugin", f"in trundle a turn by {usual:g} rad is progress too")
    else:
        notes.changed(block, "plugin", "not known: its radius and its time are taken")
    return dict[str, object](read_rows(PROGRESS, block))


def _read_goal(server: NodeParameters, notes: Notes) -> dict[str, object]:
    name, plugin = choose_plugin(server, ("goal_checker_plugins",), "general_goal_checker", SIMPLE_GOAL, notes)
    block = server.of_plugin(name)
    tolerances = read_rows(GOAL, block)
    tolerances["goal_yaw_tolerance"] = min(tolerances["goal_yaw_tolerance"], math.pi)
    usual = GoalChecker()
    if plugin == POSITION_GOAL:
        tolerances["goal_yaw_tolerance"] = math.pi
    elif plugin == STOPPED_GOAL:
        stopped = {"trans_stopped_velocity": usual.stopped_linear, "rot_stopped_velocity": usual.stopped_angular}
        for key, value in stopped.items():
            if block.number(key, 0.25, least=0.0) != value:
                notes.changed(block, key, f"in trundle the robot stands at {value:g} or less")
    elif plugin == SIMPLE_GOAL:
        notes.changed(block, "plugin", "in trundle the robot must stand at the goal, as for StoppedGoalChecker")
    else:
        notes.changed(block, "plugin", "not known: its tolerances are taken")
    return dict[str, object](tolerances)


def write_controllers(draft: Draft) -> None:
    """Write the controller server."""
    scenario = draft.scenario
    progress, goal = ProgressChecker(), GoalChecker()
    checker: Block = {
        "plugin": SIMPLE_PROGRESS if draft.distro == "humble" else POSE_PROGRESS,
        **write_rows(PROGRESS, scenario),
    }
    if draft.distro == "humble":
        plugins: Block = {"progress_checker_plugin": "progress_checker"}
    else:
        plugins = {"progress_checker_plugins": ["progress_checker"]}
        checker["required_movement_angle"] = progress.required_movement_angle
    draft.nodes["controller_server"] = {
        "controller_frequency": float(scenario.control_frequency),
        "min_x_velocity_threshold": 0.001,
        "min_y_velocity_threshold": 0.5,
        "min_theta_velocity_threshold": 0.001,
        "failure_tolerance": 0.3,
        **plugins,
        "goal_checker_plugins": ["general_goal_checker"],
        "controller_plugins": ["FollowPath"],
        "progress_checker": checker,
        "general_goal_checker": {
            "plugin": STOPPED_GOAL,
            "stateful": True,
            **write_rows(GOAL, scenario),
            "trans_stopped_velocity": goal.stopped_linear,
            "rot_stopped_velocity": goal.stopped_angular,
        },
        "FollowPath": write_mppi(draft) if scenario.controller.name == "mppi" else _write_pursuit(draft),
    }


def _write_pursuit(draft: Draft) -> Block:
    """Write regulated pure pursuit, also in place of controllers that Nav2 does not have."""
    choice, limits = draft.scenario.controller, draft.robot.limits
    options = dict[str, object](choice.options)
    if choice.name != "regulated_pure_pursuit":
        draft.changed("controller", choice.name, "Nav2 has no such controller: regulated pure pursuit is written")
        draft.leave_options("controller", options, set(), {}, NOT_IN_CONTROLLER)
        options = {}
    settings = PursuitSettings(**options)  # type: ignore[arg-type]
    speed = limits.linear_speed if settings.desired_linear_vel is None else settings.desired_linear_vel
    defaults = asdict(PursuitSettings())
    draft.leave_options("controller", options, {*_OPTIONS, "desired_linear_vel"}, defaults, NOT_IN_CONTROLLER)
    return {
        "plugin": RPP,
        "max_linear_vel" if draft.distro == "lyrical" else "desired_linear_vel": float(speed),
        **write_rows(PURSUIT, settings),
        "min_lookahead_dist": float(settings.min_lookahead_dist),
        "use_velocity_scaled_lookahead_dist": False,
        **write_switched(PURSUIT_SWITCHED, settings),
        "inflation_cost_scaling_factor": float(draft.scenario.cost_scaling_factor) or 3.0,
        "use_rotate_to_heading": True,
        "use_collision_detection": True,
        "max_angular_accel": float(limits.angular_acceleration),
        "allow_reversing": False,
        "transform_tolerance": 0.1,
    }
