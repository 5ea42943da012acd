"""`Agent`: what decides how a robot drives; and `CommandScript`, an agent that drives by a list of commands."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from typing import Any, Protocol, TypeAlias, cast, runtime_checkable

from trundle.control import GoalChecker
from trundle.errors import InputError
from trundle.fault import wrong_result
from trundle.files.choice import Choice, split_choice
from trundle.geometry import Goal, Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.navigation.status import NavigationStatus
from trundle.observation import Estimate, Observation
from trundle.registry import Contract, PluginFunction, Registry, offered_arguments
from trundle.robots import Robot
from trundle.values import as_number, as_sequence, check_kind

CONTROL_PERIOD_S = 0.05
"""Length of the control periods of an agent that does not say it [s]."""

AGENTS: Registry[Agent] = Registry(
    "agent",
    "trundle.agents",
    {},
    contract=Contract(
        {"reset": "*, seed", "set_goal": "goal", "update": "observation, estimate"},
        ("status",),
        function=("observation", "estimate"),
        keywords=("goal",),
    ),
)


@runtime_checkable
class Agent(Protocol):
    """Decides how a robot drives: a `Navigator`, a script, a keyboard, or another package's autonomy.

    A `Session` calls `update` once per control period. It also uses, where the agent has them: `dt`, the length of the
    next control period [s] (0.05 otherwise); `path`, the path that it follows; `costmap`, what it drives on; `robot`;
    `grid`, its map, for a localizer; `error` or `message`, why it gave up; `replans` and `planning_time_s`;
    `tracks`, what its scans show to move; `intent`, what it means to command next, for the collision monitor;
    `planner_name` and `controller_name`, for reports; `goal_checker`, which says whether a pose is at the goal;
    `set_latency(latency)`, to which it reports the `Latency` of scans and commands; `set_sent_command(twist)`, to
    which it reports what was sent where the collision monitor changed the agent's command; and `assist_teleop(command,
    observation, estimate)`, which it calls instead of `update` while the robot is driven by hand, and which says what
    of that command may be sent (see `Navigator.assist_teleop`).
    """

    @property
    def status(self) -> NavigationStatus:
        """What it is doing. ARRIVED, FINISHED, STUCK, NO_PATH and PLANNING_TIMED_OUT end the drive to a goal."""
        ...

    def reset(self, *, seed: int = 0) -> None:
        """Forget the goal, and all that was observed. The same seed and observations give the same commands."""
        ...

    def set_goal(self, goal: Goal, /) -> None:
        """Set where to drive, map frame."""
        ...

    def update(self, observation: Observation, estimate: Estimate, /) -> Twist2D:
        """Return the command for the next control period.

        A session that sets the next goal calls it again at the same time, without scans.

        Args:
            observation: What the robot knows of its surroundings and its motion.
            estimate: Where it believes to be.
        """
        ...


AgentLike: TypeAlias = str | Choice | Agent | Callable[..., object]
"""Whatever drives: a name, `"module:name"`, an agent, a class of agents, or a function (observation, estimate), whose
further parameter `goal` gets the `Goal`. A class is made with those of `robot`, `map` and the options that its
parameters name. See `FunctionAgent`."""


def agent_names() -> list[str]:
    """Names that `create_agent` takes, sorted: those of installed packages."""
    return AGENTS.names()


def create_agent(agent: AgentLike, robot: Robot, grid: OccupancyGrid | None = None, **options: Any) -> Agent:
    """Make an agent of whatever drives.

    Args:
        agent: A name, a class, a function or an object; see `AgentLike`.
        robot: The robot.
        grid: What a class gets as `map`, where there is one.
        options: Of the agent; more than those of a `Choice`.

    Raises:
        UnknownNameError: If there is no agent of that name.
        InputError: If it does not take these options, needs an argument that nothing gives, or is no agent.
    """
    check_kind(robot, Robot, "an agent's robot", "Robot.load(name) makes one")
    _, given, chosen = split_choice(agent)
    made = AGENTS.resolve(given, offered_arguments(robot, grid), {**chosen, **options})
    return FunctionAgent(made) if isinstance(made, PluginFunction) else made


def check_command(agent: Agent, command: object) -> Twist2D:
    """The command of an agent.

    Raises:
        InputError: If it is none.
    """
    if isinstance(command, Twist2D):
        return command
    name = getattr(agent, "controller_name", type(agent).__name__)
    raise wrong_result(
        f"agent {name!r} returned {command!r}: an agent returns a Twist2D(v, w) [m/s, rad/s], and a function None "
        "where it has finished",
        agent.function if isinstance(agent, FunctionAgent) else agent,
        "update",
        kind="agent",
    )


class FunctionAgent:
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


class CommandScript:
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
