"""Nav2's MPPI as options of trundle's `mppi`, read and written."""

from __future__ import annotations

from trundle.control.mppi.settings import MOST_STEPS, MppiSettings
from trundle.nav2.draft import NOT_IN_CONTROLLER, Block, Draft
from trundle.nav2.names import MPPI
from trundle.nav2.notes import Notes
from trundle.nav2.parameters import NodeParameters
from trundle.nav2.table import DIGITS, GOAL_ANGLE, MPPI_LIMITS, WEIGHTS, read_rows, write_rows

_VX_MIN, _STEPS, _STEP, _BATCH = -0.35, 56, 0.05, 1000
"""Nav2's defaults of `vx_min`, `time_steps`, `model_dt` and `batch_size`."""

_OBSTACLES = ("CostCritic", "ObstaclesCritic")
"""The two critics of obstacles, of which one is used."""

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
"""The critics of Nav2 where the file does not list any."""

_SAMPLES, _STEP_S, _HORIZON_S, _LEAST_STEPS, _MOST_WEIGHT = (128, 65_536), (0.005, 0.5), (0.2, 20.0), 2, 1e6
"""What `MppiSettings` takes."""

_FOLLOW_WEIGHT = 5.0
"""The `cost_weight` of PathFollowCritic in the parameters that Nav2 ships."""

_STD_SHARE, _TURN_STD_SHARE = 1.0 / 4.0, 0.3
"""Deviations of the samples as shares of the top speeds, as `mppi` has them without movers."""

_EXACT = "Nav2's PathAlignCritic and PathFollowCritic keep the values that Nav2 ships: trundle's mppi has no such costs"


def read_mppi(block: NodeParameters, notes: Notes) -> dict[str, object]:
    """Read the options of `mppi`.

    Raises:
        InputError: If a parameter cannot be used.
    """
    horizon, limits = _read_horizon(block, notes), read_rows(MPPI_LIMITS, block)
    slowest = block.number("vx_min", _VX_MIN)
    if slowest > 0.0:
        notes.changed(block, "vx_min", "trundle's samples may always be slower, down to 0")
    slowing = block.number("ax_min", -limits["ax_max"])
    if abs(slowing) != limits["ax_max"]:
        notes.changed(block, "ax_min", "trundle's samples slow down as they speed up, by ax_max")
    if block.text("motion_model", "DiffDrive") != "DiffDrive":
        notes.changed(block, "motion_model", "trundle drives differential robots: DiffDrive")
    return {**horizon, **limits, "vx_min": min(slowest, 0.0), **_read_weights(block, notes)}


