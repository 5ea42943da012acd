"""The planner server and the smoother server, read and written."""

from __future__ import annotations

import dataclasses

from trundle.nav2.draft import Block, Draft
from trundle.nav2.names import (
    CONSTRAINED_SMOOTHER,
    NAVFN,
    SIMPLE_SMOOTHER,
    SMAC_2D,
    SMAC_HYBRID,
    SMAC_LATTICE,
    THETA_STAR,
)
from trundle.nav2.notes import Notes, choose_plugin
from trundle.nav2.parameters import NodeParameters
from trundle.nav2.table import SMAC, TURNING_RADIUS, read_rows, write_rows
from trundle.planning.constrained_smoother import SmoothingSettings
from trundle.planning.grid_planners.least_cost import COST_WEIGHT, NEUTRAL_COST
from trundle.planning.hybrid_astar import HybridAStarSettings

Options = dict[str, object]

MOST_EXPANSIONS = 10**8
"""The most expansions of `hybrid_astar` that are read; so many are as good as unlimited."""

HIGHEST_COST = 252.0
"""The cost of a cell beside an obstacle, the highest that is not blocked."""

_TOLERANCE = 0.25
"""Default of `goal_tolerance` of trundle's planners [m]; it stands for Theta*'s, which has no tolerance."""

_MODELS = {"DUBIN": "dubins", "REEDS_SHEPP": "reeds_shepp"}


_NOT_NAV2 = "Nav2's planner has nothing like it"
_GRID_DEFAULTS = {"start_tolerance": 0.05, "max_replans": 20, "spacing": 0.05, "allow_partial": False}
_SMAC_OPTIONS = {*(row.setting for row in SMAC), "motion_model", "smooth", "max_expansions", "in_place"}
"""The options of `hybrid_astar` that both of Smac's planners of poses have."""


def cost_weight_of(multiplier: float) -> float:
    """Return `least_cost`'s weight for Smac 2D's `cost_travel_multiplier` m: a cell of cost 252 is 1 + m free ones."""
    return round(multiplier * NEUTRAL_COST / HIGHEST_COST, 9)


def multiplier_of(neutral: float, cost_weight: float) -> float:
    """Return the `cost_travel_multiplier` for weights of `least_cost`."""
    return round(cost_weight * HIGHEST_COST / neutral, 6)


def read_planner(server: NodeParameters, notes: Notes) -> dict[str, object]:
    """Read the planner of a scenario, as a choice.

    Raises:
        InputError: If a parameter cannot be used.
    """
    name, plugin = choose_plugin(server, ("planner_plugins",), "GridBased", NAVFN, notes)
    block = server.of_plugin(name)
    if plugin == NAVFN:
        options: Options = {"goal_tolerance": block.number("tolerance", 0.5, least=0.0)}
        block.flag("use_astar", False)  # the same path, found sooner
        return {"name": "least_cost", "options": options}
    if plugin == SMAC_2D:
        return _read_smac_2d(block)
    if plugin == SMAC_HYBRID:
        return {"name": "hybrid_astar", "options": _read_hybrid(block, notes)}
    if plugin == SMAC_LATTICE:
        return {"name": "hybrid_astar", "options": _read_lattice(block, notes)}
    if plugin == THETA_STAR:
        return _read_theta_star(block, notes)
    notes.default(
        block, "plugin", plugin, f"{plugin} is not known: the planner auto is used; --planner chooses another"
    )
    return {"name": "auto", "options": {}}


def reads_unknown(server: NodeParameters) -> bool:
    """Return whether the planner may cross unknown cells.

    Raises:
        InputError: If `allow_unknown` is neither true nor false.
    """
    name, _ = choose_plugin(server, ("planner_plugins",), "GridBased", NAVFN, Notes())
    return server.of_plugin(name).flag("allow_unknown", True)


def _read_smac_2d(block: NodeParameters) -> dict[str, object]:
    options: Options = {"goal_tolerance": block.number("tolerance", 0.125, least=0.0)}
    multiplier = block.number("cost_travel_multiplier", 1.0, least=0.0, most=1e3)
    if multiplier == 0.0:
        return {"name": "astar", "options": options}
    weight = cost_weight_of(multiplier)
    return {"name": "least_cost", "options": options if weight == COST_WEIGHT else {**options, "cost_weight": weight}}


