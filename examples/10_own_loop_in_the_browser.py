"""Show a loop of one's own in the browser: click a goal and the robot drives there; hold arrow keys to drive by hand.

Ends after ten minutes, or --seconds; --no-open prints the page's address without opening it.
"""

import argparse
import time

import trundle

parser = argparse.ArgumentParser()
parser.add_argument("--seconds", type=float, default=600.0)
parser.add_argument("--no-open", action="store_true")
given = parser.parse_args()

world = trundle.World.generate("warehouse", seed=0)
robot = trundle.Robot.load("nova_carter")
navigator = trundle.Navigator(trundle.OccupancyGrid.from_world(world, z_range=robot.z_range), robot)

with (
    trundle.simulate(world, robot, backend="kinematic", lidar=True) as sim,
    trundle.show(world, robot, open_browser=not given.no_open) as view,
):
    state = sim.reset(trundle.Pose2D(-12.0, 0.0))
    while state.time < given.seconds:
        began, keys = time.monotonic(), view.keys
        if (goal := view.take_goal()) is not None:
            navigator.set_goal(goal)
            print("to", goal)
        command = navigator.update(state.pose, state.twist, scans=state.scans, time=state.time)
        if keys:  # they have the last word
            command = trundle.Twist2D(0.6 * ("ArrowUp" in keys), 0.8 * (("ArrowLeft" in keys) - ("ArrowRight" in keys)))
        state = sim.step(command, navigator.dt)
        text = "driven by hand" if keys else f"{navigator.status}: {navigator.message}".rstrip(": ")
        view.update(state.pose, path=navigator.path, scan=state.scans, costmap=navigator.costmap, text=text)
        time.sleep(max(0.0, navigator.dt - (time.monotonic() - began)))
print(f"stopped at {state.pose}")
