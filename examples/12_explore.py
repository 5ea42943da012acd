"""A robot explores a world that it does not know, with bad odometry, and then drives a mission on its own map.

Writes explored.yaml with explored.png, and explored_overlay.png: the map with the poses and loops that it was made of.
--fast explores for half a minute only, and drives no mission.
"""

import argparse

import trundle
from trundle.record import draw_own_map, save_png

parser = argparse.ArgumentParser()
parser.add_argument("--fast", action="store_true")
fast = parser.parse_args().fast

world = {"name": "office", "seed": 1, "options": {"low_objects": False}}
odometry = {"scale": 0.02, "heading": "2deg"}
place = {"world": world, "odometry": odometry, "backend": "kinematic", "lidar": True}
unknown = trundle.Scenario.make(**place, known_map=False, time_limit_s=30.0 if fast else 900.0)
exploration = trundle.explore(unknown)
print(exploration.message)
for lost in exploration.given_up:
    print(f"given up at ({lost.x:.1f}, {lost.y:.1f}): {lost.reason}")
own = exploration.episode.own_map
own.grid.save("explored.yaml")
save_png(draw_own_map(own, title="explored office"), "explored_overlay.png")
print(f"mapped {(own.grid.data == 0).sum() * own.grid.resolution**2:.0f} m² of free floor")

if not fast:  # the same odometry: amcl finds the robot on the map that it has made itself
    with trundle.Scenario.make(**place, localizer="amcl", seed=5).build() as mission:
        navigator = trundle.Navigator(own.grid, mission.robot)
        ends = mission.start, mission.goals
        episode = trundle.run(mission.sim, navigator, *ends, localizer="amcl", seed=5)
    print(episode.message, f"{episode.metrics.position_error_m:.3f} m off")
