"""A loading dock with a gentle and a steep ramp, and its map without and with the height of its floor.

python docs/pictures/ramps.py docs/images/ramps.png     # writes the picture
"""

import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

import trundle
from trundle.geometry import Pose3D
from trundle.geometry.solids import Box, Cylinder, Mesh, Solid
from trundle.pictures.figure import font
from trundle.viewer.cameras import Camera
from trundle.viewer.scene import render

DOCK = 0.6  # Height of the dock [m].
GENTLE, STEEP = 6.0, 1.5  # Lengths of the ramps [m], 6 and 22 degrees.
CONCRETE, DARK, WALL = (0.72, 0.73, 0.74, 1.0), (0.5, 0.52, 0.55, 1.0), (0.86, 0.87, 0.88, 1.0)
CARTON, GREEN, YELLOW = (0.76, 0.6, 0.42, 1.0), (0.2, 0.5, 0.35, 1.0), (0.95, 0.75, 0.1, 1.0)
SIZE, WIDE, MAP = (600, 470), 360, 330


def floor_height(x, y):
    """Of the yard, the ramps and the dock [m]; the dock's edge is a step."""
    rise = np.where(np.abs(y - 2.5) <= 1.0, (x - 2.0 + GENTLE) / GENTLE, (x - 2.0 + STEEP) / STEEP)
    on_ramp = (np.abs(y - 2.5) <= 1.0) | (np.abs(y + 2.5) <= 1.0)
    return DOCK * np.where(x >= 2.0, 1.0, np.where(on_ramp, np.clip(rise, 0.0, 1.0), 0.0))


def ramp(name, length, y, color):
    corners = [[0, -1, 0], [1, -1, 0], [1, 1, 0], [0, 1, 0], [1, -1, 1], [1, 1, 1]]
    faces = [[0, 2, 1], [0, 3, 2], [0, 1, 4], [3, 5, 2], [1, 2, 5], [1, 5, 4], [0, 4, 5], [0, 5, 3]]
    return Solid(name, Mesh(np.array(corners) * (length, 1.0, DOCK), faces), Pose3D((2.0 - length, y, 0.0)), color)


def box(name, middle, size, color):
    return Solid(name, Box(size), Pose3D(middle), color)


def make_dock():
    solids = [
        box("dock", (4.0, 0.0, DOCK / 2.0), (4.0, 9.0, DOCK), CONCRETE),
        ramp("gentle", GENTLE, 2.5, CONCRETE),
        ramp("steep", STEEP, -2.5, DARK),
        box("north", (0.0, 4.6, 0.8), (12.4, 0.2, 1.6), WALL),
        box("south", (0.0, -4.6, 0.8), (12.4, 0.2, 1.6), WALL),
        box("west", (-6.1, 0.0, 0.8), (0.2, 9.0, 1.6), WALL),
        box("east", (6.1, 0.0, 0.8), (0.2, 9.0, 1.6), WALL),
        box("on the ramp", (-0.4, 3.1, 0.55), (0.5, 0.5, 0.5), YELLOW),
        box("pallet", (5.2, -3.0, DOCK + 0.35), (0.8, 1.2, 0.7), CARTON),
        box("carton", (4.6, 3.6, DOCK + 0.25), (0.9, 0.7, 0.5), CARTON),
        box("crate", (-3.2, -1.2, 0.4), (1.0, 0.8, 0.8), CARTON),
    ]
    barrels = [(3.2, 0.0, DOCK), (3.2, -0.8, DOCK), (-4.6, 0.6, 0.0)]
    solids += [
        Solid(f"barrel_{i}", Cylinder(0.29, 0.88), Pose3D((x, y, z + 0.44)), GREEN)
        for i, (x, y, z) in enumerate(barrels)
    ]
    return trundle.World("dock", tuple(solids), ((-5.0, 2.5),))


def draw_map(world, **options):
    grid = trundle.OccupancyGrid.from_world(world, z_range=(0.10, 0.62), **options)
    with tempfile.TemporaryDirectory() as folder:
        grid.save(Path(folder) / "map.yaml")
        image = Image.open(Path(folder) / "map.png").convert("RGB")
    return image.resize((MAP, round(MAP * image.height / image.width)), Image.Resampling.LANCZOS)


def draw(path):
    world = make_dock()
    floor = trundle.HeightField.from_function(floor_height, ((-6.2, -4.7), (6.2, 4.7)), resolution=0.05)
    camera = Camera((-9.5, -9.5, 9.0), (0.3, 0.1, 0.2), 38.0)
    scene = render(world, trundle.Robot.load("nova_carter"), (-5.0, 2.5, 0), size=SIZE, camera=camera)
    page = Image.new("RGB", (SIZE[0] + 2 * WIDE, SIZE[1] + 36), "white")
    page.paste(Image.fromarray(scene.pixels), (0, 36))
    pen = ImageDraw.Draw(page)
    pen.text((12, 8), "A dock with two ramps", fill="black", font=font(17))
    maps = {
        "a level floor": draw_map(world),
        "floor=field, max_slope=0.17": draw_map(world, floor=floor, max_slope=0.17),
    }
    for index, (title, image) in enumerate(maps.items()):
        left = SIZE[0] + index * WIDE + (WIDE - MAP) // 2
        pen.text((left, 8), title, fill="black", font=font(17))
        page.paste(image, (left, 36 + (SIZE[1] - image.height) // 2))
    page.quantize(128, dither=Image.Dither.NONE).save(path, optimize=True)


if __name__ == "__main__":
    draw(Path(sys.argv[1]))
