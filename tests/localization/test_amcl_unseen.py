"""What the localizer amcl makes of things that its map draws and no lidar sees, and of boxes all round the robot."""

from __future__ import annotations

import math

import numpy as np
import pytest

from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.geometry.solids import Box, Solid
from trundle.localization import create_localizer
from trundle.localization.amcl.amcl_settings import AmclSettings
from trundle.localization.amcl.beams import Beams
from trundle.localization.amcl.hypotheses import Hypotheses
from trundle.localization.amcl.map_field import MapField
from trundle.maps import OccupancyGrid
from trundle.mission import sample_mission
from trundle.navigation import Navigator
from trundle.robots import Robot
from trundle.sim.kinematic import KinematicSimulator
from trundle.worlds import World

DT = 0.05


@pytest.fixture(scope="module")
def robot():
    loaded = Robot.load("nova_carter")
    lidars = {name: lidar.model_copy(update={"rate": 10.0, "noise": 0.02}) for name, lidar in loaded.lidars.items()}
    return loaded.model_copy(update={"lidars": lidars})


def follow(world, grid, robot, start, told, steps, command):
    """Errors [m] and states of a robot that drives in a world with a map."""
    localizer = create_localizer("amcl", grid, robot)
    localizer.reset(told)
    errors, states = [], []
    with KinematicSimulator(world, robot, lidar=True) as sim:
        state = sim.reset(start, seed=3)
        for step in range(steps):
            estimate = localizer.update(state.observation)
            errors.append(estimate.pose.distance_to(state.pose))
            states.append(estimate.state)
            state = sim.step(command(step), DT)
    return np.array(errors), states


def solid(name, size, at, height=1.5):
    return Solid(name, Box((*size, height)), Pose3D((*at, 0.5 * height)))


def yard():
    """Grass with a low kerb round a court of 12 by 10 m, a fence 0.8 m behind the kerb, and four vans."""
    parts = []
    for sign, name in ((1.0, "north"), (-1.0, "south")):
        parts.append(solid(f"grass_{name}", (15.0, 1.5), (0.0, sign * 5.75), 0.15))
        parts.append(solid(f"fence_{name}", (13.6, 0.1), (0.0, sign * 5.85)))
    for sign, name in ((1.0, "east"), (-1.0, "west")):
        parts.append(solid(f"grass_{name}", (1.5, 10.0), (sign * 6.75, 0.0), 0.15))
        parts.append(solid(f"fence_{name}", (0.1, 11.6), (sign * 6.85, 0.0)))
    vans = ((-3.0, 2.5), (2.0, 3.0), (3.5, -1.0), (-1.0, -3.5))
    return World("yard", (*parts, *(solid(f"van_{i}", (1.6, 1.0), at) for i, at in enumerate(vans))))


def test_a_fence_seen_behind_a_kerb_does_not_move_the_estimate(robot):
    world, start = yard(), Pose2D(0.0, 0.0, 0.5)
    grid = OccupancyGrid.from_world(world, resolution=0.05, z_range=robot.z_range)
    errors, states = follow(world, grid, robot, start, start, 400, lambda step: Twist2D(0.4, 0.25))
    assert errors[40:].max() < 0.15
    assert states[200:].count("localized") > 190


@pytest.mark.parametrize("seed", [0, 2, 3, 6])
def test_boxes_all_round_the_robot_do_not_move_the_estimate(robot, seed):
    world = World.generate("warehouse", seed=1)
    grid = OccupancyGrid.from_world(world, resolution=0.05, z_range=robot.z_range)
    start, _ = sample_mission(Navigator(grid, robot).costmap, seed=seed)
    rng = np.random.default_rng(seed)
    count, radius, first = int(rng.integers(6, 8)), rng.uniform(1.6, 2.2), rng.uniform(0.0, 6.3)
    angles = first + 2.0 * math.pi * np.arange(count) / count
    places = [(start.x + radius * math.cos(one), start.y + radius * math.sin(one)) for one in angles]
    boxes = [solid(f"ring_{i}", (1.0, 1.0), at, 1.0) for i, at in enumerate(places)]
    ring = World("ring", (*world.solids, *boxes))
    errors, _ = follow(ring, grid, robot, start, start, 300, lambda step: Twist2D(0.0, 0.5 if step > 100 else 0.0))
    assert errors.max() < 0.2


