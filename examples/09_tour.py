"""Drive through poses without stopping, wait at one and turn round at the last; back up at the end.

Writes tour.png: the path and the drive, over the map.
"""

import trundle
from trundle.navigation import NavigationStatus, Waypoint
from trundle.navigation.behaviors import BackUp, Spin, Wait
from trundle.record import draw_run

world = trundle.World.generate("warehouse", seed=0)
robot = trundle.Robot.load("nova_carter")
grid = trundle.OccupancyGrid.from_world(world, resolution=0.05, z_range=robot.z_range)

# A blocked robot runs these steps in turn; the default is replan, back_up.
settings = trundle.NavigatorSettings(recovery=["replan", "back_up=0.5", "spin=90deg"])
navigator = trundle.Navigator(grid, robot, settings=settings)
tour = [(-7.0, 0.3), (-1.0, -0.3), Waypoint(4.0, 0.0, tasks=[Wait(2.0)]), Waypoint(12.0, 0.0, 0.0, tasks=[Spin(3.14)])]

with trundle.simulate(world, robot, backend="mujoco") as sim:
    episode = trundle.run(sim, navigator, (-12.0, 0.0), tour, through=True)
    print(episode.message)
    for ran in episode.behaviors:
        print(ran)

    # In a loop of your own: one behavior, checked like any command, until it is done or fails.
    state = sim.reset(episode.trajectory.poses[-1])
    navigator.cancel()
    navigator.run(BackUp(0.3))
    while navigator.status is not NavigationStatus.FINISHED and state.time < 20.0:
        command = navigator.update(state.pose, state.twist, time=state.time)
        state = sim.step(command, navigator.dt)
    print(navigator.behavior_runs[-1])

draw_run(navigator.costmap, robot, episode).save("tour.png")
print("wrote tour.png")
raise SystemExit(0 if episode.arrived else 1)