def _read_horizon(block: NodeParameters, notes: Notes) -> dict[str, object]:
    samples = block.integer("batch_size", _BATCH, least=1)
    kept = min(max(samples, _SAMPLES[0]), _SAMPLES[1])
    if kept != samples:
        notes.changed(block, "batch_size", f"trundle takes {_SAMPLES[0]} to {_SAMPLES[1]}: {kept}")
    given = block.number("model_dt", _STEP, above=0.0)
    step = min(max(given, _STEP_S[0]), _STEP_S[1])
    if step != given:
        notes.changed(block, "model_dt", f"trundle takes {_STEP_S[0]:g} to {_STEP_S[1]:g} s: {step:g}")
    steps = block.integer("time_steps", _STEPS, least=1)
    most = min(MOST_STEPS, int(_HORIZON_S[1] / step))
    least = max(_LEAST_STEPS, -int(-_HORIZON_S[0] / step // 1))
    taken = min(max(steps, least), most)
    if taken != steps:
        notes.changed(block, "time_steps", f"with this model_dt trundle takes {least} to {most}: {taken}")
    return {"samples": kept, "model_dt": step, "horizon": round(taken * step, DIGITS)}


def _read_weights(block: NodeParameters, notes: Notes) -> dict[str, object]:
    """Read the weights of the critics that are in use; those of the others are 0."""
    listed = {name.rpartition("::")[2] for name in block.texts("critics", _CRITICS)}
    used = {name for name in listed if block.of_plugin(name).flag("enabled", True)}
    options: dict[str, object] = {}
    for weight in WEIGHTS:
        critic = block.of_plugin(weight.critic)
        if weight.critic not in used:
            if weight.setting not in options and weight.critic not in _OBSTACLES:
                options[weight.setting] = 0.0
            continue
        name = weight.parameter
        if weight.critic == "TwirlingCritic" and critic.has("cost_weight"):
            name = "cost_weight"
        value = weight.to_setting(critic.number(name, weight.usual, least=0.0))
        options[weight.setting] = min(value, _MOST_WEIGHT)
        if value > _MOST_WEIGHT:
            notes.changed(critic, name, f"trundle's weights are at most {_MOST_WEIGHT:g}")
    if not used & set(_OBSTACLES):
        options |= {"repulsion_weight": 0.0, "collision_cost": MppiSettings().collision_cost}
    if "GoalAngleCritic" in used:
        options |= read_rows(GOAL_ANGLE, block.of_plugin("GoalAngleCritic"))
    return _with_goal(block, used, options, notes)


def _with_goal(block: NodeParameters, used: set[str], options: dict[str, object], notes: Notes) -> dict[str, object]:
    """Add the weight of the goal, from either critic of it: without one, samples would have no reason to move."""
    follow = block.of_plugin("PathFollowCritic")
    if "GoalCritic" in used:
        notes.changed(follow, "cost_weight", "in trundle one weight with GoalCritic's, which is taken")
        return options
    if "PathFollowCritic" in used:
        share = follow.number("cost_weight", _FOLLOW_WEIGHT, least=0.0) / _FOLLOW_WEIGHT
        return {**options, "goal_weight": min(round(share, DIGITS), _MOST_WEIGHT)}
    notes.changed(block, "critics", "neither GoalCritic nor PathFollowCritic: trundle's goal_weight stays 1")
    return {**options, "goal_weight": 1.0}


def write_mppi(draft: Draft) -> Block:
    """Write the controller plugin; what the scenario does not give is taken from the robot."""
    options = dict[str, object](draft.scenario.controller.options)
    settings = MppiSettings.model_validate(options)
    limits = settings.limits_of(draft.robot)
    steps = settings.steps_of(draft.robot)
    linear, turning = limits.linear_speed, limits.angular_speed
    backward = linear if limits.reverse_speed is None else limits.reverse_speed
    speeding = settings.ax_max or limits.linear_acceleration
    written = {row.setting for row in (*MPPI_LIMITS, *WEIGHTS, *GOAL_ANGLE)}
    written |= {"samples", "horizon", "model_dt", "vx_min"}
    draft.leave_options("controller", options, written, MppiSettings().model_dump(), NOT_IN_CONTROLLER)
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
    """Write the critics whose counterparts weigh something, and Nav2's own that keep to the path."""
    obstacles = "ObstaclesCritic" if draft.distro == "humble" else "CostCritic"
    blocks: Block = {}
    for weight in WEIGHTS:
        if weight.critic in _OBSTACLES and weight.critic != obstacles:
            continue
        value = float(getattr(settings, weight.setting))
        block = blocks.get(weight.critic)
        if isinstance(block, dict):
            block[weight.parameter] = weight.to_parameter(value)
        elif value > 0.0 or weight.critic in (obstacles, "GoalCritic"):
            # Those two are written without weight too: nothing else keeps from colliding, or leads to the goal.
            blocks[weight.critic] = {"enabled": True, "cost_power": 1, weight.parameter: weight.to_parameter(value)}
    angle = blocks.get("GoalAngleCritic")
    if isinstance(angle, dict):
        angle |= write_rows(GOAL_ANGLE, settings)
    for critic, weight, offset in (("PathAlignCritic", 14.0, 20), ("PathFollowCritic", _FOLLOW_WEIGHT, 5)):
        blocks[critic] = {"enabled": True, "cost_power": 1, "cost_weight": weight, "offset_from_furthest": offset}
    return {"critics": list(blocks), **blocks}
