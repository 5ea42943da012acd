"""Plan with A* on the inflated map of the warehouse, and follow the path to the goal."""

from isaacsim import SimulationApp

simulation_app = SimulationApp({"headless": True})

import heapq
import math

import numpy as np
import yaml
from isaacsim.core.api import World
from isaacsim.core.utils.stage import add_reference_to_stage
from isaacsim.robot.wheeled_robots.controllers.differential_controller import DifferentialController
from isaacsim.robot.wheeled_robots.robots import WheeledRobot
from isaacsim.storage.native import get_assets_root_path
from PIL import Image
from scipy.ndimage import binary_dilation

ROBOT_RADIUS = 0.6
GOAL_TOLERANCE = 0.15

with open("map.yaml") as file:
    info = yaml.safe_load(file)
with open("task.yaml") as file:
    task = yaml.safe_load(file)
resolution, origin = info["resolution"], info["origin"]
image = np.flipud(np.array(Image.open(info["image"]).convert("L")))
blocked = image < 250
cells = math.ceil(ROBOT_RADIUS / resolution)
y, x = np.ogrid[-cells : cells + 1, -cells : cells + 1]
blocked = binary_dilation(blocked, structure=x * x + y * y <= cells * cells)


def world_to_grid(point):
    return int((point[1] - origin[1]) / resolution), int((point[0] - origin[0]) / resolution)


def grid_to_world(cell):
    return np.array([origin[0] + (cell[1] + 0.5) * resolution, origin[1] + (cell[0] + 0.5) * resolution])


def a_star(start, goal):
    queue, came_from, cost = [(0.0, start)], {start: None}, {start: 0.0}
    while queue:
        _, cell = heapq.heappop(queue)
        if cell == goal:
            break
        for dr, dc in ((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)):
            near = (cell[0] + dr, cell[1] + dc)
            inside = 0 <= near[0] < blocked.shape[0] and 0 <= near[1] < blocked.shape[1]
            if not inside or blocked[near]:
                continue
            new_cost = cost[cell] + math.hypot(dr, dc)
            if near not in cost or new_cost < cost[near]:
                cost[near], came_from[near] = new_cost, cell
                heapq.heappush(queue, (new_cost + math.dist(near, goal), near))
    path, cell = [], goal
    while cell is not None:
        path.append(grid_to_world(cell))
        cell = came_from[cell]
    return path[::-1]


path = a_star(world_to_grid(task["start"]), world_to_grid(task["goal"]))
print(f"path of {len(path)} cells")

assets_root_path = get_assets_root_path()
world = World(stage_units_in_meters=1.0)
add_reference_to_stage(
    assets_root_path + "/Isaac/Environments/Simple_Warehouse/warehouse_with_forklifts.usd", "/World/Warehouse"
)
yaw = task["start"][2]
carter = world.scene.add(
    WheeledRobot(
        prim_path="/World/Nova_Carter",
        name="carter",
        wheel_dof_names=["joint_wheel_left", "joint_wheel_right"],
        create_robot=True,
        usd_path=assets_root_path + "/Isaac/Robots/NVIDIA/NovaCarter/nova_carter.usd",
        position=np.array([task["start"][0], task["start"][1], 0.02]),
        orientation=np.array([math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2)]),
    )
)
controller = DifferentialController(name="drive", wheel_radius=0.14, wheel_base=0.4132)
world.reset()

target, reached = 0, False
while simulation_app.is_running():
    world.step(render=True)
    if not world.is_playing():
        continue
    position, orientation = carter.get_world_pose()
    w, _, _, z = orientation
    heading = 2.0 * math.atan2(z, w)
    if math.dist(position[:2], path[-1]) < GOAL_TOLERANCE:
        carter.apply_wheel_actions(controller.forward([0.0, 0.0]))
        reached = True
        break
    while target < len(path) - 1 and math.dist(position[:2], path[target]) < 0.5:
        target += 1
    dx, dy = path[target] - position[:2]
    error = math.atan2(dy, dx) - heading
    error = math.atan2(math.sin(error), math.cos(error))
    speed = 0.0 if abs(error) > 0.6 else 0.6 * max(0.2, 1.0 - abs(error))
    carter.apply_wheel_actions(controller.forward([speed, float(np.clip(1.5 * error, -0.7, 0.7))]))

print(f"reached: {reached}, at {position[0]:.2f}, {position[1]:.2f}, after {world.current_time:.1f} s")
simulation_app.close()
