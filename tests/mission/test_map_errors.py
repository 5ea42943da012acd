import numpy as np
import pytest

from trundle._core import label_components
from trundle.costmap import INSCRIBED
from trundle.errors import InputError, ScenarioError
from trundle.maps import FREE, OCCUPIED, OccupancyGrid
from trundle.mission import Scenario

OFFICE = {"world": "office", "seed": 3, "backend": "kinematic"}


def prepare(errors=None, **changes):
    return Scenario.make(**{**OFFICE, **changes}, map_errors=errors).prepare()


def objects(grid, largest=2.0):
    """The small objects of a map: masks."""
    labels, table = label_components((grid.data != FREE).view(np.uint8), True)
    sides = np.maximum(table[:, 2] - table[:, 1], table[:, 4] - table[:, 3]) * grid.resolution
    return [labels == number + 1 for number in np.flatnonzero(sides <= largest)]


def test_a_share_of_the_small_objects_is_missing_and_the_world_and_the_mission_stay():
    true, wrong = prepare(), prepare({"missing": 0.25})
    small = objects(true.grid)
    gone = [mask for mask in small if (wrong.grid.data[mask] == FREE).all()]
    assert len(gone) == round(0.25 * len(small)) > 3
    changed = true.grid.data != wrong.grid.data
    assert (changed == np.any(gone, axis=0)).all()
    assert wrong.world == true.world
    assert (wrong.start, wrong.goals) == (true.start, true.goals)


def test_nothing_larger_is_left_out():
    true, wrong = prepare(), prepare({"missing": 1.0, "largest": 0.7})
    gone = (true.grid.data != FREE) & (wrong.grid.data == FREE)
    assert gone.any()
    assert (gone == np.any(objects(true.grid, 0.7), axis=0)).all()


def test_ghosts_are_on_the_map_where_the_robot_could_be_and_not_in_the_world():
    true, wrong = prepare(), prepare({"ghosts": 12})
    ghosts = (true.grid.data == FREE) & (wrong.grid.data == OCCUPIED)
    assert 0.6 * 12 * 0.3**2 < ghosts.sum() * 0.05**2 < 1.1 * 12 * 0.8**2
    assert (ghosts == (true.grid.data != wrong.grid.data)).all()
    assert wrong.world == true.world
    for end in (wrong.start.as_tuple(), *wrong.goals):
        assert wrong.navigator.costmap.cost_at(end[0], end[1]) < INSCRIBED


def test_planner_costmap_and_localizer_get_the_wrong_map():
    maps = []

    class Keeping:
        def __init__(self, map):
            maps.append(map)

        def reset(self, pose):
            self.pose = pose

        def update(self, observation):
            return self.pose

    scenario = Scenario.make(**OFFICE, map_errors={"ghosts": 12}, localizer=Keeping)
    with scenario.build() as mission:
        mission.session().finish()
        wrong = mission.grid
        assert not np.array_equal(wrong.data, prepare().grid.data)
        assert maps == [wrong]
        assert mission.navigator.grid is wrong
        rows, cols = np.nonzero((wrong.data == OCCUPIED) & (prepare().grid.data == FREE))
        assert (mission.navigator.costmap.data[rows, cols] > INSCRIBED).all()


def test_the_seed_decides_what_is_wrong(tmp_path):
    errors = {"missing": 0.5, "ghosts": [2, 9]}
    first = prepare(errors)
    first.scenario.save(tmp_path / "scenario.yaml")
    again = Scenario.load(tmp_path / "scenario.yaml").prepare()
    assert np.array_equal(again.grid.data, first.grid.data)
    other = Scenario.make(**{**OFFICE, "world": {"name": "office", "seed": 3}, "seed": 4}, map_errors=errors).prepare()
    assert not np.array_equal(other.grid.data, first.grid.data)


def test_ghosts_leave_what_is_missing_the_same():
    missing, both = prepare({"missing": 0.5}), prepare({"missing": 0.5, "ghosts": 5})
    assert (missing.grid.data[both.grid.data == FREE] == FREE).all()


def test_a_yawed_map_has_its_ghosts_in_the_same_cells_as_its_costmap():
    cells = np.zeros((200, 200), dtype=np.int8)
    cells[[0, -1]] = cells[:, [0, -1]] = OCCUPIED
    grid = OccupancyGrid(cells, 0.05, (3.0, -2.0, 0.7))
    from trundle.costmap import CostmapSettings
    from trundle.mission.obstacles import MapErrors
    from trundle.robots import Robot

    costmap = CostmapSettings().make_costmap(grid, Robot.load("jackal"))
    x, y = grid.cell_to_world([40, 160], [40, 160])
    ends = list(zip(x.tolist(), y.tolist(), strict=True))
    wrong = MapErrors(ghosts=5).change(grid, costmap, ends, 1)
    assert (wrong.origin, wrong.resolution) == (grid.origin, grid.resolution)
    rows, cols = np.nonzero(wrong.data != grid.data)
    assert len(rows) > 5 * 0.3**2 / 0.05**2 / 2
    assert rows.min() > 0
    assert cols.max() < 199


def test_unknown_cells_inside_of_what_is_missing_become_free():
    from trundle.costmap import CostmapSettings
    from trundle.mission.obstacles import MapErrors
    from trundle.robots import Robot

    cells = np.zeros((200, 200), dtype=np.int8)
    cells[[0, -1]] = cells[:, [0, -1]] = OCCUPIED
    cells[100:110, 100:110] = OCCUPIED
    cells[102:108, 102:108] = -1
    cells[150:153, 150:153] = -1  # unknown, and no object
    grid = OccupancyGrid(cells, 0.05)
    costmap = CostmapSettings().make_costmap(grid, Robot.load("jackal"))
    wrong = MapErrors(missing=1.0).change(grid, costmap, [(2.0, 2.0), (8.0, 2.0)], 1)
    assert (wrong.data[100:110, 100:110] == FREE).all()
    assert (wrong.data[150:153, 150:153] == -1).all()


def test_a_map_without_room_for_ghosts_is_refused():
    with pytest.raises(ScenarioError, match=r"map_errors: the map has no room for a ghost .* smaller ghosts"):
        prepare({"ghosts": 1, "size": 60.0})


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"missing": 1.5}, "missing"),
        ({"ghosts": [5, 3]}, "the least comes first: 5 is above 3"),
        ({"largest": 0.0}, "largest"),
        ({"gosts": 3}, "ghosts"),
    ],
)
def test_errors_that_cannot_be_are_refused(given, message):
    with pytest.raises(InputError, match=message):
        Scenario.make(world="office", map_errors=given)


def test_a_robot_without_a_map_has_no_errors_on_it():
    with pytest.raises(InputError, match="map_errors are errors of the robot's map"):
        Scenario.make(world="office", lidar=True, known_map=False, map_errors={"ghosts": 3})
