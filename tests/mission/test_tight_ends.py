import numpy as np
import pytest

from trundle._core import label_components
from trundle.costmap import INSCRIBED, Costmap
from trundle.errors import InputError, ScenarioError
from trundle.maps import OccupancyGrid
from trundle.mission import sample_tight_ends


@pytest.fixture(scope="module")
def costmap(room, carter):
    return Costmap.from_grid(room, carter.outline)


@pytest.mark.parametrize("seed", range(6))
def test_both_ends_are_free_by_little_and_in_one_area(costmap, seed):
    ends = sample_tight_ends(costmap, seed)
    clearance = costmap.clearance([pose.as_tuple() for pose in ends], cap=1.0)
    assert ((clearance >= 0.03) & (clearance <= 0.25)).all()
    assert ends[0].distance_to(ends[1]) >= 0.5
    areas, _ = label_components((costmap.data < INSCRIBED).view(np.uint8), diagonal=False)
    labels = {int(areas[costmap.world_to_cell(pose.x, pose.y)]) for pose in ends}
    assert len(labels) == 1
    assert labels != {0}


def test_the_same_seed_gives_the_same_ends(costmap):
    assert sample_tight_ends(costmap, 3) == sample_tight_ends(costmap, seed=3)
    assert sample_tight_ends(costmap) == sample_tight_ends(costmap, seed=0)
    assert sample_tight_ends(costmap, 3) != sample_tight_ends(costmap, 4)


@pytest.mark.parametrize("shape", [(12, 12), (400, 400)])
def test_a_map_without_such_poses_is_an_error(carter, shape):
    # The small one has no room for the robot; of the large one the edge is unknown, so only walls could be near.
    data = np.zeros(shape, dtype=np.int8)
    if shape[0] < 100:
        data[[0, -1], :] = data[:, [0, -1]] = 100
    else:
        data[:] = 100
    with pytest.raises(ScenarioError, match="no start and goal can be picked"):
        sample_tight_ends(Costmap.from_grid(OccupancyGrid(data, 0.05), carter.outline), 0)


def test_bad_arguments_are_input_errors(costmap):
    with pytest.raises(InputError):
        sample_tight_ends(costmap, -1)
    with pytest.raises(InputError, match="costmap"):
        sample_tight_ends("map.yaml", 0)
