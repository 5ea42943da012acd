"""The planner server and the smoother server."""

from __future__ import annotations

import dataclasses

from trundle.nav2.names import (
    CONSTRAINED_SMOOTHER,
    NAVFN,
    SIMPLE_SMOOTHER,
    SMAC_2D,
    SMAC_HYBRID,
    SMAC_LATTICE,
    THETA_STAR,
)
from trundle.nav2.reading.planners import is_plain_cost, multiplier_of
from trundle.nav2.writing.draft import Block, Draft
from trundle.planning.constrained_smoother import SmoothingSettings
from trundle.planning.grid_planners.least_cost import COST_WEIGHT, NEUTRAL_COST
from trundle.planning.hybrid_astar import HybridAStarSettings

_NOT_NAV2 = "Nav2's planner has nothing like it"
_TOLERANCE = 0.25
_GRID = {"start_tolerance": 0.05, "max_replans": 20, "spacing": 0.05, "allow_partial": False}
_MODELS = {"dubins": "DUBIN", "reeds_shepp": "REEDS_SHEPP"}


def write_planners(draft: Draft) -> None:
    """Write the planner server and the smoother server."""
    choice = draft.scenario.planner
    options = dict[str, object](choice.options)
    is_hybrid = choice.name == "hybrid_astar"
    block = _write_hybrid(draft, options) if is_hybrid else _write_grid(draft, choice.name, options)
    block["allow_unknown"] = draft.scenario.unknown != "blocked"
    draft.nodes["planner_server"] = {
        "expected_planner_frequency": 1.0,
        "planner_plugins": ["GridBased"],
        "GridBased": block,
    }
    draft.nodes["smoother_server"] = _write_smoother(draft)


def _write_grid(draft: Draft, name: str, options: dict[str, object]) -> Block:
    tolerance = float(str(options.get("goal_tolerance", _TOLERANCE)))
    written = {"goal_tolerance"}
    if name in ("astar", "manhattan_astar"):
        if name == "manhattan_astar":
            draft.changed("planner", name, "Nav2's A* also moves diagonally")
        block: Block = {"plugin": draft.plugin(SMAC_2D), "tolerance": tolerance, "cost_travel_multiplier": 0.0}
    elif name == "any_angle":
        written = set()
        block = {"plugin": draft.plugin(THETA_STAR), "how_many_corners": 8, "w_euc_cost": 1.0, "w_traversal_cost": 0.0}
    elif name in ("auto", "least_cost") and not is_plain_cost(options):
        neutral = float(str(options.get("neutral_cost", NEUTRAL_COST)))
        weight = float(str(options.get("cost_weight", COST_WEIGHT)))
        written |= {"neutral_cost", "cost_weight"}
        multiplier = multiplier_of(neutral, weight)
        block = {"plugin": draft.plugin(SMAC_2D), "tolerance": tolerance, "cost_travel_multiplier": multiplier}
    else:
        if name not in ("auto", "least_cost"):
            draft.changed("planner", name, "Nav2 has no such planner: NavFn is written")
            options = {f"{name}.{key}": value for key, value in options.items()}
        block = {"plugin": draft.plugin(NAVFN), "tolerance": tolerance, "use_astar": False}
    if name == "auto":
        draft.changed("planner", name, "NavFn has no hybrid A* for where it finds no path")
    draft.leave_options("planner", options, written, _GRID, _NOT_NAV2)
    return block


def _write_hybrid(draft: Draft, options: dict[str, object]) -> Block:
    settings = HybridAStarSettings(**options)  # type: ignore[arg-type]
    written = {
        "motion_model",
        "reverse_penalty",
        "cost_weight",
        "goal_tolerance",
        "smooth",
        "max_expansions",
        "in_place",
    }
    block: Block = {
        "tolerance": float(settings.goal_tolerance),
        "max_iterations": settings.max_expansions,
        "reverse_penalty": float(settings.reverse_penalty),
        "cost_penalty": float(settings.cost_weight),
        "smooth_path": settings.smooth,
    }
    if settings.in_place:
        draft.changed(
            "planner",
            "hybrid_astar",
            "its turns in place and its radius are those of the lattice's file, which Nav2 has",
        )
        block["plugin"] = draft.plugin(SMAC_LATTICE)
        block["allow_reverse_expansion"] = settings.motion_model == "reeds_shepp"
    else:
        written.add("minimum_turning_radius")
        block["plugin"] = draft.plugin(SMAC_HYBRID)
        block["motion_model_for_search"] = _MODELS[settings.motion_model]
        block["minimum_turning_radius"] = float(settings.minimum_turning_radius)
        block["angle_quantization_bins"] = 72
    draft.leave_options("planner", options, written, dataclasses.asdict(HybridAStarSettings()), _NOT_NAV2)
    return {"plugin": block.pop("plugin"), **block}


def _write_smoother(draft: Draft) -> Block:
    choice = draft.scenario.smoother
    if choice is None or choice.name != "constrained":
        if choice is not None:
            draft.left_out("smoother", choice.name, "Nav2 has no such smoother")
        return {
            "smoother_plugins": ["simple_smoother"],
            "simple_smoother": {"plugin": SIMPLE_SMOOTHER, "tolerance": 1.0e-10, "max_its": 1000},
        }
    settings = SmoothingSettings(**choice.options)  # type: ignore[arg-type]
    draft.changed("smoother", "constrained", "Nav2 smooths only where its behavior tree calls SmoothPath")
    defaults = dataclasses.asdict(SmoothingSettings())
    draft.leave_options(
        "smoother", choice.options, {"minimum_turning_radius"}, defaults, "Nav2's weights are of other units"
    )
    return {
        "smoother_plugins": ["constrained_smoother"],
        "constrained_smoother": {
            "plugin": draft.plugin(CONSTRAINED_SMOOTHER),
            "minimum_turning_radius": float(settings.minimum_turning_radius),
        },
    }
