"""Arguments of another type, or of shapes that do not fit: one typed error that says which and what it must be."""

import numpy as np
import pytest

import trundle
from trundle.control import GoalChecker, ProgressChecker, create_controller
from trundle.costmap import Costmap, CostmapSettings
from trundle.errors import TrundleError
from trundle.maps import HeightField, KeepoutMask, OccupancyGrid
from trundle.mission import Scenario, Trajectory, sample_mission
from trundle.navigation import Choice, Navigator, NavigatorSettings
from trundle.planning import create_planner, create_smoother, planner_names
from trundle.robots import Robot
from trundle.sim import simulate
from trundle.worlds import World

CARTER = Robot.load("nova_carter")
CELLS = np.zeros((80, 120), np.int8)
CELLS[40, 60] = 100
GRID = OccupancyGrid(CELLS, 0.05)
COSTMAP = Costmap.from_grid(GRID, CARTER)
WORLD = World.from_map(GRID)
HERE, THERE = (1.0, 2.0), (5.0, 2.0)


PURSUIT = "regulated_pure_pursuit"


def navigator(**options):
    return Navigator(GRID, CARTER, **options)


def run(sim=None, driver=None, start=HERE, goal=THERE, **options):
    sim = simulate(WORLD, CARTER, backend="kinematic") if sim is None else sim
    return trundle.run(sim, navigator() if driver is None else driver, start, goal, **options)


