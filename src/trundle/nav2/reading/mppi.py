"""Nav2's MPPI as options of trundle's `mppi`."""

from __future__ import annotations

from trundle.control.mppi.mppi_settings import MOST_STEPS, MppiSettings
from trundle.nav2.critics import OBSTACLES, WEIGHTS, to_setting
from trundle.nav2.parameters import NodeParameters
from trundle.nav2.reading.notes import Notes

SAME = {"vx_std": 0.2, "wz_std": 0.4, "vx_max": 0.5, "wz_max": 1.9, "ax_max": 3.0, "az_max": 3.5}
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
    for name, default in SAME.items():
        options[name] = block.number(name, default, above=0.0)
    options["vx_min"] = _read_reverse(block, notes)
    slowing = block.number("ax_min", -block.number("ax_max", SAME["ax_max"]))
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
