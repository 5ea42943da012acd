"""`SlamLocalizer`: the localizer `slam`, whose estimates come from a mapper, and whose map grows."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray, Pose2D
from trundle.localization.blind_driving import BlindDriving
from trundle.localization.localizer import Localizer
from trundle.mapping.mapper import Mapper
from trundle.mapping.pose_graph import PoseGraph
from trundle.maps import OccupancyGrid
from trundle.observation import Estimate, Observation
from trundle.robots import Robot


class SlamLocalizer(Localizer):
    """Maps what the robot drives through, and says where it is on that map.

    The map frame is the one of the start that it is told. Without a start the map begins where the robot stands. It
    needs scans: before the first one, the pose is where the odometry says, and a robot that drives on is lost.

    Args:
        robot: The robot, with its lidars.

    Attributes:
        mapper: The mapper; another one after each reset.
    """

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self.mapper = Mapper(robot)
        self._blind = BlindDriving(robot, "slam")
        self.reset(None)

    def reset(self, pose: Pose2D | None, *, covariance: FloatArray | None = None, seed: int = 0) -> None:
        """Forget the map, and begin another one at `pose`; see `Localizer`. The covariance has no use here.

        A start that is off moves the whole map by as much: nothing but the start says where the map's frame is.
        """
        before = self.mapper.revision
        self.mapper = Mapper(self._robot, seed=seed)
        self.mapper.revision = before
        self.mapper.reset(Pose2D(0.0, 0.0) if pose is None else pose)
        self._has_scans = False
        self._blind.reset()

    def relocate(self, pose: Pose2D, *, covariance: FloatArray | None = None, seed: int = 0) -> None:
        """Go on at `pose` of the map that is there; see `Localizer` and `Mapper.relocate`."""
        self.mapper.relocate(pose, covariance)

    def update(self, observation: Observation) -> Estimate:
        """Return where the robot is; see `Localizer`.

        Warns:
            SensorWarning: If the robot drives without scans, or its scans or its odometry cannot be used.
        """
        estimate = self._blind.judge(observation, self.mapper.update(observation))
        self._has_scans = self._has_scans or len(observation.scans) > 0
        return estimate

    @property
    def corrections(self) -> int:  # type: ignore[override]
        """How often the map has changed by more than what is new; see `Mapper.revision`."""
        return self.mapper.revision

    def map(self) -> OccupancyGrid | None:
        """Return the map so far; None before the first scan."""
        return self.mapper.grid() if self._has_scans else None

    def graph(self) -> PoseGraph:
        """Return what the map is drawn from: poses, scans, and the edges between them."""
        return self.mapper.graph()

    def track(self) -> tuple[FloatArray, npt.NDArray[np.int32]]:
        """Return the poses alone [m, rad], shape (N, 3), and which of them loops join, shape (M, 2)."""
        return self.mapper.track()

    def finish(self) -> None:
        """Optimize the pose graph to its end, and draw the map from all scans."""
        self.mapper.finish()
