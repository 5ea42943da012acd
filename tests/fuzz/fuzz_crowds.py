"""Crowds in the kernel against the same in NumPy, and among the robots of a batch."""

from __future__ import annotations

import random

import numpy as np

from fuzz.loop import attempt, rng_of, spoil
from support.crowd_oracle import CrowdOracle
from trundle._core import BatchCrowds, CrowdFloor, CrowdModel, CrowdRun
from trundle.errors import WorldError
from trundle.geometry import Pose3D
from trundle.geometry.solids import Box, Solid
from trundle.worlds.movers import AlongPath, Crowd, Mover, person_body
from trundle.worlds.movers.walk import CrowdWalk, RobotMotion

CART = Mover("cart", person_body(), AlongPath(((1.0, 1.0), (7.0, 4.0)), 0.7, repeat="back_and_forth"))


def check_walk(generator: random.Random) -> None:
    """A few seconds among boxes, beside a robot that drives through."""
    rng = rng_of(generator)
    boxes = [
        Solid(f"box_{number}", Box((0.8, 0.6, 1.0)), Pose3D((x, y, 0.5)))
        for number, (x, y) in enumerate(rng.uniform((0, 0), (9, 6), (generator.choice((0, 3)), 2)).tolist())
    ]
    crowds = [
        Crowd("people", generator.choice((1, 4, 9)), area=(0.0, 0.0, 9.0, 6.0), sees_robot=generator.random() < 0.7),
        Crowd("forklifts", 1, "forklift", area=(0.0, 0.0, 9.0, 6.0)),
    ]
    movers = generator.choice(((), (CART,)))
    robot = RobotMotion(*rng.uniform((-2, 0), (0, 6)).tolist(), *rng.uniform(-0.8, 0.8, 2).tolist(), 0.5)
    try:
        walks = CrowdWalk(crowds, movers, boxes), CrowdOracle(crowds, movers, boxes)
    except WorldError:
        return  # no room for the forklift
    seed = generator.randrange(1000)
    for step in range(50):
        here = robot._replace(x=robot.x + 0.05 * step * robot.vx, y=robot.y + 0.05 * step * robot.vy)
        states = []
        for walk in walks:
            try:
                if step == 0:
                    walk.reset(seed, here)
                states.append(walk.at(0.05 * step, here))
            except WorldError:
                states.append(np.zeros((0, 6)))
        assert states[0].shape == states[1].shape
        if len(states[0]) == 0:
            return
        assert np.abs(states[0] - states[1]).max() < 1e-8


def check_arguments(generator: random.Random) -> None:
    """What the kernels do not expect is refused, or computed without a fault."""
    costs = np.full((20, 30), 10, np.uint8)
    costs[[0, -1]], costs[:, [0, -1]] = 255, 255
    floor = attempt(CrowdFloor, spoil(generator, (costs, np.zeros_like(costs), 0.0, 0.0, 0.1, 1.0, 3)))
    floor = floor or CrowdFloor(costs, np.zeros_like(costs), 0.0, 0.0, 0.1, 1.0, 3)
    corners = np.array([(0.1, -0.1), (0.0, 0.1), (-0.1, -0.1)])
    members = np.array([(0.1, 1.0, 1.0, 0.0), (0.1, 1.0, 0.0, 1.0)])
    given = ([floor], np.array([2]), members, np.tile(corners, (2, 1)), np.array([3, 3]), np.array([0.2]))
    model = attempt(CrowdModel, spoil(generator, given)) or CrowdModel(*given)
    words, robot, movers = np.arange(4, dtype=np.uint64)[None], np.array([9.0, 9, 0, 0, 0.3]), np.full((1, 4), 0.5)
    run = CrowdRun(model)
    attempt(run.step, spoil(generator, (robot, movers)))  # not before a reset
    attempt(run.reset, spoil(generator, (words, robot, movers)))
    attempt(run.step, spoil(generator, (robot, movers)))
    attempt(run.at, spoil(generator, (0.01,)))
    crowds = ([model], np.array([0]), np.array([0, -1]), [movers[None]], 3)
    batch = attempt(BatchCrowds, spoil(generator, crowds)) or BatchCrowds(*crowds)
    where = (np.arange(3), np.array([0, -1, 0]), np.full((3, 3), 9.0), 0.3, np.zeros((3, 1, 4), np.uint64), 2)
    attempt(batch.place, spoil(generator, where))
    attempt(batch.members, spoil(generator, (0, 0.0)))


def one_round(generator: random.Random) -> None:
    """Walk, or give the kernels what they do not expect."""
    generator.choice((check_walk, check_arguments))(generator)
