"""Drive among people and forklifts that are on no map.

Writes people.png: the map, the driven path, and where everybody was at the end, with the traces of the last seconds.
"""

import trundle
from trundle.record import MoverTrails, draw_run

world = trundle.World.generate("warehouse", seed=3, people=6, forklifts=2, mover_speed=1.0, sees_robot=True)
robot = trundle.Robot.load("nova_carter")
grid = trundle.OccupancyGrid.from_world(world, resolution=0.05, z_range=robot.z_range)  # without those who move
navigator = trundle.Navigator(grid, robot)
start, goal = trundle.sample_mission(navigator.costmap, seed=3)
print("from", start, "to", goal)

with (
    trundle.simulate(world, robot, backend="mujoco", lidar=True) as sim,
    trundle.Session(sim, navigator, start, goal, time_limit_s=240.0) as session,
):
    said, trails = "", MoverTrails()
    while (step := session.step()) is not None:
        trails.add(step.state.time, step.movers)
        if navigator.message != said:
            said = navigator.message
            print(f"{step.state.time:6.1f} s  {said or 'the path is free'}")
    episode = session.finish()

print(episode.outcome, episode.message)
print(f"the collision monitor stopped it {episode.metrics.monitor_stops} times")
draw_run(navigator.costmap, robot, episode, movers=trails).save("people.png")
print("wrote people.png")
raise SystemExit(0 if episode.arrived else 1)
