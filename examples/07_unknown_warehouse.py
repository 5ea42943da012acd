"""Drive through a warehouse without a map: by lidar alone.

The robot knows where it is and where its goal is. It finds out on the way what is between the two. Writes unknown.png:
what it has seen, with the path that it drove.
"""

import trundle
from trundle.record import draw_run

# Without objects that are lower than the plane of the robot's lidars: nothing would show them to it.
world = trundle.World.generate("warehouse", seed=3, low_objects=False)
robot = trundle.Robot.load("nova_carter")

# The map only serves to pick a mission; the navigator gets none.
grid = trundle.OccupancyGrid.from_world(world, resolution=0.05, z_range=robot.z_range)
start, goal = trundle.sample_mission(trundle.Costmap.from_grid(grid, robot), seed=3)
print("from", start, "to", goal)

navigator = trundle.Navigator(None, robot)
with trundle.simulate(world, robot, backend="mujoco", lidar=True) as sim:
    episode = trundle.run(sim, navigator, start=start, goal=goal, time_limit_s=180.0)

print(episode.outcome, episode.message)
print(f"{episode.metrics.distance_m:.2f} m; the shortest path is {episode.metrics.shortest_path_m or 0.0:.2f} m")
print(f"planned {episode.metrics.replans + 1} times, touched {len(episode.metrics.contacts)} things")
draw_run(navigator.costmap, robot, episode).save("unknown.png")
print("wrote unknown.png")
raise SystemExit(0 if episode.arrived else 1)