ROOM = np.zeros((160, 160), np.int8)
ROOM[:20] = ROOM[-20:] = 100
ROOM[:, :20] = ROOM[:, -20:] = 100  # a room of 6 by 6 m


def beams_of_room(factors):
    """Beams from the middle of the room that end at so many times the distance of its walls."""
    angles = np.linspace(-np.pi, np.pi, 60, endpoint=False)
    ways = np.column_stack((np.cos(angles), np.sin(angles)))
    lengths = factors * 3.0 / np.abs(ways).max(axis=1)
    return Beams(ways * lengths[:, np.newaxis], np.zeros((60, 2)))


@pytest.mark.parametrize(
    ("some", "others", "state"), [(1.25, 1.25, "localized"), (0.5, 0.5, "localized"), (0.5, 1.25, "lost")]
)
def test_beams_that_are_short_or_through_contradict_the_map_only_together(some, others, state):
    settings = AmclSettings()
    hypotheses = Hypotheses(MapField(OccupancyGrid(ROOM, 0.05), settings), settings)
    hypotheses.start(Pose2D(4.0, 4.0, 0.0), np.diag((1e-6, 1e-6, 1e-6)), confirmed=True)
    factors = np.ones(60)
    factors[::3], factors[1::3] = some, others
    for _ in range(20):
        hypotheses.compare(beams_of_room(factors), 0.1, idea=None, targets=None, wide=False)
    assert hypotheses.state == state


def test_places_near_each_other_are_shown_as_one():
    settings = AmclSettings()
    hypotheses = Hypotheses(MapField(OccupancyGrid(ROOM, 0.05), settings), settings)
    hypotheses.start(Pose2D(4.0, 4.0, 0.0), np.eye(3), confirmed=False)
    beams = beams_of_room(np.ones(60))
    hypotheses.compare(beams, 0.0, idea=None, targets=None, wide=False)
    hypotheses.propose(beams, [Pose2D(4.0, 4.0, 0.5 * math.pi)], is_far=True)
    near = hypotheses.others[0]
    near.pose = Pose2D(4.2, 4.0, 0.1)
    assert len(hypotheses.tracks) == 2
    assert [round(share, 6) for _, share in hypotheses.places()] == [1.0]
    near.pose = Pose2D(4.0, 4.0, math.pi)
    assert len(hypotheses.places()) == 2


def hall(*more):
    """A hall of 12 by 10 m with four vans."""
    walls = [
        *(solid(f"wall_{k}", (12.2, 0.2), (0.0, y)) for k, y in enumerate((-5.1, 5.1))),
        *(solid(f"end_{k}", (0.2, 10.4), (x, 0.0)) for k, x in enumerate((-6.1, 6.1))),
    ]
    vans = ((-3.0, 2.5), (2.0, 3.0), (3.5, -1.0), (-1.0, -3.5))
    return World("hall", (*walls, *(solid(f"van_{i}", (1.6, 1.0), at) for i, at in enumerate(vans)), *more))


def test_a_robot_knows_where_it_is_in_the_middle_of_what_is_drawn_and_not_there(robot):
    """All beams go through it, and those that end at boxes that are not on the map say nothing either."""
    boxes = [
        solid(f"box_{k}", (0.6, 0.6), at) for k, at in enumerate(((-1.2, 1.4), (0.2, -1.4), (-2.4, -1.0), (1.6, 1.2)))
    ]
    grid = OccupancyGrid.from_world(
        hall(solid("ghost", (1.4, 1.0), (-0.6, 0.0))), resolution=0.05, z_range=robot.z_range
    )
    start = Pose2D(-3.5, 0.0, 0.0)
    errors, states = follow(hall(*boxes), grid, robot, start, start, 300, lambda step: Twist2D(0.4 * (step < 150), 0.0))
    assert errors.max() < 0.1
    assert states.count("localized") == len(states)
