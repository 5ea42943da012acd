import numpy as np

import trundle

world = trundle.World.generate("maze", seed=2)
with trundle.simulate(world, "jackal", backend="kinematic", lidar=True) as sim:
    state = sim.reset(trundle.Pose2D(1.0, 1.0))
    while not state.scans:
        state = sim.step(trundle.Twist2D(), 0.05)
    for scan in state.scans:
        print(scan.lidar, np.isfinite(scan.ranges).sum(), "beams hit something")
