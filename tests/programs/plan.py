import trundle
from trundle.planning import create_planner

robot = trundle.Robot.load("jackal")
world = trundle.World.generate("office", seed=1)
grid = trundle.OccupancyGrid.from_world(world, resolution=0.05, z_range=robot.z_range)
costmap = trundle.Costmap.from_grid(grid, robot)
start, goal = trundle.sample_mission(costmap)
path = create_planner("auto").plan(costmap, start, trundle.Goal.of(goal))
print(f"{path.length:.2f} m")