CALLS = {
    "sample_mission(None, 1)": (lambda: sample_mission(None, 1), "a mission's costmap must be of type Costmap"),
    "Costmap.from_grid(None)": (lambda: Costmap.from_grid(None, CARTER), "must be of type OccupancyGrid, got NoneType"),
    "Costmap.from_grid(robot=None)": (lambda: Costmap.from_grid(GRID, None), "a footprint needs at least 3"),
    "keepout": (lambda: Costmap.from_grid(GRID, CARTER, keepout=3), "keepout must be of type KeepoutMask, got int"),
    "cost_at": (lambda: COSTMAP.cost_at([1, 2], [1, 2, 3]), r"the same shape.*got \(2,\) and \(3,\)"),
    "cost_at text": (lambda: COSTMAP.cost_at("a", 1), "coordinates must be an array of numbers"),
    "world_to_cell": (lambda: GRID.world_to_cell([1, 2], [1, 2, 3]), "the same shape"),
    "cell_to_world": (lambda: GRID.cell_to_world([1, 2], [1, 2, 3]), "the same shape"),
    "contains": (lambda: GRID.contains(np.zeros(2, int), np.zeros(3, int)), "the same shape"),
    "contains text": (lambda: GRID.contains("a", 2), "coordinates must be an array of numbers"),
    "GoalChecker text": (lambda: GoalChecker(xy_tolerance="a"), "xy_tolerance must be a number of 0 or more, got 'a'"),
    "GoalChecker none": (lambda: GoalChecker(yaw_tolerance=None), "yaw_tolerance must be a number"),
    "GoalChecker nan": (lambda: GoalChecker(stopped_linear=float("nan")), "stopped_linear must be a number"),
    "ProgressChecker": (lambda: ProgressChecker(movement_time_allowance=-1.0), "movement_time_allowance must be"),
    "World.load(None)": (lambda: World.load(None), "a world's file must be a path, .* got NoneType"),
    "World.load([])": (lambda: World.load([]), "a world's file must be a path"),
    "World.generate(None)": (lambda: World.generate(None), "the name of a world must be .* there are: .*office"),
    "World.generate([])": (lambda: World.generate([]), "the name of a world must be"),
    "World.from_map(None)": (lambda: World.from_map(None), "a world's map must be of type OccupancyGrid, str or"),
    "World.from_map height": (lambda: World.from_map(GRID, height="a"), "height must be a positive number"),
    "Robot.load(5)": (lambda: Robot.load(5), "a robot must be of type str or PathLike, got int"),
    "Robot.load(None)": (lambda: Robot.load(None), "a robot must be of type"),
    "OccupancyGrid.load(None)": (lambda: OccupancyGrid.load(None), "a map's file must be a path"),
    "OccupancyGrid.load bytes": (lambda: OccupancyGrid.load(b"map.yaml"), "a map's file must be a path.* got bytes"),
    "OccupancyGrid.save(None)": (lambda: GRID.save(None), "a file or folder to write must be a path"),
    "from_world(None)": (lambda: OccupancyGrid.from_world(None), "a map needs a World, got NoneType"),
    "from_world resolution": (lambda: OccupancyGrid.from_world(WORLD, resolution="a"), "resolution must be .* got 'a'"),
    "from_world z_range text": (lambda: OccupancyGrid.from_world(WORLD, z_range="a"), "z_range must be"),
    "from_world z_range": (lambda: OccupancyGrid.from_world(WORLD, z_range=5), "z_range must be .* got 5"),
    "from_world floor_z": (lambda: OccupancyGrid.from_world(WORLD, floor_z="a"), "floor_z must be a height"),
    "from_world margin": (lambda: OccupancyGrid.from_world(WORLD, margin="a"), "margin must be a number"),
    "KeepoutMask.load(5)": (lambda: KeepoutMask.load(5), "a mask is loaded from the path of its YAML, got int"),
    "HeightField.load(None)": (lambda: HeightField.load(None), "a height field's file must be a path"),
    "Trajectory.load(5)": (lambda: Trajectory.load(5), "must be a path"),
    "Scenario.load(None)": (lambda: Scenario.load(None), "file must be a path"),
    "Scenario.save(5)": (lambda: Scenario.make(world="office").save(5), "to write must be a path"),
    "simulate(None)": (lambda: simulate(None, CARTER), "a simulator's world must be of type World, got NoneType"),
    "simulate(robot=None)": (lambda: simulate(WORLD, None), "a robot must be of type"),
    "simulate(backend=None)": (lambda: simulate(WORLD, CARTER, backend=None), "the name of a backend must be"),
    "run(None)": (lambda: run(sim=5), "a run's simulator must be of type Simulator, got int"),
    "run navigator": (lambda: run(driver=5), "agent 5 is no agent"),
    "run start": (lambda: run(start=5), "a pose is .* got 5"),
    "run start of one": (lambda: run(start=(1,)), "a pose is .* got 1 number"),
    "run goal": (lambda: run(goal=None), "a goal is a pose.* got None"),
    "run goals": (lambda: run(goal=[(1, 2), 3]), "a pose is .* got 3"),
    "run limit": (lambda: run(time_limit_s="a"), "the time limit must be a number, got 'a'"),
    "run observers": (lambda: run(observers=5), "observers must be of type Sequence, got int"),
    "Navigator(3)": (lambda: Navigator(3, CARTER), "a navigator's map must be of type OccupancyGrid, Costmap,"),
    "Navigator(world)": (lambda: Navigator(WORLD, CARTER), "got World; OccupancyGrid.from_world"),
    "Navigator(robot=None)": (lambda: Navigator(GRID, None), "a robot must be of type"),
    "planner=5": (lambda: navigator(planner=5), "planner 5 is no planner"),
    "Choice(options=5)": (lambda: Choice(name="astar", options=5), "options: must be a mapping, got 5"),
    "Choice(options={1: 2})": (lambda: Choice(name="astar", options={1: 2}), "options.1"),
    "controller": (lambda: navigator(controller=Choice.of(PURSUIT, nothing=1)), "has no option 'nothing'"),
    "costmap={}": (lambda: navigator(costmap={}), "costmap must be of type CostmapSettings"),
    "settings=5": (lambda: navigator(settings=5), "settings must be of type NavigatorSettings"),
    "CostmapSettings": (lambda: CostmapSettings(inflation_radius=-1), "inflation_radius: -1 is out of range"),
    "CostmapSettings(x)": (lambda: CostmapSettings(inflation=1), "inflation: unknown key. Did you mean"),
    "NavigatorSettings": (lambda: NavigatorSettings(goal_tolerance="x"), "goal_tolerance: must be a number, got 'x'"),
    "create_controller": (lambda: create_controller("regulated_pure_pursuit", None), "a controller's robot must be"),
    "create_smoother": (lambda: create_smoother(5), "smoother 5 is no smoother"),
    "cost_weight": (lambda: create_planner("auto", cost_weight="x"), "cost_weight must be a number .* got 'x'"),
}


@pytest.mark.parametrize("name", CALLS)
def test_an_argument_of_another_type_is_refused_with_what_it_must_be(name):
    call, message = CALLS[name]
    with pytest.raises(TrundleError, match=message):
        call()


@pytest.mark.parametrize("planner", planner_names())
@pytest.mark.parametrize(
    ("question", "message"),
    [
        ((COSTMAP, HERE, None), "the goal must be a pose"),
        ((COSTMAP, None, THERE), "the start must be a pose"),
        ((COSTMAP, HERE, "ab"), "the goal must be a pose"),
        ((None, HERE, THERE), "a planner's costmap must be of type Costmap, got NoneType"),
        ((GRID, HERE, THERE), "a planner's costmap must be of type Costmap, got OccupancyGrid"),
    ],
)
def test_every_planner_refuses_what_is_no_question(planner, question, message):
    with pytest.raises(TrundleError, match=message):
        create_planner(planner).plan(*question)
