"""What the page costs a browser: its size, the time to its first picture, and draw calls.

python benchmarks/web/page.py [--rounds 5] [--solids 20000] [--headed]

Uses the Chromium that is installed, headless with GL in software; --headed uses its window and the GL of the machine.
The first picture is the time from opening the address until the world has been drawn, the browser already running.
"""

from __future__ import annotations

import argparse
import gzip
import json
import shutil
import statistics
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
from playwright.sync_api import Browser, sync_playwright

from trundle import page
from trundle.geometry import Pose3D
from trundle.geometry.solids import Box, Cylinder, Solid
from trundle.maps import OccupancyGrid
from trundle.page.encoding import pack_json, to_json
from trundle.robots import Robot
from trundle.worlds import World

FLAGS = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"]
QUIET = ["--no-sandbox", "--disable-background-networking", "--disable-component-update", "--disable-sync"]
COUNT_CALLS = """
window.calls = 0;
for (const name of ["drawElements", "drawArrays", "drawElementsInstanced", "drawArraysInstanced"]) {
  const draw = WebGL2RenderingContext.prototype[name];
  WebGL2RenderingContext.prototype[name] = function (...given) { window.calls += 1; return draw.apply(this, given); };
}
const clear = WebGL2RenderingContext.prototype.clear;
window.pictures = 0;
WebGL2RenderingContext.prototype.clear = function (...given) { window.pictures += 1; return clear.apply(this, given); };
"""
TURN = """
async (count) => {
  const slider = document.querySelector("#time");
  window.calls = window.pictures = 0;
  const begin = performance.now();
  for (let i = 0; i < count; i++) {
    slider.value = (i % 9) + 0.5;
    slider.dispatchEvent(new Event("input"));
    await new Promise(requestAnimationFrame);
  }
  return [calls / Math.max(1, pictures), (1000 * pictures) / (performance.now() - begin)];
}
"""


def boot_of(world: World) -> tuple[dict[str, Any], int]:
    """A replay of ten seconds along a line, and how many bytes its scene takes as it is sent."""
    robot = Robot.load("nova_carter")
    scene = page.scene_of(world, robot, OccupancyGrid.from_world(world))
    x0, y0, _, x1, y1, _ = scene["bounds"]
    still = (0.8, 0.0, 0.8, 0.0, 0.8, 0.0, 0.5, 0.0, 0, "driving", 0.2, 0.0)
    rows = [
        [0.05 * i, x0 + (x1 - x0) * i / 200, (y0 + y1) / 2, 0.0, *still, 0.3 * i, 0.3 * i, None, None, None]
        for i in range(201)
    ]
    info = {"name": world.name, "start": rows[0][1:4], "goals": [[x1, (y0 + y1) / 2, 0.0]]}
    episode = pack_json({"rows": rows, "paths": [], "events": [], "frames": [], "costmaps": []})
    return {"mode": "replay", "scene": pack_json(scene), "run": info, "episode": episode}, len(to_json(scene))


def many_solids(count: int) -> World:
    """A hall with so many boxes and cylinders of all sizes and colours."""
    rng = np.random.default_rng(0)
    side = 0.9 * np.sqrt(count)
    solids = []
    for i in range(count):
        x, y = (float(value) for value in rng.uniform(-side / 2, side / 2, 2))
        height = float(rng.uniform(0.2, 2.0))
        shape = Box((0.4, 0.3, height)) if i % 3 else Cylinder(0.2, height)
        color = (*(float(value) for value in rng.uniform(0.2, 0.9, 3)), 1.0)
        solids.append(Solid(f"solid{i}", shape, Pose3D((x, y, height / 2)), color))
    return World("many", tuple(solids), seeds=((0.0, 0.0),))


def measure(browser: Browser, file: Path) -> tuple[float, float, float]:
    """Seconds to the first picture, draw calls a picture, pictures a second."""
    context = browser.new_context(viewport={"width": 1280, "height": 720})
    context.add_init_script(COUNT_CALLS)
    tab = context.new_page()
    tab.goto("about:blank")
    begin = time.perf_counter()
    tab.goto(file.as_uri(), wait_until="commit")
    tab.wait_for_selector("html[data-drawn=yes]", timeout=120_000)
    first = time.perf_counter() - begin
    tab.wait_for_timeout(1000)
    calls, pace = tab.evaluate(TURN, 20)
    context.close()
    return first, calls, pace


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--solids", type=int, default=20_000)
    parser.add_argument("--headed", action="store_true")
    given = parser.parse_args()
    html = page.render({"mode": "live"}, title="trundle").encode()
    print(f"page: {len(html) / 1e3:.0f} kB in one request, {len(gzip.compress(html, 6)) / 1e3:.0f} kB gzipped")
    flags = QUIET if given.headed else [*QUIET, *FLAGS]
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        chromium = shutil.which("chromium")
        browser = playwright.chromium.launch(executable_path=chromium, args=flags, headless=not given.headed)
        for world in (World.generate("warehouse", seed=4), many_solids(given.solids)):
            boot, size = boot_of(world)
            file = Path(folder) / f"{world.name}.html"
            file.write_text(page.render(boot, title=world.name), encoding="utf-8")
            found = [measure(browser, file) for _ in range(given.rounds)]
            print(
                json.dumps(
                    {
                        "world": world.name,
                        "solids": len(world.solids),
                        "scene_MB": round(size / 1e6, 2),
                        "first_picture_s": [round(first, 2) for first, _, _ in found],
                        "median_s": round(statistics.median(first for first, _, _ in found), 2),
                        "draw_calls": max(calls for _, calls, _ in found),
                        "pictures_per_s": round(statistics.median(pace for _, _, pace in found), 1),
                    }
                )
            )
        browser.close()


if __name__ == "__main__":
    main()
