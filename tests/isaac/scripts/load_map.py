"""Load a ROS map, draw it, and put boxes where cells are occupied."""

from isaacsim import SimulationApp

simulation_app = SimulationApp({"headless": True})

import matplotlib
import numpy as np
import yaml
from isaacsim.core.api import World
from isaacsim.core.api.objects import FixedCuboid
from PIL import Image

matplotlib.use("Agg")
import matplotlib.pyplot as plt

with open("map.yaml") as file:
    info = yaml.safe_load(file)
image = np.array(Image.open(info["image"]).convert("L"))
occupancy = 1.0 - image / 255.0
occupied = np.flipud(occupancy > info["occupied_thresh"])
free = np.flipud(occupancy < info["free_thresh"])
resolution, origin = info["resolution"], info["origin"]

plt.imshow(image, cmap="gray")
plt.savefig("overview.png")

world = World()
world.scene.add_default_ground_plane()
rows, columns = np.nonzero(occupied)
for number, (row, column) in enumerate(list(zip(rows, columns))[:20]):
    world.scene.add(
        FixedCuboid(
            prim_path=f"/World/Cells/cell_{number}",
            name=f"cell_{number}",
            position=np.array([origin[0] + (column + 0.5) * resolution, origin[1] + (row + 0.5) * resolution, 0.25]),
            scale=np.array([resolution, resolution, 0.5]),
            color=np.array([0.8, 0.2, 0.2]),
        )
    )
world.reset()
for _ in range(10):
    world.step(render=False)
print(f"map {image.shape[1]} x {image.shape[0]}, occupied {occupied.sum()}, free {free.sum()}")
simulation_app.close()
