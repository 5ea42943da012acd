"""Step 1 of 5 in Isaac Sim: load Nova Carter into a warehouse and look at it.

./python.sh examples/isaac/01_load_and_view.py [ENVIRONMENT]
"""

import sys

import trundle
from trundle.sim.isaac import IsaacSimulator

# An environment by name, or any USD file. trundle finds the asset root, or takes TRUNDLE_ISAAC_ASSETS.
environment = sys.argv[1] if len(sys.argv) > 1 else "warehouse_with_forklifts"

robot = trundle.Robot.load("nova_carter")
unknown = trundle.World(name="unknown", solids=())  # trundle does not need its geometry
with IsaacSimulator(unknown, robot, environment=environment) as sim:
    state = sim.reset(trundle.Pose2D(-2.5, -1.0, 0.0))
    print(f"{robot.name} stands at {state.pose}")
    print("close the window to end")
    sim.wait()
