"""Where a bag's lidars are on the robot, and its odometry: by its transforms."""

from __future__ import annotations

import math

import numpy as np

from trundle.bags.transforms import TransformTree
from trundle.geometry import FloatArray
from trundle.recordings.bag_survey import LidarSurvey, Survey
from trundle.recordings.remarks import Remarks
from trundle.robots import Robot

_BASES = ("base_link", "base_footprint")
_MOST_TILT = math.cos(math.radians(15.0))


def find_base(survey: Survey) -> str:
    """Return the frame of the robot's base: the odometry's child, else by its usual names."""
    frames = survey.tree.frames
    if survey.odometry is not None and survey.odometry.child:
        return survey.odometry.child
    for name in _BASES:
        fitting = [frame for frame in frames if frame.rsplit("/", 1)[-1] == name]
        if fitting:
            return min(fitting, key=len)
    for lidar in survey.lidars.values():  # the last frame above a lidar that is fixed to it
        chain = survey.tree.chain_to_root(lidar.frame)
        fixed = [frame for frame in chain if survey.tree.static(lidar.frame, frame) is not None]
        if fixed:
            return fixed[-1]
    return _BASES[0]


def find_odometry_frame(survey: Survey, base: str) -> str | None:
    """Return the frame in which transforms say continuously where the base is; None where there is none."""
    above = survey.tree.chain_to_root(base)[1:]
    moving = [frame for frame in above if survey.tree.static(base, frame) is None]
    named = [frame for frame in moving if "odom" in frame.rsplit("/", 1)[-1]]
    return (named or moving or [None])[0]


def find_mount(
    survey: Survey, lidar: LidarSurvey, base: str, robot: Robot | None, remarks: Remarks
) -> FloatArray | None:
    """Return the pose of a lidar in the base, shape (4, 4): by the transforms, else by the robot's file.

    None where it cannot be told, or the lidar does not look along the floor; a remark says so.
    """
    found = _fixed_pose(survey.tree, lidar.frame, base)
    if found is None and robot is not None:
        by_name = [one for name, one in robot.lidars.items() if name in (lidar.frame, lidar.topic.strip("/"))]
        own = by_name or [one for name, one in robot.lidars.items() if name in f"{lidar.topic}/{lidar.frame}"]
        own = own or (list(robot.lidars.values()) if len(robot.lidars) == len(survey.lidars) == 1 else [])
        if own:
            x, y, yaw = own[0].x, own[0].y, own[0].yaw
            found = np.eye(4)
            found[:2, :2] = ((math.cos(yaw), -math.sin(yaw)), (math.sin(yaw), math.cos(yaw)))
            found[:3, 3] = x, y, own[0].z
            remarks.note(f"no transform says where {lidar.frame!r} is on the robot: the robot's own file does")
    if found is None and len(survey.lidars) == 1:
        remarks.note(
            f"no transform says where {lidar.frame!r} is on the robot: taken to be in its middle and to look forward; "
            "record /tf_static too, or give the robot with --robot"
        )
        return np.eye(4)
    if found is None:
        remarks.note(
            f"scans of {lidar.topic} are left out: no transform says where {lidar.frame!r} is on the robot "
            f"({base!r}); record /tf_static too"
        )
    elif abs(found[2, 2]) < _MOST_TILT:
        degrees = math.degrees(math.acos(min(1.0, abs(float(found[2, 2])))))
        remarks.note(f"scans of {lidar.topic} are left out: {lidar.frame!r} is tilted by {degrees:.0f}°")
        return None
    elif found[2, 2] < 0.0:
        remarks.note(f"{lidar.frame!r} is mounted upside down: its beams turn the other way round")
    return found


def _fixed_pose(tree: TransformTree, frame: str, base: str) -> FloatArray | None:
    """Return the pose of a frame in another one to which it is fixed, by way of any frame above both."""
    if frame == base:
        return np.eye(4)
    above = tree.chain_to_root(base)
    for ancestor in tree.chain_to_root(frame):
        if ancestor in above:
            mine, other = tree.static(frame, ancestor), tree.static(base, ancestor)
            return None if mine is None or other is None else np.linalg.inv(other) @ mine
    return None
