"""Make critics.png: what each critic of the controller mppi makes of the same samples.

python docs/pictures/control.py FOLDER
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from trundle.control.mppi import MppiController, MppiSettings
from trundle.costmap import Costmap
from trundle.geometry import FloatArray, Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.observation import Track
from trundle.path import Path as Route
from trundle.robots import Robot

SIDE, SCALE, TITLE = 300, 75.0, 26
CORNER = (-0.6, -2.0)
START, MOVES = Pose2D(0.0, 0.0, 0.0), Twist2D(0.5, 0.0)
BOX = (1.4, 0.15, 1.9, 0.9)
WALKER = Track(1, 0.0, 1.4, -1.6, 0.0, 0.7, np.diag([0.01, 0.01, 0.02, 0.02]), 0.3, confirmed=True, moving=True)
NEAR, FAR = Route(np.array([[0, 0, 0], [1.6, -0.9, -1.2]])), Route(np.array([[0, 0, 0], [3.0, 0.6, 0.2]]))
PANELS: tuple[tuple[str, str, dict[str, float], Route], ...] = (
    ("cost to go", "to_go_weight, goal_weight", {"to_go_weight": 3.0, "goal_weight": 1.0}, FAR),
    ("angle to the path", "path_angle_weight", {"path_angle_weight": 1.0, "max_angle_to_path": 0.05}, FAR),
    ("near obstacles", "repulsion_weight", {"repulsion_weight": 2.0, "inflation_radius": 0.5}, FAR),
    ("contact", "collision_cost", {"collision_cost": 100.0}, FAR),
    ("movers", "mover_weight, mover_contact_cost", {"mover_weight": 5.0, "mover_contact_cost": 50.0}, FAR),
    ("yaw of the goal", "goal_angle_weight", {"goal_angle_weight": 1.0, "threshold_to_consider": 1.2}, NEAR),
    ("backwards", "prefer_forward_weight", {"prefer_forward_weight": 2.0}, FAR),
    ("turning", "twirling_weight", {"twirling_weight": 1.0}, FAR),
    ("smoothness", "acceleration_weight, jerk_weight", {"acceleration_weight": 0.2, "jerk_weight": 0.2}, FAR),
)


def pixel(x: float, y: float) -> tuple[float, float]:
    return (x - CORNER[0]) * SCALE, TITLE + SIDE - (y - CORNER[1]) * SCALE


def weigh(weights: dict[str, float], route: Route, robot: Robot) -> tuple[FloatArray, FloatArray]:
    """The samples of one tick and what they cost by some critics alone."""
    none = {name: 0.0 for name in MppiSettings.model_fields if name.endswith("_weight") and name != "near_path_weight"}
    settings = none | {"collision_cost": 0.0, "mover_contact_cost": 0.0} | weights
    controller = MppiController(robot, samples=512, vx_std=0.35, wz_std=0.5, **settings)
    cells = np.zeros((160, 160), np.int8)
    grid = OccupancyGrid(cells, 0.05, Pose2D(-4.0, -4.0))
    x0, y0, x1, y1 = BOX
    (row0, row1), (col0, col1) = grid.world_to_cell(np.array([x0, x1]), np.array([y0, y1]))
    cells[row0:row1, col0:col1] = 100
    costmap = Costmap.from_grid(OccupancyGrid(cells, 0.05, grid.origin), robot)
    controller.set_path(route)
    if "mover_weight" in weights:
        controller.set_tracks([WALKER])
    controller.compute_velocity(START, MOVES, costmap, 0.05)
    best = controller.rollouts(512)
    if best is None:
        raise SystemExit("there are no samples to draw")
    return best.poses, best.costs


def color(share: float) -> tuple[int, int, int]:
    """From green, cheap, over yellow to red."""
    return (int(255 * min(1.0, 2.0 * share)), int(200 * min(1.0, 2.0 - 2.0 * share)), 60)


def draw(title: str, names: str, weights: dict[str, float], route: Route, robot: Robot) -> Image.Image:
    poses, costs = weigh(weights, route, robot)
    picture = Image.new("RGB", (SIDE, SIDE + TITLE + 14), "white")
    pen = ImageDraw.Draw(picture)
    ranks = np.argsort(np.argsort(costs)) / max(1, len(costs) - 1)
    spread = (costs - costs.min()) / max(float(np.percentile(costs, 95) - costs.min()), 1e-9)
    shares = np.minimum(1.0, 0.5 * ranks + 0.5 * spread) if np.ptp(costs) > 1e-6 else np.zeros(len(costs))
    for index in np.argsort(-costs)[::3].tolist():
        pen.line([pixel(x, y) for x, y, _ in poses[index].tolist()], fill=color(float(shares[index])), width=1)
    x0, y0, x1, y1 = BOX
    pen.rectangle((*pixel(x0, y1), *pixel(x1, y0)), fill=(40, 40, 40))
    corners = robot.planar.at_poses(np.array([START.as_tuple()]))[0]
    pen.polygon([pixel(x, y) for x, y in corners.tolist()], outline=(30, 80, 200), width=2)
    goal = route.goal
    tip = goal.x + 0.3 * math.cos(goal.yaw), goal.y + 0.3 * math.sin(goal.yaw)
    pen.line([pixel(goal.x, goal.y), pixel(*tip)], fill=(30, 80, 200), width=3)
    gx, gy = pixel(goal.x, goal.y)
    pen.ellipse((gx - 4, gy - 4, gx + 4, gy + 4), fill=(30, 80, 200))
    if "mover_weight" in weights:
        for seconds in (0.0, 1.0, 2.0):
            x, y = pixel(*WALKER.at(seconds))
            r = WALKER.radius * SCALE
            pen.ellipse((x - r, y - r, x + r, y + r), outline=(150, 0, 150), width=2)
    pen.rectangle((0, 0, SIDE, TITLE + 12), fill="white")
    pen.text((6, 4), title, fill="black", font_size=15)
    pen.text((6, 23), names, fill=(90, 90, 90), font_size=11)
    pen.rectangle((0, 0, SIDE - 1, SIDE + TITLE + 13), outline=(200, 200, 200))
    return picture


def main() -> None:
    robot = Robot.load("nova_carter")
    panels = [draw(*panel, robot) for panel in PANELS]
    width, height = panels[0].size
    sheet = Image.new("RGB", (3 * width, 3 * height), "white")
    for index, panel in enumerate(panels):
        sheet.paste(panel, (index % 3 * width, index // 3 * height))
    sheet.quantize(128).save(Path(sys.argv[1]) / "critics.png", optimize=True)


if __name__ == "__main__":
    main()
