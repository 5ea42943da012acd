"""`EpisodeTask`: one episode of a suite, from its number to its row."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from trundle.control.controller import CONTROLLERS
from trundle.errors import InputError, PlanningError
from trundle.evaluation.episode.places import KeptPlace, Places
from trundle.evaluation.public.reference import load_reference
from trundle.evaluation.row import Row, simplify
from trundle.evaluation.suite import EpisodeSpec, Suite
from trundle.evaluation.suite.identity import digest, mission_hash, short
from trundle.evaluation.suite.vary import move_start
from trundle.files.choice import Choice
from trundle.geometry import Goal, Pose2D
from trundle.localization.localizer import LOCALIZERS
from trundle.maps import OccupancyGrid
from trundle.mission import Episode, Outcome, Scenario, sample_mission, sample_tight_ends
from trundle.mission.batch.missions import BatchMission, HandedOver
from trundle.mission.batch.needs import BATCH, needs_python
from trundle.mission.goal_fields import exact_goals, make_goal
from trundle.mission.loop import run
from trundle.mission.metrics import Truth, measure_truth
from trundle.mission.scenario import PLUGINS
from trundle.mission.setup import session_options
from trundle.navigation.agents import AGENTS
from trundle.navigation.behaviors import describe_behaviors
from trundle.planning.planner import PLANNERS
from trundle.planning.smoother import SMOOTHERS
from trundle.registry import Registry
from trundle.sim.simulator import SIMULATORS
from trundle.worlds.world import WORLDS

_MAP_MODULES = ("trundle.maps.ros_reader", "PIL.PngImagePlugin")

Note = Callable[[Mapping[str, Any]], None]
"""Takes what is known of an episode so far, so that something is known of one that does not end."""


def _ignore(_: Mapping[str, Any]) -> None:
    pass


@dataclass(frozen=True, slots=True, eq=False)
class _Mission:
    """An episode whose start and goal are known; `start` is where the robot really stands."""

    scenario: Scenario
    kept: KeptPlace
    start: Pose2D
    goals: tuple[Goal, ...]
    hash: str


@dataclass(slots=True, eq=False)
class _Measured:
    """Measures a run on the maps of its place, and keeps what it found."""

    kept: KeptPlace
    truth: Truth | None = field(default=None)

    def __call__(self, *arguments: Any, **named: Any) -> Truth:
        self.truth = measure_truth(*arguments, **named, true_maps=self.kept.true_maps)
        return self.truth


class EpisodeTask:
    """Runs episodes of a suite by number. What it keeps from one to the next changes nothing in a row.

    It can be pickled, for worker processes: by cloudpickle where the suite has Python objects of a notebook.

    Args:
        suite: The suite.

    Attributes:
        suite: The same.
    """

    def __init__(self, suite: Suite) -> None:
        self.suite = suite
        self._places = Places()

    def __getstate__(self) -> dict[str, Any]:
        return {"suite": self.suite}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.suite = state["suite"]
        self._places = Places()

    @property
    def modules(self) -> tuple[str, ...]:
        """Modules that its episodes need, for a process that worker processes are forked from."""
        suite = self.suite
        plugins: list[tuple[Registry[Any], Sequence[Choice | None]]] = [
            (PLANNERS, suite.planners),
            (CONTROLLERS, suite.controllers),
            (SMOOTHERS, suite.smoothers),
            (AGENTS, suite.agents),
            (LOCALIZERS, suite.crossed().get("localizer", ())),
        ]
        chosen = [
            *(
                registry.module_of(choice.name)
                for registry, choices in plugins
                for choice in choices
                if choice is not None and not choice.is_python
            ),
            *(SIMULATORS.module_of(backend.name) for backend in suite.backends),
            *(WORLDS.module_of(world.name) for world in suite.worlds if not world.is_file),
            *(_MAP_MODULES if any(world.is_map for world in suite.worlds) else ()),
        ]
        return tuple(dict.fromkeys(["numpy.random", __name__, *(module for module in chosen if module is not None)]))

    def setup(self) -> None:
        """Prepare a worker process; places are made when an episode needs them."""

    def __call__(self, index: int, note: Note = _ignore) -> Row:
        """Run one episode.

        Args:
            index: Its number.
            note: Takes the stage ("setup" with the part that is being made, then "drive") and the columns of the row
                that are known.

        Raises:
            InputError: If it cannot be prepared: no world, no start, an option that cannot be used.
        """
        wall, cpu = clock.perf_counter(), clock.process_time()
        spec = self.suite.spec(index)
        known = facts_of(spec)
        note({"stage": "setup", "part": parts_of(spec)[0], "row": known})
        mission = self._find_mission(spec)
        known |= _ends(mission)
        episode, truth = self._drive(spec, mission, known, note)
        result = _no_episode(known, episode) if isinstance(episode, PlanningError) else _result(episode, truth)
        result |= _score(spec, mission, result)
        times = {"wall_s": clock.perf_counter() - wall, "cpu_s": clock.process_time() - cpu}
        return Row(**{**known, **result, **times})

    def scenario_of(self, index: int) -> Scenario:
        """Return the exact scenario of an episode, with its start and goal: it drives the same when it is run alone.

        Raises:
            InputError: If it cannot be prepared, or it was driven by a Python object, which a scenario cannot name.
        """
        spec = self.suite.spec(index)
        for role in PLUGINS:
            choice: Choice | None = getattr(spec.scenario, role)
            if choice is not None and choice.is_python:
                raise InputError(
                    f"the {role} of episode {spec.id} was the Python object {choice.short_name!r}, which a scenario "
                    "cannot name: run it again in Python, with EpisodeTask(suite)(index)"
                )
        return self._find_mission(spec).scenario

    def grid_of(self, index: int) -> OccupancyGrid:
        """Return the map of the place of an episode.

        Raises:
            InputError: If it cannot be made.
        """
        return self._place(self.suite.spec(index)).place.grid

    # Parts of an episode --------------------------------------------------------------------------------------------

    def _place(self, spec: EpisodeSpec) -> KeptPlace:
        return self._places.get(spec.scenario)

    def _find_mission(self, spec: EpisodeSpec) -> _Mission:
        kept, scenario = self._place(spec), spec.scenario
        if spec.listed is None:
            costmap = kept.sampling_costmap()
            if spec.missions.ends == "tight":
                start, goal = sample_tight_ends(costmap, spec.seed)
            else:
                start, goal = sample_mission(costmap, spec.seed, min_distance=spec.missions.min_distance)
            goals = (Goal.of(goal),)
        else:
            start = Pose2D.of(spec.listed.start)
            goals = tuple(make_goal(goal) for goal in spec.listed.goals or (spec.listed.goal or (),))
        stands = move_start(start, spec.vary)
        # A scenario with a start would look for the floor there.
        is_file = scenario.world is not None and scenario.world.is_file
        exact = scenario.model_copy(
            update={
                "floor_z": kept.place.floor_z if is_file else scenario.floor_z,
                "start": stands.as_tuple(),
                **exact_goals(goals, None if spec.listed is None else spec.listed.goals),
                "through": bool(spec.listed is not None and spec.listed.through),
            }
        )
        return _Mission(exact, kept, stands, goals, mission_hash(spec.content, start, goals, spec.seed))

    def _drive(
        self, spec: EpisodeSpec, mission: _Mission, known: dict[str, Any], note: Note
    ) -> tuple[Episode | PlanningError, Truth | None]:
        scenario, kept = mission.scenario, mission.kept
        _, navigation, simulation = parts_of(spec)
        note({"stage": "setup", "part": navigation, "row": known})
        setting = kept.prepare(scenario)
        measure = _Measured(kept)
        if scenario.backend.name == BATCH:
            note({"stage": "drive", "row": known})
            needs = ", ".join(needs_python(scenario))
            driven = HandedOver(needs) if needs else kept.batch.drive([BatchMission(setting, measure)])[0]
            if not isinstance(driven, HandedOver):
                return driven, measure.truth
            known["handed_over"] = driven.reason
        note({"stage": "setup", "part": simulation, "row": known})
        sim = kept.simulator(scenario, setting.world)
        note({"stage": "drive", "row": known})
        try:
            episode = run(
                sim,
                setting.agent,
                mission.start,
                mission.goals,
                time_limit_s=scenario.time_limit_s,
                seed=scenario.seed,
                name=scenario.title,
                measure=measure,
                **session_options(scenario, setting.grid, setting.navigator.robot),
            )
        except PlanningError as error:  # the robot cannot stand at an end of the mission
            return error, None
        finally:
            kept.release(sim)
        return episode, measure.truth


def parts_of(spec: EpisodeSpec) -> tuple[str, str, str]:
    """Name what is set up for an episode: its place, planner and controller there, and simulator there.

    A part that cannot be set up for one episode cannot be for another that needs the same.
    """
    choice = spec.scenario.world
    seeded = choice is not None and not choice.is_file and choice.seed is None
    place = f"world {spec.world}, robot {spec.robot}" + (f", seed {spec.seed}" if seeded else "")
    return (
        place,
        f"planner {spec.planner}, controller {spec.controller}, settings {spec.settings!r} in {place}",
        f"backend {spec.backend} in {place}",
    )


def facts_of(spec: EpisodeSpec) -> dict[str, Any]:
    """Return columns that are known before anything is made; the mission's hash is empty."""
    return {
        "id": spec.id,
        "mission": "",
        "index": spec.index,
        "world": spec.world,
        "robot": spec.robot,
        "planner": spec.planner,
        "controller": spec.controller,
        "agent": spec.agent,
        "backend": spec.backend,
        "seed": spec.seed,
        "settings": spec.settings,
        "vary": dict(spec.vary) or None,
        "place": short([digest([*spec.content, spec.scenario.resolution])])[:8],
        **({} if spec.reference is None else {"barn_score": 0.0}),
    }


