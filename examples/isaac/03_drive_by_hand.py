"""Step 3 of 5 in Isaac Sim: drive it by hand through its DifferentialController.

./python.sh examples/isaac/03_drive_by_hand.py [ENVIRONMENT]
"""

import sys

import trundle

environment = sys.argv[1] if len(sys.argv) > 1 else "warehouse_with_forklifts"
unknown = trundle.World(name="unknown", solids=())

# One step is one control period: ten steps of physics. The simulator applies the robot's limits.
period = 0.05
with trundle.simulate(unknown, "nova_carter", backend="isaac", environment=environment) as sim:
    sim.reset(trundle.Pose2D(-2.5, -1.0, 0.0))
    for v, w, seconds in [(0.4, 0.0, 2.0), (0.0, 0.7, 2.0)]:
        for _ in range(round(seconds / period)):
            state = sim.step(trundle.Twist2D(v, w), period)
        x, y, yaw = state.pose.as_tuple()
        print(f"after {seconds:g} s of v={v:g}, w={w:g}: x {x:.3f} m, y {y:.3f} m, yaw {yaw:.3f} rad")
