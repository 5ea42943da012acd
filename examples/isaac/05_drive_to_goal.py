"""Step 5 of 5 in Isaac Sim: place the robot at the start, follow the planned path to the goal, draw both.

./python.sh examples/isaac/05_drive_to_goal.py MAP.YAML [ENVIRONMENT]
"""

import sys

import trundle
from trundle.record import RunFolder

grid = trundle.OccupancyGrid.load(sys.argv[1])
environment = sys.argv[2] if len(sys.argv) > 2 else "warehouse_with_forklifts"

# The same navigator, loop and recorder as in MuJoCo; only the backend differs.
navigator = trundle.Navigator(grid, "nova_carter")
start, goal = trundle.sample_mission(navigator.costmap, seed=3)
world = trundle.World.from_map(grid)
with trundle.simulate(world, "nova_carter", backend="isaac", environment=environment) as sim, RunFolder() as folder:
    episode = trundle.run(sim, navigator, start=start, goal=goal, observers=[folder])
    print(episode.outcome, episode.message)
    print(f"never nearer than {episode.metrics.min_clearance_m:.2f} m to anything; recorded in {folder.path}")
raise SystemExit(0 if episode.arrived else 1)