def _ends(mission: _Mission) -> dict[str, Any]:
    """Return columns of the mission."""
    goal = mission.goals[-1]
    return {
        "mission": mission.hash,
        **dict(zip(("start_x", "start_y", "start_yaw"), mission.start.as_tuple(), strict=True)),
        "goal_x": goal[0],
        "goal_y": goal[1],
        "goal_yaw": None if goal.yaw_free else goal[2],
    }


def _no_episode(known: Mapping[str, Any], error: PlanningError) -> dict[str, Any]:
    """Return columns of an episode that ended before it began."""
    return {
        "outcome": Outcome.NO_PATH.value,
        "message": str(error),
        "complete": error.complete,
        "time_s": 0.0,
        "distance_m": 0.0,
        "contacts": 0,
        "standing_contacts": 0,
        "unseen_contacts": 0,
        "replans": 0,
        **{f"end_{axis}": known[f"start_{axis}"] for axis in ("x", "y", "yaw")},
    }


def _score(spec: EpisodeSpec, mission: _Mission, result: Mapping[str, Any]) -> dict[str, Any]:
    """Return columns of a world with a reference path."""
    if spec.reference is None:
        return {}
    scenario, robot = mission.scenario, mission.kept.place.robot
    path = load_reference(spec.reference).between(mission.start, mission.goals[-1])
    radius = None if scenario.rules is None else scenario.rules.arrival_radius
    arrived = result["outcome"] == Outcome.ARRIVED.value
    return {
        "barn_score": path.score(result["time_s"]) if arrived else 0.0,
        "reference_path_m": path.length,
        "shortest_time_s": path.shortest_time(robot.limits, scenario.goal_tolerance if radius is None else radius),
    }


