import math

import trundle
from trundle import Costmap, Path, Pose2D, Twist2D


def turn_and_drive(pose: Pose2D, twist: Twist2D, costmap: Costmap, dt: float, path: Path) -> Twist2D:
    if pose.distance_to(path.goal) < 0.2:
        return Twist2D()
    left = path.poses[int(((path.poses[:, :2] - (pose.x, pose.y)) ** 2).sum(axis=1).argmin()) :, :2]
    x, y = pose.inverse().transform_points(left[:15])[-1]
    angle = math.atan2(y, x)
    return Twist2D(0.5 if abs(angle) < 0.5 else 0.0, max(-0.7, min(0.7, 2.0 * angle)))


scenario = trundle.Scenario.make(world="warehouse", start=(8.0, 7.4), goal=(12.0, 7.4), controller=turn_and_drive)
with scenario.build() as mission:
    print(mission.run().outcome)
