"""Step 1 of 5: load Nova Carter into a world and look at it.

Writes scene.png. On a machine with a screen, `trundle view nova_carter --world warehouse` opens a window instead.
"""

import trundle
from trundle.viewer import render

# A world is a floor with named solids. This one is generated: the same seed gives the same warehouse.
# trundle.World.from_map("map.yaml") makes one from a ROS map.
world = trundle.World.generate("warehouse", seed=7)

# A robot by name, or from your own YAML file: trundle.Robot.load("my_robot.yaml").
robot = trundle.Robot.load("nova_carter")
print(f"{robot.name}: {robot.total_mass:.1f} kg, at most {robot.limits.linear_speed} m/s")
print(f"{world.name}: {len(world.solids)} solids")

# Rendered with OpenGL if there is a driver, else by a slower software renderer; no screen is needed.
picture = render(world, robot, camera="chase")
picture.save("scene.png")
if picture.advice:
    print(picture.advice)
print("wrote scene.png")
