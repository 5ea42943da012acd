"""The controller server: regulated pure pursuit and MPPI, read and written; of other controllers the speeds."""

from __future__ import annotations

import dataclasses
from dataclasses import asdict

from trundle.control import GoalChecker, ProgressChecker
from trundle.control.mppi.settings import MOST_STEPS, MppiSettings
from trundle.control.pursuit_settings import PursuitSettings
from trundle.nav2.draft import Block, Draft
from trundle.nav2.names import (
    DWB,
    GRACEFUL,
    MPPI,
    POSE_PROGRESS,
    ROTATION_SHIM,
    RPP,
    SIMPLE_PROGRESS,
    STOPPED_GOAL,
    plain_plugin,
)
from trundle.nav2.notes import Notes, choose_plugin
from trundle.nav2.parameters import NodeParameters
from trundle.nav2.table import OBSTACLES, WEIGHTS, Weight, to_parameter, to_setting

Options = dict[str, object]

_OTHERS = ("min_lookahead_dist", "regulated_linear_scaling_min_radius", "cost_scaling_dist")

SPEED_NAMES = ("max_linear_vel", "desired_linear_vel")
"""Of regulated pure pursuit's speed: Lyrical's name, and the one before."""

PURSUIT_SAME = {
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
    options: Options = {name: usual[name] for name in (*PURSUIT_SAME, *_OTHERS)}
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
    values = {name: block.number(name, default, least=0.0) for name, default in PURSUIT_SAME.items()}
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


MPPI_SAME = {"vx_std": 0.2, "wz_std": 0.4, "vx_max": 0.5, "wz_max": 1.9, "ax_max": 3.0, "az_max": 3.5}
"""Parameters that mean the same, with Nav2's defaults."""

VX_MIN = -0.35
STEPS, STEP_S, BATCH = 56, 0.05, 1000

_CRITICS = (
    "ConstraintCritic",
    "CostCritic",
    "GoalCritic",
    "GoalAngleCritic",
    "PathAlignCritic",
    "PathFollowCritic",
    "PathAngleCritic",
    "PreferForwardCritic",
)
"""Those of Nav2 where the file lists none."""

_SAMPLES = (128, 65_536)
_STEP_S = (0.005, 0.5)
_HORIZON_S = (0.2, 20.0)
_LEAST_STEPS = 2
_MOST_WEIGHT = 1e6


def read_mppi(block: NodeParameters, notes: Notes) -> dict[str, object]:
    """Options of `mppi`.

    Raises:
        InputError: If a parameter cannot be used.
    """
    options: dict[str, object] = {**_read_horizon(block, notes)}
    for name, default in MPPI_SAME.items():
        options[name] = block.number(name, default, above=0.0)
    options["vx_min"] = _read_reverse(block, notes)
    slowing = block.number("ax_min", -block.number("ax_max", MPPI_SAME["ax_max"]))
    if abs(slowing) != options["ax_max"]:
        notes.changed(block, "ax_min", "trundle's samples slow down as they speed up, by ax_max")
    if block.text("motion_model", "DiffDrive") != "DiffDrive":
        notes.changed(block, "motion_model", "trundle drives differential robots: DiffDrive")
    return {**options, **_read_weights(block, notes)}


def _read_horizon(block: NodeParameters, notes: Notes) -> dict[str, object]:
    samples = block.integer("batch_size", BATCH, least=1)
    kept = min(max(samples, _SAMPLES[0]), _SAMPLES[1])
    if kept != samples:
        notes.changed(block, "batch_size", f"trundle takes {_SAMPLES[0]} to {_SAMPLES[1]}: {kept}")
    given = block.number("model_dt", STEP_S, above=0.0)
    step = min(max(given, _STEP_S[0]), _STEP_S[1])
    if step != given:
        notes.changed(block, "model_dt", f"trundle takes {_STEP_S[0]:g} to {_STEP_S[1]:g} s: {step:g}")
    steps = block.integer("time_steps", STEPS, least=1)
    most = min(MOST_STEPS, int(_HORIZON_S[1] / step))
    least = max(_LEAST_STEPS, -int(-_HORIZON_S[0] / step // 1))
    taken = min(max(steps, least), most)
    if taken != steps:
        notes.changed(block, "time_steps", f"with this model_dt trundle takes {least} to {most}: {taken}")
    return {"samples": kept, "model_dt": step, "horizon": round(taken * step, 9)}


def _read_reverse(block: NodeParameters, notes: Notes) -> float:
    slowest = block.number("vx_min", VX_MIN)
    if slowest > 0.0:
        notes.changed(block, "vx_min", "trundle's samples may always be slower, down to 0")
    return min(slowest, 0.0)


def _read_weights(block: NodeParameters, notes: Notes) -> dict[str, object]:
    """Weights of the critics that are in use; 0 for those that are not."""
    listed = {name.rpartition("::")[2] for name in block.texts("critics", _CRITICS)}
    used = {name for name in listed if block.of_plugin(name).flag("enabled", True)}
    options: dict[str, object] = {}
    for weight in WEIGHTS:
        critic = block.of_plugin(weight.critic)
        if weight.critic not in used:
            if weight.setting not in options and weight.critic not in OBSTACLES:
                options[weight.setting] = 0.0
            continue
        name = weight.parameter
        if weight.critic == "TwirlingCritic" and critic.has("cost_weight"):
            name = "cost_weight"
        value = to_setting(weight, critic.number(name, weight.usual, least=0.0))
        options[weight.setting] = min(value, _MOST_WEIGHT)
        if value > _MOST_WEIGHT:
            notes.changed(critic, name, f"trundle's weights are at most {_MOST_WEIGHT:g}")
    if not used & set(OBSTACLES):
        options |= {"repulsion_weight": 0.0, "collision_cost": MppiSettings().collision_cost}
    if "GoalAngleCritic" in used:
        near = block.of_plugin("GoalAngleCritic").number("threshold_to_consider", 0.5, above=0.0)
        options["threshold_to_consider"] = near
    return _with_goal(block, used, options, notes)


def _with_goal(block: NodeParameters, used: set[str], options: dict[str, object], notes: Notes) -> dict[str, object]:
    """The weight of the goal from either critic of it: without one, samples would have no reason to move."""
    follow = block.of_plugin("PathFollowCritic")
    if "GoalCritic" in used:
        notes.changed(follow, "cost_weight", "in trundle one weight with GoalCritic's, which is taken")
        return options
    if "PathFollowCritic" in used:
        share = follow.number("cost_weight", 5.0, least=0.0) / 5.0
        return {**options, "goal_weight": min(round(share, 9), _MOST_WEIGHT)}
    notes.changed(block, "critics", "neither GoalCritic nor PathFollowCritic: trundle's goal_weight stays 1")
    return {**options, "goal_weight": 1.0}


_NOT_NAV2 = "Nav2's controller has nothing like it"
_STD_SHARE, _TURN_STD_SHARE = 1.0 / 4.0, 0.3  # of the top speeds, as `mppi` without movers
_EXACT = "Nav2's PathAlignCritic and PathFollowCritic keep the values that Nav2 ships: trundle's mppi has no such costs"


def write_controllers(draft: Draft) -> None:
    """Write the controller server."""
    scenario = draft.scenario
    progress, goal = ProgressChecker(), GoalChecker()
    checker: Block = {
        "plugin": SIMPLE_PROGRESS if draft.distro == "humble" else POSE_PROGRESS,
        "required_movement_radius": float(scenario.required_movement_radius),
        "movement_time_allowance": float(scenario.movement_time_allowance),
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
            "xy_goal_tolerance": float(scenario.goal_tolerance),
            "yaw_goal_tolerance": float(scenario.goal_yaw_tolerance),
            "trans_stopped_velocity": goal.stopped_linear,
            "rot_stopped_velocity": goal.stopped_angular,
        },
        "FollowPath": _write_mppi(draft) if scenario.controller.name == "mppi" else _write_pursuit(draft),
    }


def _write_pursuit(draft: Draft) -> Block:
    """Regulated pure pursuit, also in place of controllers that Nav2 does not have."""
    choice, limits = draft.scenario.controller, draft.robot.limits
    options = dict[str, object](choice.options)
    if choice.name != "regulated_pure_pursuit":
        draft.changed("controller", choice.name, "Nav2 has no such controller: regulated pure pursuit is written")
        draft.leave_options("controller", options, set(), {}, _NOT_NAV2)
        options = {}
    settings = PursuitSettings(**options)  # type: ignore[arg-type]
    speed = limits.linear_speed if settings.desired_linear_vel is None else settings.desired_linear_vel
    defaults = dataclasses.asdict(PursuitSettings())
    written = {*PURSUIT_SAME, "desired_linear_vel", "min_lookahead_dist"}
    written |= {"regulated_linear_scaling_min_radius", "cost_scaling_dist"}
    draft.leave_options("controller", options, written, defaults, _NOT_NAV2)
    near, radius = settings.cost_scaling_dist, settings.regulated_linear_scaling_min_radius
    return {
        "plugin": RPP,
        "max_linear_vel" if draft.distro == "lyrical" else "desired_linear_vel": float(speed),
        **{name: float(getattr(settings, name)) for name in PURSUIT_SAME},
        "min_lookahead_dist": float(settings.min_lookahead_dist),
        "use_velocity_scaled_lookahead_dist": False,
        "use_regulated_linear_velocity_scaling": radius > 0.0,
        "regulated_linear_scaling_min_radius": float(radius) if radius > 0.0 else 0.9,
        "use_cost_regulated_linear_velocity_scaling": near > 0.0,
        "cost_scaling_dist": float(near) if near > 0.0 else 0.6,
        "inflation_cost_scaling_factor": float(draft.scenario.cost_scaling_factor) or 3.0,
        "use_rotate_to_heading": True,
        "use_collision_detection": True,
        "max_angular_accel": float(limits.angular_acceleration),
        "allow_reversing": False,
        "transform_tolerance": 0.1,
    }


def _write_mppi(draft: Draft) -> Block:
    options = dict[str, object](draft.scenario.controller.options)
    settings = MppiSettings.model_validate(options)
    limits = settings.limits_of(draft.robot)
    steps = settings.steps_of(draft.robot)
    linear, turning = limits.linear_speed, limits.angular_speed
    backward = linear if limits.reverse_speed is None else limits.reverse_speed
    speeding = settings.ax_max or limits.linear_acceleration
    weights = {weight.setting for weight in WEIGHTS} | {"threshold_to_consider"}
    same = {"samples", "horizon", "model_dt", "vx_std", "wz_std", "vx_max", "vx_min", "wz_max", "ax_max", "az_max"}
    draft.leave_options("controller", options, weights | same, MppiSettings().model_dump(), _NOT_NAV2)
    draft.changed("controller", "mppi", _EXACT)
    return {
        "plugin": MPPI,
        "time_steps": steps,
        "model_dt": float(settings.model_dt),
        "batch_size": settings.samples,
        "vx_std": float(settings.vx_std or round(linear * _STD_SHARE, 6)),
        "vy_std": 0.0,
        "wz_std": float(settings.wz_std or round(turning * _TURN_STD_SHARE, 6)),
        "vx_max": float(settings.vx_max or linear),
        "vx_min": float(-backward if settings.vx_min is None else settings.vx_min),
        "vy_max": 0.0,
        "wz_max": float(settings.wz_max or turning),
        "ax_max": float(speeding),
        "ax_min": -float(speeding),
        "ay_max": 0.0,
        "az_max": float(settings.az_max or limits.angular_acceleration),
        "iteration_count": 1,
        "prune_distance": 1.7,
        "transform_tolerance": 0.1,
        "temperature": 0.3,
        "gamma": 0.015,
        "motion_model": "DiffDrive",
        **_write_critics(draft, settings),
    }


def _write_critics(draft: Draft, settings: MppiSettings) -> Block:
    """The critics whose counterparts weigh something, and Nav2's own that keep to the path."""
    obstacles = "ObstaclesCritic" if draft.distro == "humble" else "CostCritic"
    blocks: Block = {}
    for weight in WEIGHTS:
        if weight.critic in ("CostCritic", "ObstaclesCritic") and weight.critic != obstacles:
            continue
        value = float(getattr(settings, weight.setting))
        block = blocks.get(weight.critic)
        if isinstance(block, dict):
            block[weight.parameter] = to_parameter(weight, value)
        elif value > 0.0 or _is_always_on(weight, obstacles):
            blocks[weight.critic] = {"enabled": True, "cost_power": 1, weight.parameter: to_parameter(weight, value)}
    angle = blocks.get("GoalAngleCritic")
    if isinstance(angle, dict):
        angle["threshold_to_consider"] = float(settings.threshold_to_consider)
    blocks["PathAlignCritic"] = {"enabled": True, "cost_power": 1, "cost_weight": 14.0, "offset_from_furthest": 20}
    blocks["PathFollowCritic"] = {"enabled": True, "cost_power": 1, "cost_weight": 5.0, "offset_from_furthest": 5}
    return {"critics": list(blocks), **blocks}


def _is_always_on(weight: Weight, obstacles: str) -> bool:
    """Whether a critic is written without weight too: nothing else keeps it from colliding, or leads it to the goal."""
    return weight.critic in (obstacles, "GoalCritic")
