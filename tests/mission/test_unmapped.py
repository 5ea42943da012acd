import math

import numpy as np
import pytest

from trundle.costmap import INSCRIBED
from trundle.errors import InputError, ScenarioError
from trundle.maps import OccupancyGrid
from trundle.mission import Scenario
from trundle.mission.obstacles import KIND


def _prepare(seed=3, **unmapped):
    return Scenario.make(world="warehouse", seed=seed, backend="kinematic", unmapped=unmapped).prepare()


def _boxes(setting):
    return [solid for solid in setting.world.solids if solid.kind == KIND]


def test_boxes_are_in_the_world_and_not_on_the_map():
    plain = Scenario.make(world="warehouse", seed=3, backend="kinematic").prepare()
    setting = _prepare(boxes=8)
    assert len(_boxes(setting)) == 8
    assert (setting.start, setting.goals) == (plain.start, plain.goals)
    assert np.array_equal(setting.grid.data, plain.grid.data)
    seen = OccupancyGrid.from_world(setting.world, resolution=0.05, z_range=setting.robot.z_range)
    assert (seen.data != plain.grid.data).any()


def test_the_seed_decides_where_they_stand_and_how_many_there_are():
    assert _boxes(_prepare(boxes=[2, 9])) == _boxes(_prepare(boxes=[2, 9]))
    counts = {len(_boxes(_prepare(seed=seed, boxes=[2, 9]))) for seed in range(4)}
    assert len(counts) > 1
    assert counts <= set(range(2, 10))


def test_they_keep_away_from_where_the_robot_turns_at_its_ends():
    setting = _prepare(boxes=30, room=0.4, near_path=1.0)
    reach = setting.robot.circumscribed_radius + 0.4
    for box in _boxes(setting):
        x, y, _ = box.pose.position
        half = 0.5 * math.hypot(*box.shape.size[:2])
        for end in (setting.start.as_tuple(), *setting.goals):
            assert math.dist((x, y), end[:2]) > reach + half


def test_they_stand_where_the_robot_can_be_and_on_the_floor():
    setting = _prepare(boxes=20, height=[0.2, 0.5], size=0.4)
    costmap = setting.navigator.costmap
    for box in _boxes(setting):
        x, y, z = box.pose.position
        assert costmap.cost_at(x, y) < INSCRIBED
        assert box.shape.size[:2] == pytest.approx((0.4, 0.4))
        assert box.shape.size[2] == pytest.approx(2.0 * z)
        assert 0.4 <= 4.0 * z <= 1.0


def test_a_map_without_room_for_them_is_refused():
    with pytest.raises(ScenarioError, match="no room for a box"):
        _prepare(boxes=1, size=60.0)


@pytest.mark.parametrize(
    ("given", "message"),
    [({"boxes": [5, 3]}, "the least comes first: 5 is above 3"), ({"boxes": -1}, "boxes"), ({"size": 0.0}, "size")],
)
def test_numbers_that_cannot_be_are_refused(given, message):
    with pytest.raises(InputError, match=message):
        Scenario.make(world="warehouse", unmapped=given)


def test_a_saved_scenario_has_the_same_boxes(tmp_path):
    setting = _prepare(boxes=[2, 9])
    setting.scenario.save(tmp_path / "scenario.yaml")
    again = Scenario.load(tmp_path / "scenario.yaml").prepare()
    assert _boxes(again) == _boxes(setting)
