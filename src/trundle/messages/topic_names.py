"""Names of topics that recordings, the network and parameter files share."""

from __future__ import annotations

from trundle.robots import Robot


def scan_topic(lidar: str, robot: Robot) -> str:
    """Topic of a lidar: /scan where the robot has one alone, else /<its name>/scan."""
    return "/scan" if list(robot.lidars) == [lidar] else f"/{lidar}/scan"
