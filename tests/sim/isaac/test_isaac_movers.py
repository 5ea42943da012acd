from __future__ import annotations

import pytest

import trundle
from trundle import World
from trundle.errors import InputError, WorldError
from trundle.mission import Scenario
from trundle.worlds.movers import Crowd


def test_isaac_sim_says_that_it_has_no_movers_before_it_is_started():
    world = World("hall", (), movers=(Crowd("people", 2, area=(-5.0, -5.0, 5.0, 5.0)),))
    with pytest.raises(WorldError, match="'hall' has movers, and backend isaac has none yet; use backend mujoco or"):
        trundle.simulate(world, "nova_carter", backend="isaac")


def test_isaac_sim_says_that_it_has_no_lidars_before_it_is_started():
    with pytest.raises(InputError, match="backend isaac simulates no lidars; use backend mujoco or kinematic"):
        trundle.simulate(World("hall", ()), "nova_carter", backend="isaac", lidar=True)
    assert Scenario.make(world="maze", backend="isaac", lidar=True).lidar
    with pytest.raises(InputError, match="simulates no lidars"):
        Scenario.make(world="maze", backend="isaac", lidar=True).build()
