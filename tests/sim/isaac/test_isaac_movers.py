from __future__ import annotations

import pytest

import trundle
from trundle import World
from trundle.errors import WorldError
from trundle.worlds.movers import Crowd


def test_isaac_sim_says_that_it_has_no_movers_before_it_is_started():
    world = World("hall", (), movers=(Crowd("people", 2, area=(-5.0, -5.0, 5.0, 5.0)),))
    with pytest.raises(WorldError, match="'hall' has movers, and backend isaac has none yet; use backend mujoco or"):
        trundle.simulate(world, "nova_carter", backend="isaac")
