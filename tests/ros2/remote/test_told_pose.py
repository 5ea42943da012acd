"""A robot that makes its map, and is told where it is on it: the map stays."""

from __future__ import annotations

from dataclasses import replace

from mapping.rooms import drive, ring
from trundle import Robot
from trundle.mapping.slam_localizer import SlamLocalizer
from trundle.ros2.remote.localizer import RemoteLocalizer


def test_a_robot_that_was_carried_and_is_told_where_it_is_goes_on_with_its_map() -> None:
    inner = SlamLocalizer(Robot.load("nova_carter"))
    localizer = RemoteLocalizer(inner, ring(0.0), lambda: True, needs_scan=True)
    localizer.reset(None)  # the run begins, which says nothing
    for _, observation in drive([ring(i / 180) for i in range(40)]):
        localizer.update(observation)
    nodes = len(inner.graph().times)
    assert localizer.is_located
    localizer.doubt()
    assert not localizer.is_located
    localizer.reset(ring(0.6))
    for truth, observation in drive([ring(0.6 + i / 180) for i in range(10)], begin_s=100.0):
        found = localizer.update(replace(observation, odometry=ring(0.6) @ observation.odometry))
        assert localizer.is_located
        assert found.pose.distance_to(truth) < 0.1
    assert len(inner.graph().times) > nodes
