"""`Observer`: what follows a run, and the data that it gets."""

from __future__ import annotations

import contextlib
import logging
import pathlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol, TypeVar, runtime_checkable

from trundle.control import Rollouts
from trundle.costmap import Costmap
from trundle.geometry import Goal, Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.maps.masks import SpeedMask
from trundle.mission.episode import Episode
from trundle.mission.own_map import MapTrack
from trundle.mission.run_files import RECORD
from trundle.navigation import NavigationStatus
from trundle.navigation.behaviors import BehaviorRun
from trundle.observation import Estimate, Observation, Scan, Track
from trundle.path import Path
from trundle.robots import Robot
from trundle.sim import MoverState, RobotState, Substep
from trundle.values import check_kind
from trundle.worlds import World

_LOGGER = logging.getLogger(__name__)

_STAND = Twist2D()


class MonitorReport(Protocol):
    """What a collision monitor did with a command; `trundle.control.MonitorReport` is one."""

    @property
    def command(self) -> Twist2D:
        """The twist to send."""
        ...

    @property
    def action(self) -> str:
        """Such as "none", "slow", "approach" and "stop"."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class RunInfo:
    """What observers get before the first step.

    Attributes:
        name: Name of the run.
        robot: The robot that is driven.
        costmap: What it plans and drives on at the start; None where its agent has none.
        start: Where it starts, map frame.
        goals: The goals, in order; none where the agent has none.
        path_length_m: Length [m] of the plans to all goals, as far as there are any.
        time_limit_s: When the run is stopped [s]; infinity without a limit.
        dt: Control period [s], the first one where they differ.
        planner: Name of the planner, "none" where the agent has no planner.
        controller: Name of the controller, or of the agent.
        seed: Seed of the simulator.
        speed_mask: What limits its speed, or None.
        world: The simulated world, or None where the simulator does not provide one.
        grid: The map that the agent was given, or None.
        localizer: Name of what estimates the pose, "none" where the robot knows its true pose.
    """

    name: str
    robot: Robot
    costmap: Costmap | None
    start: Pose2D
    goals: tuple[Goal, ...]
    path_length_m: float
    time_limit_s: float
    dt: float
    planner: str
    controller: str
    seed: int
    speed_mask: SpeedMask | None = None
    world: World | None = None
    grid: OccupancyGrid | None = None
    localizer: str = "none"


@dataclass(frozen=True, slots=True)
class SteeringReport:
    """How a run was steered in one control period.

    Attributes:
        paused: Whether the run was paused, and drove a single step.
        manual: The command by hand, before any check; None where the agent drove.
        held_back: What kept the command by hand from being sent as it was, such as "an obstacle on the map"; empty
            where nothing did.
        by: Who drove by hand; empty where the agent drove.
        speed: How fast the run is to pass, relative to real time.
        goals: All goals now, in order, those reached included.
        boxes: Number of boxes that were dropped so far.
    """

    paused: bool
    manual: Twist2D | None
    held_back: str
    by: str
    speed: float
    goals: tuple[Goal, ...]
    boxes: int = 0


@dataclass(frozen=True, slots=True, eq=False)
class Step:
    """What observers get after the start (index 0) and after every control period.

    Attributes:
        index: Number of control periods driven.
        state: State of the simulator now: the truth.
        command: What the agent commanded for the period that ends now.
        goal: Index of the goal that it drives to.
        path: The path that it follows, or none.
        status: Status of the agent.
        sent: What was sent to the robot: the command, or what the collision monitor made of it.
        observation: What the robot knows now, from which the agent makes its next command.
        estimate: Where the robot believes to be now.
        costmap: What the agent drives on, or none.
        monitor: What the collision monitor did with the command, or none without one.
        tracks: What the agent's scans show to move, map frame; see `Navigator.tracks`.
        rollouts: The best samples of the agent's controller, or none; see `Navigator.rollouts`. Among observers, only
            where one of them has `wants_rollouts = True`: they take a tenth of the controller's time.
        message: What blocks the agent, such as "blocked: obstacle ahead at (2.00, 3.50)"; empty where nothing does.
        behaviors: The behaviors that it has run so far, in order; the last one may still be running.
        tick_s: Wall time [s] that the agent took for its command.
        planning_s: Wall time [s] that it planned during the period; at the start, for the plans before the run.
        steering: How the run was steered during the period that ends now, or none where it takes no directives.
        distance_remaining: Length of what is left of the path that it follows [m], or none without one.
        map: The map that the localizer has made so far, as the agent has it, or none where it makes none. It is
            another object about once a second.
        map_track: Poses and loops of that map, or none where the localizer does not say.
    """

    index: int
    state: RobotState
    command: Twist2D
    goal: int
    path: Path | None
    status: NavigationStatus
    sent: Twist2D = _STAND
    observation: Observation | None = None
    estimate: Estimate | None = None
    costmap: Costmap | None = None
    monitor: MonitorReport | None = None
    tracks: tuple[Track, ...] = ()
    rollouts: Rollouts | None = None
    message: str = ""
    behaviors: tuple[BehaviorRun, ...] = ()
    tick_s: float = 0.0
    planning_s: float = 0.0
    steering: SteeringReport | None = None
    distance_remaining: float | None = None
    map: OccupancyGrid | None = None
    map_track: MapTrack | None = None

    @property
    def scans(self) -> tuple[Scan, ...]:
        """The scans that arrived during the period that ends now."""
        return () if self.observation is None else self.observation.scans

    @property
    def movers(self) -> tuple[MoverState, ...]:
        """The world's moving obstacles now."""
        return self.state.movers


