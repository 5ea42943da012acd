"""The controller server: the controller, the goal checker and the progress checker."""

from __future__ import annotations

import dataclasses

from trundle.control import GoalChecker, ProgressChecker
from trundle.control.mppi.mppi_settings import MppiSettings
from trundle.control.pursuit_settings import PursuitSettings
from trundle.nav2.critics import WEIGHTS, Weight, to_parameter
from trundle.nav2.names import MPPI, POSE_PROGRESS, RPP, SIMPLE_PROGRESS, STOPPED_GOAL
from trundle.nav2.reading.controllers import SAME as PURSUIT_SAME
from trundle.nav2.writing.draft import Block, Draft

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
