"""Step 5 of 5: plan on the map with A*, place the robot at the start, and follow the path to the goal.

Writes overlay.png: the planned path and the driven one, coloured by speed, over the map.
"""

import trundle
from trundle.record import draw_run

world = trundle.World.generate("warehouse", seed=7)
robot = trundle.Robot.load("nova_carter")
grid = trundle.OccupancyGrid.from_world(world, resolution=0.05, z_range=robot.z_range)

# The navigator combines planner, controller and recovery. It knows no simulator: in your own control loop you would
# send the robot `navigator.update(pose)` in every control period.
navigator = trundle.Navigator(grid, robot)
start, goal = trundle.sample_mission(navigator.costmap, seed=3)
print("from", start, "to", goal)

with trundle.simulate(world, robot, backend="mujoco") as sim:
    episode = trundle.run(sim, navigator, start=start, goal=goal)

print(episode.outcome, episode.message)
print(f"{episode.metrics.distance_m:.2f} m in {episode.metrics.time_s:.1f} s of simulated time")
print(f"never nearer than {episode.metrics.min_clearance_m:.2f} m to anything")
draw_run(navigator.costmap, robot, episode).save("overlay.png")
print("wrote overlay.png")
raise SystemExit(0 if episode.arrived else 1)