def _read_hybrid(block: NodeParameters, notes: Notes) -> Options:
    model = block.text("motion_model_for_search", "DUBIN")
    if model not in _MODELS:
        raise block.wrong("motion_model_for_search", f"must be {' or '.join(_MODELS)} for Hybrid-A*")
    expansions = _read_expansions(block)
    notes.changed(block, "max_iterations", "counted in expansions of trundle's search")
    return {
        "motion_model": _MODELS[model],
        **read_rows((*TURNING_RADIUS, *SMAC), block),
        "smooth": block.flag("smooth_path", True),
        "max_expansions": expansions,
    }


def _read_lattice(block: NodeParameters, notes: Notes) -> Options:
    notes.default(
        block,
        "plugin",
        SMAC_LATTICE,
        "trundle has no lattices from files: hybrid_astar with turns in place is used",
    )
    backwards = block.flag("allow_reverse_expansion", False)
    expansions = _read_expansions(block)
    return {
        "motion_model": "reeds_shepp" if backwards else "dubins",
        "in_place": True,
        **read_rows(SMAC, block),
        "smooth": block.flag("smooth_path", True),
        "max_expansions": expansions,
    }


def _read_expansions(block: NodeParameters) -> int:
    """Read how many expansions a search may have; in Nav2 0 and less mean unlimited."""
    given = block.integer("max_iterations", 1_000_000)
    return given if 0 < given < MOST_EXPANSIONS else MOST_EXPANSIONS


def _read_theta_star(block: NodeParameters, notes: Notes) -> dict[str, object]:
    if block.number("w_traversal_cost", 2.0, least=0.0) == 0.0:
        return {"name": "any_angle", "options": {}}
    notes.default(
        block,
        "w_traversal_cost",
        2.0,
        "Theta* squares the costs: least_cost, which is any-angle too and adds them up, is used with its own weights",
    )
    return {"name": "least_cost", "options": {"goal_tolerance": _TOLERANCE}}


def read_smoother(server: NodeParameters, notes: Notes) -> dict[str, object] | None:
    """Read the smoother of a scenario, as a choice, or None if trundle has no counterpart.

    Raises:
        InputError: If a parameter cannot be used.
    """
    name, plugin = choose_plugin(server, ("smoother_plugins",), "simple_smoother", SIMPLE_SMOOTHER, notes)
    block = server.of_plugin(name)
    if plugin == CONSTRAINED_SMOOTHER:
        return {"name": "constrained", "options": read_rows(TURNING_RADIUS, block)}
    if plugin != SIMPLE_SMOOTHER:
        notes.ignored(block, "plugin", "not known; Nav2's default behavior trees call no smoother")
    return None


def is_plain_cost(options: Options) -> bool:
    """Return whether weights of `least_cost` are NavFn's."""
    return options.get("cost_weight", COST_WEIGHT) == COST_WEIGHT and (
        options.get("neutral_cost", NEUTRAL_COST) == NEUTRAL_COST
    )


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
    draft.leave_options("planner", options, written, _GRID_DEFAULTS, _NOT_NAV2)
    return block


def _write_hybrid(draft: Draft, options: dict[str, object]) -> Block:
    settings = HybridAStarSettings(**options)  # type: ignore[arg-type]
    written, same = set(_SMAC_OPTIONS), write_rows(SMAC, settings)
    block: Block = {
        "plugin": draft.plugin(SMAC_LATTICE if settings.in_place else SMAC_HYBRID),
        "tolerance": same.pop("tolerance"),
        "max_iterations": settings.max_expansions,
        **same,
        "smooth_path": settings.smooth,
    }
    if settings.in_place:
        draft.changed(
            "planner",
            "hybrid_astar",
            "its turns in place and its radius are those of the lattice's file, which Nav2 has",
        )
        block["allow_reverse_expansion"] = settings.motion_model == "reeds_shepp"
    else:
        written.add("minimum_turning_radius")
        names = {model: name for name, model in _MODELS.items()}
        block["motion_model_for_search"] = names[settings.motion_model]
        block |= write_rows(TURNING_RADIUS, settings)
        block["angle_quantization_bins"] = 72
    draft.leave_options("planner", options, written, dataclasses.asdict(HybridAStarSettings()), _NOT_NAV2)
    return block


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
            **write_rows(TURNING_RADIUS, settings),
        },
    }
