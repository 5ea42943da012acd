import json
import math
import warnings

import numpy as np
import pytest

import trundle
from trundle.errors import InputError, WorldError
from trundle.geometry import Pose2D, Twist2D
from trundle.geometry.solids import Cylinder
from trundle.robots import Robot
from trundle.worlds import World

FRAMES = [[0.0, 0.0, -10.0], [4.0, 1.0, 0.0], [10.0, 0.0, 10.0]]


def write(tmp_path, content):
    file = tmp_path / "worlds.json"
    file.write_text(content if isinstance(content, str) else json.dumps(content))
    return file


def one(waypoints=FRAMES, period=10.0, level="easy"):
    return {"level": level, "obstacles": [{"period_s": period, "waypoints": waypoints}]}


def test_an_obstacle_is_a_cylinder_that_passes_its_key_frames_and_starts_again(tmp_path):
    world = World.load(write(tmp_path, {"world_4": one()}))
    (mover,) = world.movers
    assert [part.shape for part in mover.parts] == [Cylinder(0.5, 1.0)]
    for time, x, y in FRAMES[:-1]:
        for turn in (0.0, 10.0, 20.0):
            state = mover.motion.at(time + turn)
            assert (state.x, state.y) == pytest.approx((x, y))
    before, after = mover.motion.at(9.999), mover.motion.at(10.001)  # it jumps back, as in Gazebo
    assert (before.y, after.y) == pytest.approx((10.0, -10.0), abs=0.01)


def test_the_curve_between_key_frames_is_smooth(tmp_path):
    motion = World.load(write(tmp_path, {"world_4": one()})).movers[0].motion
    at = motion.at(4.0)
    assert (at.vx, at.vy) == pytest.approx((0.0, 2.0))  # from the one before to the one after
    near = [motion.at(4.0 + offset) for offset in (-1e-6, 1e-6)]
    assert near[0].vx == pytest.approx(near[1].vx, abs=1e-4)


def test_the_motions_may_have_begun_before(tmp_path):
    file = write(tmp_path, {"world_4": one()})
    late, whole = World.load(file, start_s=3.5).movers[0].motion, World.load(file).movers[0].motion
    for time in (0.0, 0.4, 6.0, 8.0):
        assert late.at(time) == whole.at(time + 3.5)


def test_a_period_after_the_last_key_frame_is_waited_for(tmp_path):
    motion = World.load(write(tmp_path, {"world_4": one(period=12.0)})).movers[0].motion
    assert motion.at(12.0 + 4.0).x == pytest.approx(1.0)
    assert motion.at(11.9).y == pytest.approx(10.0, abs=0.5)


def test_three_walls_stand_around(tmp_path):
    world = World.load(write(tmp_path, {"world_4": one()}))
    assert {solid.name for solid in world.solids} == {"wall_north", "wall_south", "wall_west"}
    low, high = world.bounds
    np.testing.assert_allclose((low[1], high[1]), (-10.25, 10.25))


@pytest.mark.parametrize("name", [4, "4", "world_4"])
def test_worlds_are_named_by_name_or_number(tmp_path, name):
    file = write(tmp_path, {"world_4": one(), "world_5": one(level="hard")})
    assert World.load(file, world=name).name == "world_4"


def test_a_file_of_several_worlds_needs_a_name(tmp_path):
    file = write(tmp_path, {"world_4": one(), "world_5": one()})
    with pytest.raises(WorldError, match="there are 2 worlds in it: name one with world=world_4"):
        World.load(file)
    with pytest.raises(WorldError, match=r"no world wrld_4 \(did you mean world_4\?\); there are world_4, world_5"):
        World.load(file, world="wrld_4")


def test_a_truncated_file_is_refused(tmp_path):
    whole = json.dumps({"world_4": one()})
    for length in (0, 1, len(whole) // 2, len(whole) - 1):
        with pytest.raises(WorldError, match=r"not JSON: .*; the file may be incomplete"):
            World.load(write(tmp_path, whole[:length]))


def test_nesting_without_end_is_refused(tmp_path):
    with pytest.raises(WorldError, match="not JSON"):
        World.load(write(tmp_path, "[" * 100_000))


NAN = [[0.0, 0.0, 0.0], [1.0, math.nan, 0.0]]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ([], "no worlds of DynaBARN"),
        ({}, "no worlds of DynaBARN"),
        ({"cells": 3}, "cells: no world of DynaBARN"),
        ({"world_0": {"level": "easy"}}, "world_0: no world of DynaBARN: it has no obstacles"),
        ({"world_0": one(level="harder")}, "level must be easy, medium or hard, got 'harder'"),
        ({"world_0": {"level": "easy", "obstacles": [3]}}, "obstacle 0: waypoints must be"),
        ({"world_0": one([[0.0, 1.0, 2.0]])}, "two or more"),
        ({"world_0": one([[0.0, 1.0], [1.0, 2.0]])}, "two or more"),
        ({"world_0": one(NAN)}, "all finite"),
        ({"world_0": one([[0.0, 0.0, 0.0], [1.0, "x", 0.0]])}, "all finite"),
        ({"world_0": one(FRAMES, 9.0)}, "period_s must be a number of 10 s"),
        ({"world_0": one(FRAMES, None)}, "period_s must be"),
        (
            {"world_0": one([[0.0, 0.0, 0.0], [2.0, 1.0, 0.0], [1.0, 2.0, 0.0]], 2.0)},
            "times of waypoints must increase",
        ),
    ],
)
def test_what_is_wrong_is_said_with_its_place(tmp_path, content, message):
    with pytest.raises(WorldError, match=message) as caught:
        World.load(write(tmp_path, content))
    assert "worlds.json" in str(caught.value)


def test_options_are_checked(tmp_path):
    file = write(tmp_path, {"world_4": one()})
    with pytest.raises(InputError, match="start_s"):
        World.load(file, start_s=-1.0)
    with pytest.raises(InputError, match="did you mean 'start_s'"):
        World.load(file, start=1.0)


@pytest.mark.parametrize("backend", ["kinematic", "mujoco"])
def test_obstacles_pass_the_walls_without_a_warning_and_touch_the_robot(tmp_path, backend):
    world = World.load(write(tmp_path, {"world_4": one()}), start_s=3.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with trundle.simulate(world, Robot.load("jackal"), backend=backend) as sim:
            state = sim.reset(Pose2D(1.0, 0.0))
            while not state.contacts and state.time < 2.0:
                state = sim.step(Twist2D(), 0.05)
    assert {contact.other for contact in state.contacts} == {"obstacle_0"}