def _result(episode: Episode, truth: Truth | None) -> dict[str, Any]:
    """Return columns of an episode that was driven."""
    metrics, trajectory = episode.metrics, episode.trajectory
    end = dict(zip(("end_x", "end_y", "end_yaw"), trajectory.poses[-1].tolist(), strict=True))
    closest = {}
    if truth is not None and truth.closest is not None:
        at = truth.closest
        closest = {"closest_x": float(trajectory.x[at]), "closest_y": float(trajectory.y[at])}
    return {
        "outcome": episode.outcome.value,
        "message": episode.message,
        "complete": episode.complete,
        "time_s": metrics.time_s,
        "distance_m": metrics.distance_m,
        "spl": metrics.spl,
        "min_clearance_m": metrics.min_clearance_m,
        "contacts": len(metrics.contacts),
        "replans": metrics.replans,
        "path_length_m": metrics.path_length_m,
        "shortest_path_m": metrics.shortest_path_m,
        "max_cross_track_error_m": metrics.max_cross_track_error_m,
        "smoothness_rad_per_m": metrics.smoothness_rad_per_m,
        "touched": ",".join(metrics.contacts),
        "standing_contacts": len(metrics.standing_contacts),
        "unseen_contacts": len(metrics.unseen_contacts),
        "position_error_m": metrics.position_error_m,
        "localization_error_m": metrics.localization_error_m,
        "localization_error_p95_m": metrics.localization_error_p95_m,
        "lost_s": metrics.lost_s,
        "monitor_stops": metrics.monitor_stops,
        "recoveries": metrics.recoveries,
        "behaviors": describe_behaviors(episode.behaviors),
        "standing_periods": sum(metrics.standing_reasons.values()),
        "standing_reason": next(iter(metrics.standing_reasons), ""),
        **end,
        **closest,
        "trail": simplify(trajectory.poses[:, :2]),
        "planning_ms": metrics.planning_ms,
    }
