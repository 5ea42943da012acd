"""`Path`: the result of a planner, followed by a controller."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError
from trundle.geometry import FloatArray, Pose2D, format_pose, path_length, wrap_angle
from trundle.values import as_array

PathStatus = Literal["found", "partial"]
"""Whether a path reaches its goal, or ends as near to it as possible."""


@dataclass(frozen=True, slots=True)
class Path:
    """Poses to drive through, in order.

    Two consecutive poses at the same position with different yaws are a turn in place, in the direction of the smaller
    angle; a turn of more than π is given as several of them. Between poses at different positions the robot drives in
    a straight line, forward unless `backward` says otherwise.

    Attributes:
        poses: (x, y, yaw) [m, m, rad] in the map frame, shape (N, 3), N ≥ 1, read-only. The first is the start, the
            last is the goal.
        cost: The cost that the planner minimised, in the planner's unit; NaN if it has none.
        planner: Name of the planner.
        replans: How often the planner had to plan again because the footprint hit something.
        start_snapped_m: How far the start was moved to free space [m].
        goal_snapped_m: How far the goal was moved to free space [m].
        status: "found", or "partial" if the goal cannot be reached and the path leads as near to it as possible.
            Planners return partial paths only on request.
        remaining_m: Straight distance from the end of a partial path to the goal [m].
        backward: Whether each leg between two poses is driven in reverse, shape (N − 1,), read-only; by default all
            legs are driven forward.

    Raises:
        InputError: If the poses are not (N, 3) finite numbers with N ≥ 1, the length of `backward` does not match, or
            the status is unknown.
    """

    poses: FloatArray
    cost: float = math.nan
    planner: str = ""
    replans: int = 0
    start_snapped_m: float = 0.0
    goal_snapped_m: float = 0.0
    backward: npt.NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, dtype=np.bool_))
    status: PathStatus = "found"
    remaining_m: float = 0.0
    length: float = field(init=False)
    """Length [m] of the polyline through the poses."""

    def __post_init__(self) -> None:
        poses = as_array(self.poses, np.float64, "the poses of a path")
        if poses.ndim != 2 or poses.shape[1] != 3 or len(poses) == 0:
            raise InputError(f"a path needs poses of shape (N, 3) with N ≥ 1, got {poses.shape}")
        if not np.isfinite(poses).all():
            raise InputError("a path needs finite poses")
        if self.status not in ("found", "partial"):
            raise InputError(f"the status of a path is 'found' or 'partial', got {self.status!r}")
        poses.flags.writeable = False
        legs = len(poses) - 1
        backward = as_array(self.backward, np.bool_, "backward of a path")
        if backward.size == 0:
            backward = np.zeros(legs, np.bool_)
        if backward.shape != (legs,):
            raise InputError(f"a path of {legs + 1} poses has {legs} legs, got backward of shape {backward.shape}")
        backward.flags.writeable = False
        object.__setattr__(self, "poses", poses)
        object.__setattr__(self, "backward", backward)
        object.__setattr__(self, "length", path_length(poses))

    def __len__(self) -> int:
        return len(self.poses)

    def __repr__(self) -> str:
        by = f", by {self.planner}" if self.planner else ""
        partial = f", partial: {self.remaining_m:.4g} m remain" if self.status == "partial" else ""
        ends = f"{format_pose(self.start)} to {format_pose(self.goal)}"
        return f"Path({self.length:.4g} m, {len(self)} poses, {ends}{by}{partial})"

    def _repr_png_(self) -> bytes:
        """Show a picture in notebooks, with north up; legs driven in reverse are orange."""
        from trundle.pictures.figure import to_png
        from trundle.pictures.plan import draw_path

        title = f"Path by {self.planner}" if self.planner else "Path"
        lines = [f"{self.length:.2f} m, {len(self)} poses"]
        if self.status == "partial":
            lines.append(f"partial: {self.remaining_m:.2f} m remain to the goal")
        if self.backward.any():
            lines.append("orange: driven in reverse")
        return to_png(draw_path(self.poses, self.backward, title, lines))

    @property
    def start(self) -> Pose2D:
        """The first pose."""
        return _pose(self.poses[0].tolist())

    @property
    def goal(self) -> Pose2D:
        """The last pose."""
        return _pose(self.poses[-1].tolist())


def _pose(numbers: list[float]) -> Pose2D:
    """Return a pose of a path, with its yaw wrapped: yaws may add up over the turns of a path."""
    x, y, yaw = numbers
    return Pose2D(x, y, wrap_angle(yaw))
