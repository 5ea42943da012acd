"""Beams of a lidar of several rings."""

import math

import numpy as np
import pytest

from trundle.geometry import Pose2D, Pose3D
from trundle.geometry.solids import Box, Solid
from trundle.sim import MoverState
from trundle.sim.mujoco.ring_beams import RingBeams
from trundle.worlds import World
from trundle.worlds.movers import Crowd

WALL = Solid("wall", Box((0.2, 10.0, 1.0)), Pose3D((3.1, 0.0, 0.5)))


def direction(rise, turn=0.0):
    rise, turn = math.radians(rise), math.radians(turn)
    return [math.cos(rise) * math.cos(turn), math.cos(rise) * math.sin(turn), math.sin(rise)]


def test_beams_meet_a_wall_the_floor_and_nothing():
    beams = np.array([direction(0.0), direction(5.0), direction(20.0), direction(-30.0), direction(0.0, 180.0)])
    found = RingBeams(World("wall", (WALL,))).cast((0.0, 0.0, 0.5), beams, 20.0)
    over = math.inf
    assert found == pytest.approx([3.0, 3.0 / math.cos(math.radians(5.0)), over, 1.0, over], rel=1e-6)


def test_what_is_out_of_reach_is_not_seen():
    found = RingBeams(World("wall", (WALL,))).cast((0.0, 0.0, 0.5), np.array([direction(0.0)]), 2.9)
    assert found.tolist() == [math.inf]


def test_movers_are_where_they_are_now():
    world = World("crowd", (WALL,), movers=(Crowd("people", count=1, seed=0),))
    beams = RingBeams(world)
    name = "people_1"
    ahead = np.array([direction(0.0)])
    near = beams.cast((0.0, 0.0, 0.5), ahead, 20.0, [MoverState(name, Pose2D(1.5, 0.0))])
    away = beams.cast((0.0, 0.0, 0.5), ahead, 20.0, [MoverState(name, Pose2D(1.5, 4.0))])
    assert 1.0 < near[0] < 1.5
    assert away[0] == pytest.approx(3.0, rel=1e-6)
