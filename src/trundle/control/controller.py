"""The protocol of controllers, what one means to command next (`Intent`), and the controllers by name."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, TypeAlias, runtime_checkable

import numpy as np

from trundle.control.latency import Latency
from trundle.costmap import Costmap
from trundle.fault import wrong_result
from trundle.files.choice import Choice, split_choice
from trundle.geometry import FloatArray, Pose2D, Twist2D, integrate_twist
from trundle.maps import OccupancyGrid
from trundle.observation import Track
from trundle.path import Path
from trundle.registry import Contract, PluginFunction, Registry, is_foreign, keywords_taken, name_of, offered_arguments
from trundle.robots import Robot
from trundle.values import check_kind

_SAME = 1e-3  # [m/s] and [rad/s]: rounding in single precision is below it


@dataclass(frozen=True, slots=True, eq=False)
class Intent:
    """How a controller means to drive from now on, if nothing changes.

    Attributes:
        twists: Commands (v, w) [m/s, rad/s] one after the other, shape (N, 2); the first is the one that it returned.
        step_s: How long each is kept up [s]; the last one from then on.
    """

    twists: FloatArray
    step_s: float

    def begins_with(self, command: Twist2D) -> bool:
        """Return whether a command is its first one: one that something else has changed leads elsewhere."""
        if len(self.twists) == 0:
            return False
        v, w = self.twists[0].tolist()
        return abs(v - command.v) <= _SAME and abs(w - command.w) <= _SAME

    def poses(self, times: FloatArray) -> FloatArray:
        """Return poses (x, y, yaw) of base_link at these times [s], ascending, from (0, 0, 0) on; shape (K, 3)."""
        x = y = yaw = now = 0.0
        poses: list[tuple[float, float, float]] = []
        last = len(self.twists) - 1
        twists: list[list[float]] = self.twists.tolist()
        index = 0
        for time in times.tolist():
            while index < last and (index + 1) * self.step_s <= time:
                end = (index + 1) * self.step_s
                x, y, yaw = integrate_twist(x, y, yaw, twists[index][0], twists[index][1], end - now)
                now, index = end, index + 1
            x, y, yaw = integrate_twist(x, y, yaw, twists[index][0], twists[index][1], time - now)
            now = time
            poses.append((x, y, yaw))
        return np.array(poses).reshape(-1, 3)


CONTROLLERS: Registry[Controller] = Registry(
    "controller",
    "trundle.controllers",
    {
        "regulated_pure_pursuit": "trundle.control.regulated_pure_pursuit:RegulatedPurePursuit",
        "lookahead": "trundle.control.lookahead:LookaheadFollower",
        "mppi": "trundle.control.mppi.controller:MppiController",
    },
    contract=Contract(
        {"set_path": "path", "compute_velocity": "pose, twist, costmap, dt"},
        function=("pose", "twist", "costmap", "dt", "path"),
    ),
)


@dataclass(frozen=True, slots=True)
class Rollouts:
    """What a controller that samples considered best in the last control period.

    Attributes:
        poses: (x, y, yaw) [m, m, rad], map frame, shape (N, T, 3).
        costs: Cost of each [m], shape (N,), the lowest first.
    """

    poses: FloatArray
    costs: FloatArray


@runtime_checkable
class Controller(Protocol):
    """Follows a path.

    `set_path` and `compute_velocity` do the work. Every other member is optional: its default is the one of a
    controller that has nothing to say or nothing to set there. `create_controller` gives these defaults to a controller
    of another package that lacks a member, and to a function; see `ControllerLike`.

    Attributes:
        reason: Why the robot makes no progress, such as "no free sample"; empty while it does. A `Navigator` counts and
            shows it.
    """

    reason: str = ""

    def reset(self, *, seed: int = 0) -> None:
        """Forget the path and everything else, at the start of a run.

        The same seed and arguments give the same commands. The default does nothing, for controllers that keep nothing
        but the path and draw no random numbers.
        """

    def set_path(self, path: Path) -> None:
        """Follow this path from now on, from its beginning."""
        ...

    def set_speed_limit(self, limit: float) -> None:
        """Drive no faster than this [m/s] from now on; infinity takes the limit away.

        A `Navigator` with a speed mask calls it before each command. The default does nothing: the navigator slows
        commands that are too fast, on the same arc.
        """

    def set_latency(self, latency: Latency) -> None:
        """Set how late scans and commands arrive from now on; a `Navigator` passes it on before a run.

        The pose and twist that `compute_velocity` gets are already those at which the command takes effect. The default
        does nothing.
        """

    def set_tracks(self, tracks: Sequence[Track]) -> None:
        """Set the tracks of what moves, predicted to now, map frame; a `Navigator` calls it before each command.

        The default does nothing: what moves is then avoided where it stands in the costmap.
        """

    def set_through(self, marks: Sequence[float], tolerance: float) -> None:
        """Set the poses that the path has to pass before its end; a `Navigator` calls it before each command.

        The default does nothing, for controllers that stay on the path anyway.

        Args:
            marks: How far along the path each pose is that is still to be passed [m], ascending.
            tolerance: How near the robot must come to each [m].
        """

    @property
    def intent(self) -> Intent | None:
        """What it means to command from now on, or None where it does not say.

        The collision monitor judges a command by the whole intent, and without one as if the command were kept up.
        """
        return None

    def rollouts(self) -> Rollouts | None:
        """Return the best samples of the last control period, for pictures; None if there were none."""
        return None

    def compute_velocity(self, pose: Pose2D, twist: Twist2D, costmap: Costmap, dt: float) -> Twist2D:
        """Return the command for the next control period of `dt` [s].

        Args:
            pose: Where the robot is, map frame.
            twist: How it moves now, base_link.
            costmap: The obstacles.
            dt: Length of the control period [s].

        Returns:
            A twist within the robot's speed limits; (0, 0) without a path and at its end.

        Raises:
            NoValidControlError: If every command would cause a contact. A navigator takes (0, 0) before the goal for
                the same.
        """
        ...


class SomeController(Protocol):
    """The least that an object needs to be used as a controller; `create_controller` makes a `Controller` of it."""

    def set_path(self, path: Path, /) -> None:
        """Follow this path from now on."""
        ...

    def compute_velocity(self, pose: Pose2D, twist: Twist2D, costmap: Costmap, dt: float, /) -> Twist2D:
        """Return the command for the next control period."""
        ...


ControllerLike: TypeAlias = str | Choice | SomeController | Callable[..., object]
"""Whatever follows a path: a name, `"module:name"`, an object with `set_path` and `compute_velocity`, a class of such
objects, or a function (pose, twist, costmap, dt, path) → `Twist2D`, which is called while there is a path. A class is
made with those of `robot`, `map` and the options that its parameters name."""


def controller_names() -> list[str]:
    """Return names that `create_controller` takes, sorted."""
    return CONTROLLERS.names()


def create_controller(
    controller: ControllerLike, robot: Robot, grid: OccupancyGrid | None = None, **options: Any
) -> Controller:
    """Make a controller for a robot of whatever follows a path.

    One of another package is wrapped, so that it can be used like any other.

    Args:
        controller: A name, a class, a function or an object; see `ControllerLike`.
        robot: The robot.
        grid: What a class gets as `map`, where there is one.
        options: Options of the controller; more than those of a `Choice`.

    Raises:
        UnknownNameError: If there is no controller of that name.
        InputError: If it does not take these options, needs an argument that nothing gives, or is no controller; or the
            robot is none.
    """
    check_kind(robot, Robot, "a controller's robot", "Robot.load(name) makes one")
    _, given, chosen = split_choice(controller)
    made = CONTROLLERS.resolve(given, offered_arguments(robot, grid), {**chosen, **options})
    if isinstance(made, PluginFunction):
        return ControllerAdapter(FunctionController(made))
    return ControllerAdapter(made) if is_foreign(made) else made


class FunctionController:
    """A function (pose, twist, costmap, dt, path) → `Twist2D` as a controller, which stands without a path.

    Args:
        function: The function.

    Attributes:
        function: The function itself.
    """

    def __init__(self, function: PluginFunction) -> None:
        self.function = function.function
        self.__name__ = function.name
        self._call = function
        self._path: Path | None = None

    def reset(self) -> None:
        """Forget the path."""
        self._path = None

    def set_path(self, path: Path) -> None:
        """Hand this path to the function from now on."""
        self._path = path

    def compute_velocity(self, pose: Pose2D, twist: Twist2D, costmap: Costmap, dt: float) -> Twist2D:
        """Ask the function for the command."""
        return Twist2D() if self._path is None else self._call(pose, twist, costmap, dt, self._path)


_OPTIONAL = ("reset", "set_speed_limit", "set_latency", "set_tracks", "set_through", "rollouts")
"""The methods of `Controller` that an object need not have."""


class ControllerAdapter(Controller):
    """Gives a controller of another package the whole protocol, and checks what it returns.

    It hands on each optional member that the controller has, and has the default of `Controller` for each other. What
    the controller has besides, such as an attribute of its own for a debugger, can be read here as well.

    Args:
        controller: The controller to wrap.

    Attributes:
        controller: The same.
    """

    def __init__(self, controller: Any) -> None:
        self.controller: Any = controller
        self._has = frozenset(name for name in _OPTIONAL if callable(getattr(controller, name, None)))

    def __getattr__(self, name: str) -> Any:
        if name == "controller" or name.startswith("__"):  # a copy that is being made has none yet
            raise AttributeError(name)
        return getattr(self.controller, name)

    def reset(self, *, seed: int = 0) -> None:
        """Forget everything, where the controller can; see `Controller`."""
        if "reset" in self._has:
            reset = self.controller.reset
            reset(**({"seed": seed} if keywords_taken(reset, ("seed",)) else {}))

    def set_speed_limit(self, limit: float) -> None:
        """Hand the limit on, where the controller takes one; see `Controller`."""
        if "set_speed_limit" in self._has:
            self.controller.set_speed_limit(limit)

    def set_latency(self, latency: Latency) -> None:
        """Hand the latency on, where the controller takes one; see `Controller`."""
        if "set_latency" in self._has:
            self.controller.set_latency(latency)

    def set_tracks(self, tracks: Sequence[Track]) -> None:
        """Hand the tracks on, where the controller takes them; see `Controller`."""
        if "set_tracks" in self._has:
            self.controller.set_tracks(tracks)

    def set_through(self, marks: Sequence[float], tolerance: float) -> None:
        """Hand on the poses to pass, where the controller takes them; see `Controller`."""
        if "set_through" in self._has:
            self.controller.set_through(marks, tolerance)

    @property
    def intent(self) -> Intent | None:
        """What the controller means to command, where it says so; see `Controller`."""
        try:
            return self.controller.intent
        except AttributeError:  # asked each time, as it may get one with its first command
            return None

    @property
    def reason(self) -> str:  # pyright: ignore[reportIncompatibleVariableOverride] - it is the controller's
        """Why the robot makes no progress, where the controller says so; see `Controller`."""
        try:
            return self.controller.reason or ""
        except AttributeError:
            return ""

    def rollouts(self) -> Rollouts | None:
        """Return the best samples, where the controller draws some; see `Controller`."""
        return self.controller.rollouts() if "rollouts" in self._has else None

    def set_path(self, path: Path) -> None:
        """Follow this path from now on; see `Controller`."""
        self.controller.set_path(path)

    def compute_velocity(self, pose: Pose2D, twist: Twist2D, costmap: Costmap, dt: float) -> Twist2D:
        """Return the command for the next control period; see `Controller`.

        Raises:
            InputError: If the controller returns something else.
        """
        command = self.controller.compute_velocity(pose, twist, costmap, dt)
        if not isinstance(command, Twist2D):
            raise wrong_result(
                f"controller {name_of(self.controller)!r} returned {command!r}: compute_velocity returns a "
                "Twist2D(v, w) [m/s, rad/s], and Twist2D() to stand",
                self.controller,
                "compute_velocity",
                kind="controller",
            )
        return command