@runtime_checkable
class Observer(Protocol):
    """Follows a run. One that raises is dropped, and the run continues; see `Episode.observer_errors`.

    One may also be a `SubstepObserver` or a `RolloutObserver`. One that writes the run to a folder has this as its
    attribute `path`: an exception that ends the run then names it.
    """

    def on_start(self, run: RunInfo) -> None:
        """Observe the start, before anything has moved."""
        ...

    def on_step(self, step: Step) -> None:
        """Observe the start, and then every control period."""
        ...

    def on_end(self, episode: Episode) -> None:
        """Observe the end of the run, however it ended."""
        ...


@runtime_checkable
class SubstepObserver(Observer, Protocol):
    """An observer that also follows the physics steps of simulators that report them: `kinematic` and `mujoco` do."""

    def on_substep(self, substep: Substep) -> None:
        """Observe a physics step, before the control period that it belongs to."""
        ...


@runtime_checkable
class RolloutObserver(Observer, Protocol):
    """An observer that may use `Step.rollouts`, the samples of the agent's controller."""

    @property
    def wants_rollouts(self) -> bool:
        """Whether the next steps are to have them: they take a tenth of the controller's time."""
        ...


_Some = TypeVar("_Some", bound=Observer)


class Observers:
    """The observers of one run; one that raises is dropped, and the others continue.

    Attributes:
        has_begun: Whether they were notified of the start.
        errors: What they raised.
    """

    def __init__(self, observers: Sequence[Observer]) -> None:
        check_kind(observers, Sequence, "observers", "give a list of them, [observer]")
        self._observers = list(observers)
        self._all = tuple(observers)
        self._of_substeps = [observer for observer in observers if isinstance(observer, SubstepObserver)]
        self._of_rollouts = [observer for observer in observers if isinstance(observer, RolloutObserver)]
        self.has_begun = False
        self.errors: list[BaseException] = []

    def __bool__(self) -> bool:
        return bool(self._observers)

    @property
    def folder(self) -> pathlib.Path | None:
        """The folder that one of them has written the run to, its `path`; None where none has."""
        for observer in self._all:
            with contextlib.suppress(TypeError):  # one with slots has no `path` of ours
                path = vars(observer).get("path")
                if isinstance(path, pathlib.Path) and (path / RECORD).is_file():
                    return path
        return None

    @property
    def want_substeps(self) -> bool:
        """Whether one of them follows the physics steps."""
        return bool(self._of_substeps)

    @property
    def want_rollouts(self) -> bool:
        """Whether one of them uses the samples of the controller."""
        return bool(self._of_rollouts) and any(observer.wants_rollouts for observer in self._of_rollouts)

    def on_start(self, info: RunInfo) -> None:
        """Notify them before the first step."""
        self.has_begun = True
        self._notify(self._observers, lambda observer: observer.on_start(info))

    def on_substep(self, substep: Substep) -> None:
        """Notify those that follow the physics steps."""
        self._notify(self._of_substeps, lambda observer: observer.on_substep(substep))

    def on_step(self, step: Step) -> None:
        """Notify them after the start and every control period."""
        self._notify(self._observers, lambda observer: observer.on_step(step))

    def on_end(self, episode: Episode) -> None:
        """Notify them of the end."""
        # The run is over: Ctrl-C now ends what this observer does, and the next one still writes its files.
        self._notify(self._observers, lambda observer: observer.on_end(episode), also=KeyboardInterrupt)

    def _notify(
        self, observers: list[_Some], notify: Callable[[_Some], None], also: type[BaseException] = Exception
    ) -> None:
        for observer in tuple(observers):
            try:
                notify(observer)
            except (Exception, also) as error:  # noqa: BLE001 - an observer never changes a run
                _LOGGER.warning("%s failed and is dropped: %s", type(observer).__name__, error or type(error).__name__)
                self._observers = [one for one in self._observers if one is not observer]
                self._of_substeps = [one for one in self._of_substeps if one is not observer]
                self._of_rollouts = [one for one in self._of_rollouts if one is not observer]
                self.errors.append(error)
