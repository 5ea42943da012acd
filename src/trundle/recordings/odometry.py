"""`OdometryTrack`: a recorded robot's odometry over time, and where it is broken."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray, Pose2D, Twist2D, wrap_angle, wrap_angles

_LONGEST_GAP_S = 0.5
_STILL_M, _STILL_RAD = 0.05, 0.05  # over a gap: nobody drove
_FORWARD_S = 0.1  # a scan may end a little after the last sample
_FASTEST_MPS, _FASTEST_RADPS = 10.0, 10.0  # no robot that maps a building is faster
_JUMP_M, _JUMP_RAD = 0.3, 0.5  # a rounded time or a late message looks like a smaller jump


class OdometryTrack:
    """Poses of base_link in a frame that does not jump, over time.

    Args:
        times: Increasing [s], shape (N,), one or more.
        poses: (x, y, yaw) [m, rad], shape (N, 3).
        is_sampled: Whether the poses are those of the scans, so that gaps between them do not matter.
    """

    def __init__(self, times: FloatArray, poses: FloatArray, *, is_sampled: bool = False) -> None:
        self.times = times
        self.poses = np.array(poses, dtype=np.float64)
        self.poses[:, 2] = np.unwrap(self.poses[:, 2])
        self._is_sampled = is_sampled

    def knows(self, began: float, ended: float) -> bool:
        """Return whether it says where the robot was from one time [s] to another."""
        times = self.times
        if began < times[0] - 1e-9 or ended > times[-1] + _FORWARD_S:
            return False
        if self._is_sampled:
            return True
        first = max(0, int(np.searchsorted(times, began, side="right")) - 1)
        last = min(len(times) - 1, int(np.searchsorted(times, ended)))
        gaps = np.diff(times[first : last + 1])
        if not len(gaps) or gaps.max() <= _LONGEST_GAP_S:
            return True
        moved = np.abs(self.poses[last] - self.poses[first])
        return bool(moved[:2].max() < _STILL_M and moved[2] < _STILL_RAD)

    def at(self, time: float) -> tuple[Pose2D, Twist2D]:
        """Return pose and twist at a time [s], interpolated."""
        times, poses = self.times, self.poses
        if len(times) == 1:
            return _as_pose(poses[0]), Twist2D(0.0, 0.0)
        after = min(max(1, int(np.searchsorted(times, time))), len(times) - 1)
        seconds = times[after] - times[after - 1]
        share = (time - times[after - 1]) / seconds
        step = poses[after] - poses[after - 1]
        pose = _as_pose(poses[after - 1] + min(max(share, 0.0), 1.5) * step)
        forward = (step[0] * np.cos(pose.yaw) + step[1] * np.sin(pose.yaw)) / seconds
        return pose, Twist2D(float(forward), float(step[2] / seconds))

    def between(self, after: float, until: float, period: float) -> list[float]:
        """Return times of samples after one time and before another [s], about a period apart."""
        first = int(np.searchsorted(self.times, after + period / 2, side="right"))
        last = int(np.searchsorted(self.times, until - period / 2))
        if last <= first:
            return []
        found: list[float] = []
        for time in self.times[first:last].tolist():
            if not found or time >= found[-1] + period * 0.95:
                found.append(time)
        return found

    @property
    def fastest(self) -> tuple[float, float]:
        """Highest speed and turning rate [m/s, rad/s] over half a second."""
        if len(self.times) < 2:
            return 0.0, 0.0
        later = np.minimum(np.searchsorted(self.times, self.times + 0.5), len(self.times) - 1)
        seconds = np.maximum(self.times[later] - self.times, 0.5)
        step = self.poses[later] - self.poses
        return float((np.hypot(step[:, 0], step[:, 1]) / seconds).max()), float((np.abs(step[:, 2]) / seconds).max())


def find_jumps(times: FloatArray, poses: FloatArray) -> npt.NDArray[np.intp]:
    """Return the indices of samples that no robot reaches from the ones before.

    Args:
        times: Increasing [s], shape (N,).
        poses: (x, y, yaw) [m, rad], shape (N, 3).
    """
    seconds = np.diff(times)
    step = np.hypot(np.diff(poses[:, 0]), np.diff(poses[:, 1]))
    turn = np.abs(wrap_angles(np.diff(poses[:, 2])))
    jumps = (step > _JUMP_M + _FASTEST_MPS * seconds) | (turn > _JUMP_RAD + _FASTEST_RADPS * seconds)
    return np.flatnonzero(jumps) + 1


def _as_pose(row: FloatArray) -> Pose2D:
    x, y, yaw = row.tolist()
    return Pose2D(x, y, wrap_angle(yaw))
