"""Ends so tight that the path lies between the states and motions of the first search."""

import numpy as np
import pytest

from support.swept import costmap_of, room, swept_area_blocked
from trundle.costmap import Costmap
from trundle.errors import PlanningStoppedError
from trundle.geometry import Pose2D
from trundle.maps.grid import OccupancyGrid
from trundle.planning import create_planner
from trundle.planning.hybrid_astar import HybridAStarPlanner
from trundle.robots import Robot
from trundle.worlds import World

IN_PLACE = {"in_place": True}


def costmap_in(world: str, seed: int) -> Costmap:
    robot = Robot.load("nova_carter")
    grid = OccupancyGrid.from_world(World.generate(world, seed=seed), z_range=robot.z_range)
    return Costmap.from_grid(grid, robot)


LOT, OFFICE = costmap_in("lot", 3), costmap_in("office", 3)


# Each of these was refused as having no path. A flood over cells of 1 cm and 1°, with the robot's own motions and 8 mm
# of room around it, leads out of every one of these ends.
@pytest.mark.parametrize(
    ("costmap", "start", "goal", "kind"),
    [
        (LOT, (-5.967, 0.5181, 3.0354), (-7.7948, 5.3153, -0.4274), {}),
        (LOT, (-5.967, 0.5181, 3.0354), (-7.7948, 5.3153, -0.4274), IN_PLACE),
        (LOT, (0.3339, 0.1, 0.0683), (-0.0581, 4.673, -1.5882), {}),
        (OFFICE, (-6.4031, -0.2111, 1.3298), (6.7511, -5.4035, 2.3376), {}),
        (OFFICE, (-0.3084, -2.0832, -2.1931), (-3.7411, 6.2345, -1.8815), IN_PLACE),
    ],
)
def test_ends_with_few_centimetres_of_room_are_planned(costmap, start, goal, kind):
    path = HybridAStarPlanner(**kind).plan(costmap, Pose2D(*start), Pose2D(*goal))
    assert swept_area_blocked(costmap, path) < 1e-6
    assert np.allclose(path.poses[[0, -1]], [start, goal])


def test_the_default_planner_finds_them_too():
    path = create_planner("auto").plan(LOT, Pose2D(-5.967, 0.5181, 3.0354), Pose2D(-7.7948, 5.3153, -0.4274))
    assert path.planner == "hybrid_astar"


@pytest.mark.parametrize("kind", [{}, IN_PLACE], ids=str)
def test_an_end_with_millimetres_of_room_is_not_said_to_have_no_path(kind):
    # Boxes of 3 mm and 0.4° whose middles have 5 mm of room join the two.
    with pytest.raises(PlanningStoppedError, match="none found within"):
        HybridAStarPlanner(**kind).plan(OFFICE, Pose2D(-1.967, 5.325, -0.2969), Pose2D(-2.669, 5.5531, 3.0675))


def test_a_narrow_door_between_large_rooms_is_not_called_impassable_before_all_is_tried():
    rooms = costmap_of(room(16, 12, (8, 0, 8.2, 5.8), (8, 6.2, 8.2, 12)))
    with pytest.raises(PlanningStoppedError, match="none found within 5000 expansions") as caught:
        HybridAStarPlanner(max_expansions=5_000).plan(rooms, Pose2D(2, 2, 1.0), Pose2D(13, 6))
    assert caught.value.status == "exhausted"
