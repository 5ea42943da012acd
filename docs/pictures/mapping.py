"""The pictures of docs/mapping.md that show an exploration: `python docs/pictures/mapping.py`."""

from pathlib import Path

from PIL import Image, ImageDraw

import trundle
from trundle.pictures.colors import INK, PAGE
from trundle.pictures.figure import font
from trundle.record import draw_own_map, save_png
from trundle.record.own_map import MapGrowth

IMAGES = Path(__file__).parents[1] / "images"
TIMES_S = (5.0, 30.0, 90.0)


class Growth(MapGrowth):
    """Keeps the map as it grows, as an observer."""

    def on_start(self, run):
        self.robot = run.robot

    def on_end(self, episode):
        self.final = episode.own_map


def main():
    world = {"name": "office", "seed": 1, "options": {"low_objects": False}}
    scenario = trundle.Scenario.make(
        world=world, odometry={"scale": 0.05, "heading": "3deg"}, backend="kinematic", lidar=True, known_map=False
    )
    growth = Growth()
    exploration = trundle.explore(scenario, observers=[growth], time_limit_s=900.0)
    print(exploration.message)
    save_png(draw_own_map(growth.final, title="office, explored"), IMAGES / "mapping_explored.png")
    pictures = growth.pictures_at(TIMES_S, growth.final.grid, growth.robot)
    gap, head = 16, 40
    wide, tall = pictures[0].size
    strip = Image.new("RGB", (len(pictures) * (wide + gap) - gap, tall + head), PAGE)
    draw = ImageDraw.Draw(strip)
    names = (*(f"{time:.0f} s" for time in TIMES_S), "end")
    for index, (picture, text) in enumerate(zip(pictures, names, strict=True)):
        strip.paste(picture, (index * (wide + gap), head))
        draw.text((index * (wide + gap), 8), text, font=font(20), fill=INK)
    save_png(strip, IMAGES / "mapping_growth.png")


if __name__ == "__main__":
    main()
