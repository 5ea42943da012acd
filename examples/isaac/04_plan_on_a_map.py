"""Step 4 of 5: plan on the environment's map with A*. Needs no simulator.

./python.sh examples/isaac/04_plan_on_a_map.py MAP.YAML

The map is the occupancy map extension's, or trundle's own: if the asset packs are on this machine,
`trundle map build warehouse_with_forklifts --assets-root FOLDER --exclude ceiling` makes it without Isaac Sim.
"""

import sys

import trundle
from trundle.record import draw_plan

navigator = trundle.Navigator(trundle.OccupancyGrid.load(sys.argv[1]), "nova_carter")
start, goal = trundle.sample_mission(navigator.costmap, seed=3)
navigator.set_goal(goal)
path = navigator.plan(start)
print(f"{path.length:.2f} m from {start} to {goal}")
draw_plan(navigator.costmap, path, navigator.robot).save("overlay.png")
print("wrote overlay.png")
