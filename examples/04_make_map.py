"""Step 4 of 5: prepare an occupancy map of the world, for ROS 2's Nav2.

Writes warehouse.yaml and its image, warehouse.png.
"""

import trundle

robot = trundle.Robot.load("nova_carter")
world = trundle.World.generate("warehouse", seed=7)

# The robot can touch what is between these heights: it drives over what is below 0.10 m and under what is above 0.62 m.
print("height band:", robot.z_range)

# Cells that cannot be reached from the world's free space, such as the inside of a rack, are unknown.
grid = trundle.OccupancyGrid.from_world(world, resolution=0.05, z_range=robot.z_range)
grid.save("warehouse.yaml")

rows, cols = grid.shape
print(f"{cols} x {rows} cells of {grid.resolution} m; the corner is at {grid.origin.as_tuple()}")
print("wrote warehouse.yaml and warehouse.png")
