"""The protocol of localizers, and the localizers by name."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol, TypeAlias, runtime_checkable

import numpy as np

from trundle.errors import InputError
from trundle.fault import wrong_result
from trundle.files.choice import Choice, split_choice
from trundle.geometry import FloatArray, Pose2D
from trundle.maps import OccupancyGrid
from trundle.observation import Estimate, Observation
from trundle.registry import Contract, PluginFunction, Registry, is_foreign, keywords_taken, name_of
from trundle.robots import Robot
from trundle.values import as_array, check_kind

_SAME_TIME_S = 1e-6  # a clock that was added up differs by its last digits

LOCALIZERS: Registry[Localizer] = Registry(
    "localizer",
    "trundle.localizers",
    {
        "amcl": "trundle.localization.amcl.amcl_localizer:AmclLocalizer",
        "odometry": "trundle.localization.odometry:OdometryLocalizer",
        "slam": "trundle.mapping.slam_localizer:SlamLocalizer",
    },
    contract=Contract({"reset": "pose", "update": "observation"}, function=("observation",)),
)


class SomeLocalizer(Protocol):
    """The least that an object needs to be used as a localizer; `create_localizer` makes a `Localizer` of it."""

    def reset(self, pose: Pose2D, /) -> None:
        """Start over with the robot at `pose`, map frame."""
        ...

    def update(self, observation: Observation, /) -> Estimate | Pose2D:
        """Return where the robot is after one more observation."""
        ...


@runtime_checkable
class Localizer(Protocol):
    """Estimates a robot's pose. It may also be a function, or return poses alone: see `LocalizerLike`.

    It gets observations only, never the truth of a simulation. `reset` and `update` are all that a localizer must have;
    its `reset` may take the pose alone, or the keywords that it needs. One without `reinitialize_global` gets it from
    here, and is never started without a pose.

    One that makes a map while it drives also has `map`, `corrections` and `finish`; those of the others say that there
    is none.

    Attributes:
        corrections: How often what it has mapped before has been moved, such as by a loop that was closed, or its map
            is another one. Whoever has put something beside its map then forgets that. It never goes back, and is 0
            where the localizer makes no map.
    """

    corrections: int = 0

    def reset(self, pose: Pose2D | None, *, covariance: FloatArray | None = None, seed: int = 0) -> None:
        """Start over. The same seed and observations give the same estimates.

        Args:
            pose: Where the robot is, map frame; None where that is not known: it may be anywhere on the map.
            covariance: Of (x, y, yaw) of the pose [m², rad²], shape (3, 3); None where the pose is exact.
            seed: Of its random numbers.

        Raises:
            InputError: If there is no pose, and the localizer cannot find one; or the covariance is none.
        """
        ...

    def update(self, observation: Observation) -> Estimate:
        """Return where the robot is after one more observation; its time is the observation's.

        Raises:
            InputError: If the time of the observation is not after the last one.
        """
        ...

    def relocate(self, pose: Pose2D, *, covariance: FloatArray | None = None, seed: int = 0) -> None:
        """Take in a run that the robot is at `pose`; see `reset`, which this is by default.

        A localizer that makes its map keeps the map, and goes on there.
        """
        self.reset(pose, covariance=covariance, seed=seed)

    def reinitialize_global(self) -> None:
        """Forget the pose: the robot may be anywhere on the map. By default a localizer cannot.

        Raises:
            InputError: If the localizer cannot find a pose by itself.
        """
        raise InputError("this localizer cannot find by itself where the robot is: give it a pose")

    def map(self) -> OccupancyGrid | None:
        """Return the map that it has made so far; a session asks about once a second, of simulated time.

        It grows with each scan, and its origin may move; its yaw is 0. By default a localizer makes no map: None.
        """
        return None

    def finish(self) -> None:
        """Take that the run is over: do for the map what takes long. By default there is nothing to do."""


LocalizerLike: TypeAlias = str | Choice | SomeLocalizer | Callable[..., object]
"""Whatever estimates the pose: a name, `"module:name"`, an object with `reset` and `update`, a class of such objects,
or a function (observation). What is returned is an `Estimate`, or a `Pose2D`, which is one at the time of the
observation. A class is made with those of `map`, `robot` and the options that its parameters name."""


def localizer_names() -> list[str]:
    """Return the names that `create_localizer` takes, sorted."""
    return LOCALIZERS.names()


def create_localizer(localizer: LocalizerLike, grid: OccupancyGrid | None, robot: Robot, **options: Any) -> Localizer:
    """Make a localizer of whatever estimates a pose.

    One of another package is wrapped, so that it can be used like any other and always returns an `Estimate`.

    Args:
        localizer: A name, a class, a function or an object; see `LocalizerLike`.
        grid: The map, which a class gets as `map`; None where the robot has none.
        robot: The robot.
        options: Of the localizer; more than those of a `Choice`.

    Raises:
        UnknownNameError: If there is no localizer of that name.
        InputError: If it does not take these options, is no localizer, or needs a map and there is none.
    """
    check_kind(robot, Robot, "a localizer's robot", "Robot.load(name) makes one")
    _, given, chosen = split_choice(localizer)
    made = LOCALIZERS.resolve(given, {"map": grid, "robot": robot, "grid": grid}, {**chosen, **options})
    return LocalizerAdapter(made) if isinstance(made, PluginFunction) or is_foreign(made) else made


class LocalizerAdapter(Localizer):
    """Gives a localizer of another package, or a function, the whole protocol, and checks what it returns.

    Args:
        localizer: An object with `reset` and `update`, or a function.

    Attributes:
        localizer: The same; of a function, the function itself.
    """

    def __init__(self, localizer: Any) -> None:
        is_function = isinstance(localizer, PluginFunction)
        self.localizer: Any = localizer.function if is_function else localizer
        self._estimate: Callable[[Observation], Any] = localizer if is_function else localizer.update
        self._reset: Callable[..., Any] | None = None if is_function else localizer.reset
        self._search = None if is_function else getattr(localizer, "reinitialize_global", None)
        for name in () if is_function else ("map", "finish"):
            if callable(own := getattr(localizer, name, None)):
                setattr(self, name, own)
        self._time: float | None = None

    def reset(self, pose: Pose2D | None, *, covariance: FloatArray | None = None, seed: int = 0) -> None:
        """Start over; see `Localizer`. A function keeps nothing; a `reset` without a keyword is called without it."""
        if pose is None and self._search is None:
            raise InputError(f"localizer {name_of(self.localizer)!r} has no reinitialize_global(): it needs a start")
        self._time = None
        if self._reset is not None:
            _tell(self._reset, pose, covariance, seed)

    def relocate(self, pose: Pose2D, *, covariance: FloatArray | None = None, seed: int = 0) -> None:
        """Take in a run that the robot is at `pose`; see `Localizer`. One without `relocate` starts over there."""
        if callable(own := getattr(self.localizer, "relocate", None)):
            self._time = None
            _tell(own, pose, covariance, seed)
        else:
            self.reset(pose, covariance=covariance, seed=seed)

    def reinitialize_global(self) -> None:
        """Forget the pose; see `Localizer`."""
        if self._search is None:
            raise InputError(f"localizer {name_of(self.localizer)!r} has no reinitialize_global(): give it a pose")
        self._search()

    @property
    def corrections(self) -> int:  # type: ignore[override]
        """How often what was mapped before has been moved; see `Localizer`."""
        return getattr(self.localizer, "corrections", 0)

    def update(self, observation: Observation) -> Estimate:
        """Return where the robot is; see `Localizer`.

        Raises:
            InputError: If the time of the observation is not after the last one, or the localizer returns neither a
                pose nor an estimate for this time.
        """
        time = observation.time
        if self._time is not None and not time > self._time:
            raise InputError(f"times must increase: an observation of {time:g} s came after one of {self._time:g} s")
        found = self._estimate(observation)
        self._time = time
        if isinstance(found, Pose2D):
            return Estimate(time, found, None, found @ observation.odometry.inverse())
        if not isinstance(found, Estimate):
            raise wrong_result(
                f"localizer {name_of(self.localizer)!r} returned {found!r}: a localizer returns an Estimate, or a "
                "Pose2D in the map frame",
                self.localizer,
                "update",
                kind="localizer",
            )
        if not abs(found.time - time) <= _SAME_TIME_S:
            raise wrong_result(
                f"localizer {name_of(self.localizer)!r} returned an estimate of {found.time:g} s for an observation of "
                f"{time:g} s: an estimate has the time of its observation, and its pose is that of then",
                self.localizer,
                "update",
                kind="localizer",
            )
        return found


def _tell(call: Callable[..., Any], pose: Pose2D | None, covariance: FloatArray | None, seed: int) -> None:
    """Call with a pose, and with those of the keywords that are taken."""
    given = {"covariance": covariance, "seed": seed}
    call(pose, **{name: given[name] for name in keywords_taken(call, tuple(given))})


def makes_map(localizer: Localizer) -> bool:
    """Whether a localizer makes a map while it drives: it defines `map`."""
    return getattr(localizer.map, "__func__", None) is not Localizer.map


def check_covariance(value: object, of: str) -> FloatArray:
    """Return the covariance of (x, y, yaw) of something as an array [m², rad²], shape (3, 3).

    Raises:
        InputError: If it has another shape, a number is not finite, or it is not symmetric or not positive
            semidefinite.
    """
    matrix = as_array(value, np.float64, f"the covariance of {of}")
    if matrix.shape != (3, 3) or not np.isfinite(matrix).all():
        raise InputError(f"the covariance of {of} needs 3 x 3 finite numbers, of (x, y, yaw); got shape {matrix.shape}")
    scale = float(np.abs(matrix).max())
    if np.abs(matrix - matrix.T).max() > 1e-9 * scale or np.linalg.eigvalsh(matrix).min() < -1e-9 * scale:
        raise InputError(
            f"the covariance of {of} is not symmetric, or not positive semidefinite: give variances of x, y [m²] and "
            f"yaw [rad²] on the diagonal, got {matrix.tolist()}"
        )
    return matrix
