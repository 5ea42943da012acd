"""Agents that are made of what a user gives: `create_agent`, `FunctionAgent` and `CommandScript`."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, ClassVar, TypeAlias, cast

from trundle.control import GoalChecker
from trundle.errors import InputError
from trundle.fault import wrong_result
from trundle.files.choice import Choice, split_choice
from trundle.geometry import Goal, Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.navigation.agent import CONTROL_PERIOD_S, Agent, AgentInfo, AgentReport, SomeAgent, read_status
from trundle.navigation.state import NavigationStatus
from trundle.observation import Estimate, Observation
from trundle.registry import Contract, PluginFunction, Registry, offered_arguments
from trundle.robots import Robot
from trundle.values import as_number, as_sequence, check_kind

AGENTS: Registry[Agent] = Registry(
    "agent",
    "trundle.agents",
    {
        "explorer": "trundle.navigation.exploration.explorer:Explorer",
        "navigator": "trundle.navigation.navigator:choose_navigator",
    },
    model="trundle.navigation.policies.policy:Policy",
    contract=Contract(
        {"reset": "*, seed", "set_goal": "goal", "update": "observation, estimate"},
        ("status",),
        function=("observation", "estimate"),
        keywords=("goal",),
    ),
)

AgentLike: TypeAlias = str | Choice | SomeAgent | Callable[..., object]
"""Whatever drives: a name, `"module:name"`, the file of a policy (`policy.onnx`), an agent, a class of agents, or a
function (observation, estimate), whose further parameter `goal` gets the `Goal`. A class is made with those of `robot`,
`map`, `navigator` and the options that its parameters name; a scenario gives it the navigator that it would drive with
otherwise. See `FunctionAgent`, and `AgentAdapter` for an object that does not derive from `Agent`."""


def agent_names() -> list[str]:
    """Return names that `create_agent` takes, sorted: those of installed packages."""
    return AGENTS.names()


def create_agent(
    agent: AgentLike,
    robot: Robot,
    grid: OccupancyGrid | None = None,
    *,
    navigator: Agent | None = None,
    **options: Any,
) -> Agent:
    """Make an agent of whatever drives.

    Args:
        agent: A name, a class, a function or an object; see `AgentLike`.
        robot: The robot.
        grid: What a class gets as `map`, where there is one.
        navigator: What a class gets as `navigator`, where there is one.
        options: Options of the agent; more than those of a `Choice`.

    Raises:
        UnknownNameError: If there is no agent of that name.
        InputError: If it does not take these options, needs an argument that nothing gives, or is no agent.
    """
    check_kind(robot, Robot, "an agent's robot", "Robot.load(name) makes one")
    _, given, chosen = split_choice(agent)
    offered = offered_arguments(robot, grid) | ({} if navigator is None else {"navigator": navigator})
    made = AGENTS.resolve(given, offered, {**chosen, **options})
    if isinstance(made, PluginFunction):
        return FunctionAgent(made)
    return made if isinstance(cast("object", made), Agent) else AgentAdapter(made)


def check_command(agent: Agent, command: object) -> Twist2D:
    """Return the command of an agent, once it is known to be one.

    Raises:
        InputError: If it is none.
    """
    if isinstance(command, Twist2D):
        return command
    info = agent.info()
    raise wrong_result(
        f"agent {info.controller!r} returned {command!r}: an agent returns a Twist2D(v, w) [m/s, rad/s], and a "
        "function None where it has finished",
        info.plugins[0] if info.plugins else agent,
        "update",
        kind="agent",
    )


class AgentAdapter(Agent):
    """Gives an agent that does not derive from `Agent`, as those of other packages, the whole of it.

    Such an agent may have some of `Agent`'s methods: `set_goals`, `set_latency`, `set_map`, `set_sent_command`,
    `assist_teleop`. And it may have, as attributes, what `AgentInfo` and `AgentReport` hold: `dt`, `robot`, `grid`,
    `costmap`, `speed_mask`, `goal_checker`, `planner_name`, `controller_name`; `path`, `distance_remaining`, `tracks`,
    `rollouts`, `intent`, `message`, `error`, `goals_reached`, `behavior_runs`, `replans`, `planning_time_s`,
    `standing_reasons`.

    Args:
        agent: The agent.

    Attributes:
        agent: The same.
    """

    _METHODS = ("set_goals", "set_latency", "set_map", "set_sent_command", "assist_teleop")
    _INFO: ClassVar = {
        **{name: name for name in ("robot", "grid", "costmap", "speed_mask", "goal_checker")},
        "planner": "planner_name",
        "controller": "controller_name",
    }
    _REPORT: ClassVar = {
        **{
            name: name
            for name in ("path", "distance_remaining", "costmap", "tracks", "rollouts", "intent", "message", "error")
        },
        **{name: name for name in ("goals_reached", "replans", "planning_time_s", "standing_reasons")},
        "behaviors": "behavior_runs",
    }

    def __init__(self, agent: SomeAgent) -> None:
        self.agent = agent
        for name in self._METHODS:
            if callable(own := getattr(agent, name, None)):
                setattr(self, name, own)

    def __repr__(self) -> str:
        return repr(self.agent)

    @property
    def status(self) -> NavigationStatus:  # type: ignore[override]
        """What it is doing."""
        return read_status(self.agent)

    @property
    def dt(self) -> float:  # type: ignore[override]
        """Length of the next control period [s]."""
        return self._read({"dt": "dt"}).get("dt", CONTROL_PERIOD_S)

    def _read(self, names: Mapping[str, str]) -> dict[str, Any]:
        """Return those of its attributes that it has and that are not None, by the names that they have in trundle."""
        found = {ours: getattr(self.agent, theirs, None) for ours, theirs in names.items()}
        return {name: value for name, value in found.items() if value is not None}

    def reset(self, *, seed: int = 0) -> None:
        """Forget the goal, and all that was observed."""
        self.agent.reset(seed=seed)

    def set_goal(self, goal: Goal, /) -> None:
        """Set where to drive, map frame."""
        self.agent.set_goal(goal)

    def update(self, observation: Observation, estimate: Estimate) -> Twist2D:
        """Return the command for the next control period."""
        return self.agent.update(observation, estimate)

    def info(self) -> AgentInfo:
        """Return what it is and drives with, as far as it has attributes that say so."""
        said: dict[str, Any] = {"controller": type(self.agent).__name__, **self._read(self._INFO)}
        return AgentInfo(**said, plugins=(self.agent,))

    def report(self, *, rollouts: bool = False) -> AgentReport:
        """Return what it is doing, as far as it has attributes that say so."""
        return AgentReport(read_status(self.agent), **self._read(self._REPORT))


class FunctionAgent(Agent):
    """A function (observation, estimate) → `Twist2D` as an agent.

    It is DRIVING until its estimate is within the tolerance of the goal; there it stops, and has ARRIVED. A function
    that returns None is FINISHED.

    Args:
        function: The function.

    Attributes:
        controller_name: The function's name, for reports.
        function: The function.
        goal_checker: Says whether the goal is reached; may be replaced.
        status: What it is doing.
    """

    def __init__(self, function: PluginFunction) -> None:
        self.controller_name = function.name
        self.goal_checker = GoalChecker()
        self.function, self._call = function.function, function
        self.reset()

    def __repr__(self) -> str:
        return f"FunctionAgent({self.controller_name}, {self.status.value})"

    def info(self) -> AgentInfo:
        """Return how the function is called."""
        return AgentInfo(self.controller_name, goal_checker=self.goal_checker, plugins=(self.function,))

    def reset(self, *, seed: int = 0) -> None:
        """Forget the goal; the function keeps what it keeps."""
        self._goal: Goal | None = None
        self.status = NavigationStatus.IDLE

    def set_goal(self, goal: Goal | Pose2D | Sequence[float], /) -> None:
        """Hand this goal to the function from now on, and stop there."""
        self._goal = Goal.of(goal)
        self.status = NavigationStatus.DRIVING

    def update(self, observation: Observation, estimate: Estimate) -> Twist2D:
        """Ask the function for the command for the next control period.

        Raises:
            InputError: If it returns neither a `Twist2D` nor None.
        """
        goal = self._goal
        if self.status in (NavigationStatus.ARRIVED, NavigationStatus.FINISHED):
            return Twist2D()
        checker = self.goal_checker
        if goal is not None and checker.is_within(estimate.pose, goal.pose, any_yaw=goal.yaw_free):
            if checker.is_reached(estimate.pose, observation.twist, goal.pose, any_yaw=goal.yaw_free):
                self.status = NavigationStatus.ARRIVED
            return Twist2D()
        command = cast("object", self._call(observation, estimate, goal=goal))
        if command is None:
            self.status = NavigationStatus.FINISHED
            return Twist2D()
        self.status = NavigationStatus.DRIVING
        return check_command(self, command)


class CommandScript(Agent):
    """An agent that drives a list of commands one after the other, without a goal; then it is FINISHED.

    Every `update` is one control period.

    Args:
        commands: (v [m/s], w [rad/s], seconds) of each.
        period_s: Length of a control period [s]; the last one of a command is as long as is left of it.

    Raises:
        InputError: If a number is not finite, or a duration or the period is not positive.
    """

    def __init__(self, commands: Iterable[Sequence[float]], *, period_s: float = CONTROL_PERIOD_S) -> None:
        self._commands = [_read_command(command) for command in commands]
        if not 0.0 < as_number(period_s, "the control period") < math.inf:
            raise InputError(f"the control period must be a positive number of seconds, got {period_s}")
        self._period_s = period_s
        self.reset()

    def __repr__(self) -> str:
        return f"CommandScript({len(self._commands)} commands, {self.status.value})"

    @property
    def index(self) -> int:
        """Index of the command that it drives, −1 before the first `update`."""
        return self._index

    def reset(self, *, seed: int = 0) -> None:
        """Start over; nothing here is random."""
        self._index = -1
        self._left_s = 0.0
        self.dt = self._period_s
        self.status = NavigationStatus.IDLE

    def set_goal(self, goal: Goal | Pose2D | Sequence[float], /) -> None:
        """Do nothing: the commands say where to drive."""

    def update(self, observation: Observation, estimate: Estimate) -> Twist2D:
        """Return the command for the next control period, whose length is `dt` from now on."""
        while self._left_s <= 1e-9:
            if self._index + 1 == len(self._commands):
                self.status = NavigationStatus.FINISHED
                return Twist2D()
            self._index += 1
            self._left_s = self._commands[self._index][2]
        self.status = NavigationStatus.DRIVING
        self.dt = min(self._period_s, self._left_s)
        self._left_s -= self.dt
        v, w, _ = self._commands[self._index]
        return Twist2D(v, w)


def _read_command(command: Sequence[float]) -> tuple[float, float, float]:
    numbers = as_sequence(command, "a command (v, w, seconds)")
    if len(numbers) != 3:
        raise InputError(f"a command is (v, w, seconds), got {command!r}")
    v, w, seconds = (as_number(number, "a number of a command") for number in numbers)
    if not (math.isfinite(v) and math.isfinite(w) and 0.0 < seconds < math.inf):
        raise InputError(f"a command needs finite speeds and a positive number of seconds, got {command!r}")
    return v, w, seconds
