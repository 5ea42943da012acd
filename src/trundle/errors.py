"""The exceptions of trundle.

Every exception that trundle raises on purpose derives from `TrundleError`. Bad input raises `InputError`, which is
also a `ValueError`. A missed goal, a collision and a time-out are outcomes (data), not exceptions.
"""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterable


class TrundleError(Exception):
    """Base of every exception that trundle raises on purpose.

    These errors can be copied and pickled with their attributes, whatever the arguments of their constructor, so
    another process can raise them.
    """

    def __reduce__(self) -> tuple[Callable[..., TrundleError], tuple[object, ...], dict[str, object]]:
        return _remake, (type(self), *self.args), dict(self.__dict__)


class InputError(TrundleError, ValueError):
    """An argument, a file or a setting that cannot be used; the message says what, where and what to do."""


class MapError(InputError):
    """A map file or an occupancy grid that cannot be used."""


class MapWarning(UserWarning):
    """A map that can be used but probably contains a mistake."""


class WorldWarning(UserWarning):
    """A world that can be used but is probably not what was intended."""


class RobotWarning(UserWarning):
    """A robot that can be used, with some values assumed."""


class SensorWarning(UserWarning):
    """A scan or an estimate that is left out, or after which what was sensed is forgotten."""


class AngleWarning(UserWarning):
    """An angle that can be used but was probably meant in degrees."""


class RobotError(InputError):
    """A robot description that cannot be used."""


class WorldError(InputError):
    """A world that cannot be used."""


class ScenarioError(InputError):
    """A scenario or a mission that cannot be used."""


class OutputError(TrundleError):
    """A result that cannot be written to the given path."""


class SimulationError(TrundleError):
    """A simulator that cannot continue, or was used after it was closed."""


class TransportError(TrundleError):
    """A network of ROS 2 that cannot be joined, or was lost; the message says why and what to do."""


class UnknownNameError(InputError):
    """A name that is not in the registry.

    Attributes:
        kind: What a name stands for ("planner").
        name: The requested name.
        choices: The available names, sorted.
        hint: What to use instead of a name that is none any more ("was renamed; use …"), or None.
    """

    def __init__(self, kind: str, name: str, choices: Iterable[str], *, hint: str | None = None) -> None:
        self.kind = kind
        self.name = name
        self.choices = tuple(sorted(choices))
        self.hint = hint
        if hint is not None:
            super().__init__(f"{kind} {name!r} {hint}")
            return
        nearest = respell(name, self.choices) or next(iter(difflib.get_close_matches(name, self.choices, n=1)), None)
        guess = f" Did you mean {nearest!r}?" if nearest else ""
        super().__init__(f"unknown {kind} {name!r}.{guess} There are: {', '.join(self.choices) or 'none'}.")


def respell(name: str, choices: Iterable[str]) -> str | None:
    """Return the choice of which a name is only another spelling, in case, hyphens, blanks or `*`: `A*` is `astar`."""
    wanted = _letters(name)
    return next((choice for choice in choices if _letters(choice) == wanted), None) if wanted else None


def _letters(name: str) -> str:
    return "".join(character for character in name.lower().replace("*", "star") if character.isalnum())


class MissingExtraError(TrundleError, ImportError):
    """An optional library that is needed but not installed; the message gives the install command.

    Attributes:
        purpose: What needs it.
        package: The missing package.
        install: The command that installs it.
    """

    def __init__(self, purpose: str, package: str, install: str) -> None:
        super().__init__(f"{purpose} needs {package}, which is not installed. Install it with: {install}")
        self.purpose, self.package, self.install = purpose, package, install

    def __reduce__(self) -> tuple[Callable[..., TrundleError], tuple[object, ...], dict[str, object]]:
        make, arguments, state = super().__reduce__()
        return make, arguments, {**state, "msg": self.msg}

    def __str__(self) -> str:
        return str(self.args[0])


class PlanningError(TrundleError):
    """No path was found.

    Attributes:
        pose: The pose [m, m, rad] in the map frame that the message is about, or None.
        cell: Its (row, col) on the costmap, or None.
        complete: Whether it is shown that the costmap has no path for this robot. If not, the search ended before that.
    """

    complete: bool = False

    def __init__(
        self,
        message: str,
        *,
        pose: tuple[float, float, float] | None = None,
        cell: tuple[int, int] | None = None,
    ) -> None:
        super().__init__(message)
        self.pose = pose
        self.cell = cell


class OutsideMapError(PlanningError):
    """A start or goal that lies outside the map."""

    complete = True


class BlockedPoseError(PlanningError):
    """A start or goal where the robot cannot stand.

    Attributes:
        nearest_free_m: Distance to the nearest cell where it can stand, or None if none was found nearby.
    """

    complete = True

    def __init__(
        self,
        message: str,
        *,
        pose: tuple[float, float, float] | None = None,
        cell: tuple[int, int] | None = None,
        nearest_free_m: float | None = None,
    ) -> None:
        super().__init__(message, pose=pose, cell=cell)
        self.nearest_free_m = nearest_free_m


class NoPathError(PlanningError):
    """Start and goal are free, but no path connects them."""

    complete = True


class PlanningStoppedError(PlanningError):
    """Planning stopped before it found a path or proved that none exists.

    Attributes:
        status: "timeout", "cancelled", or "exhausted" for a planner that used up its attempts.
    """

    def __init__(
        self,
        message: str,
        *,
        pose: tuple[float, float, float] | None = None,
        cell: tuple[int, int] | None = None,
        status: str = "timeout",
    ) -> None:
        super().__init__(message, pose=pose, cell=cell)
        self.status = status


class NoValidControlError(TrundleError):
    """A controller has a path to follow, and every command that it considered would cause a contact."""


class BehaviorFailedError(TrundleError):
    """A behavior cannot go on; the message says why."""


def _remake(kind: type[TrundleError], *arguments: object) -> TrundleError:
    """Make an error with these `args` without `__init__`, whose parameters may differ; its attributes are set next."""
    return kind.__new__(kind, *arguments)
