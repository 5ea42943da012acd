"""What contacts and beams keep from one place to the next changes no answer."""

import math

import numpy as np
import pytest

from trundle.geometry import Pose3D
from trundle.geometry.solids import Box, OccupancyCells, Solid
from trundle.robots import Robot
from trundle.sim.beams import WorldOutline
from trundle.sim.footprint import FootprintChecker, free_squares
from trundle.worlds import World

ROBOT = Robot.load("nova_carter")
ANGLES = np.linspace(-math.pi, math.pi, 90)


def boxes(count, seed=0):
    places = np.random.default_rng(seed).uniform(-9.0, 9.0, (count, 3)).tolist()
    return [
        Solid(f"box {i}", Box((0.3, 0.5, 1.0)), Pose3D.planar(x, y, 0.5, yaw)) for i, (x, y, yaw) in enumerate(places)
    ]


def cells(share):
    blocked = np.random.default_rng(1).random((300, 320)) < share
    return Solid("cells", OccupancyCells(blocked, 0.06, 1.0), Pose3D.planar(-8.0, -9.5, 0.0, 0.3))


WORLDS = {
    "boxes": World("boxes", tuple(boxes(60))),
    "many boxes": World("many boxes", tuple(boxes(1500))),
    "cells": World("cells", (cells(0.001),)),
    "both": World("both", (*boxes(40), cells(0.0004))),
}


def drive():
    """Poses of control periods, on and beside the world; between two of them the robot is placed elsewhere."""
    rng = np.random.default_rng(2)
    for _ in range(60):
        x, y, yaw = rng.uniform((-11.0, -11.0, -3.0), (11.0, 11.0, 3.0))
        for _ in range(8):
            poses = []
            for _ in range(4):
                x, y, yaw = x + 0.1 * math.cos(yaw), y + 0.1 * math.sin(yaw), yaw + 0.02
                poses.append((float(x), float(y), float(yaw)))
            yield poses


@pytest.mark.parametrize("name", WORLDS)
def test_contacts_are_those_of_a_new_checker(name):
    world = WORLDS[name]
    checker, new, found = FootprintChecker(world, ROBOT), FootprintChecker(world, ROBOT), 0
    new._is_clear_of = lambda *_: False  # look at the cells themselves
    for poses in drive():
        new._looked_at = math.inf, -math.inf, math.inf, -math.inf  # as it begins
        contacts = checker.find(poses)
        assert contacts == new.find(np.array(poses))
        found += len(contacts)
    assert found > 0


@pytest.mark.parametrize("name", WORLDS)
def test_beams_are_those_of_a_new_outline(name):
    world = WORLDS[name]
    outline, new = WorldOutline(world, 0.4), WorldOutline(world, 0.4)
    new._segments_around = lambda *_: new.segments
    for poses in drive():
        x, y, yaw = poses[-1]
        assert outline.cast(x, y, ANGLES + yaw, 3.0).tobytes() == new.cast(x, y, ANGLES + yaw, 3.0).tobytes()


def test_the_field_of_cells_is_kept_as_long_as_they_are():
    blocked = np.zeros((4, 4), np.bool_)
    first = free_squares(blocked)
    assert free_squares(blocked) is first
    assert free_squares(blocked.copy()) is not first
