"""The map of a robot that makes its own, on the live page: it grows, with poses, loops and corrections over it."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from browser.conftest import ADDRESS, until
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.mission.own_map import Correction, MapTrack
from trundle.page.frames import own_map_of

pytestmark = pytest.mark.browser

COLOURS = """
() => {
  const { width, height } = document.querySelector("#map");
  const { data } = document.querySelector("#map").getContext("2d").getImageData(0, 0, width, height);
  const found = {};
  for (let i = 0; i < data.length; i += 4) {
    let colour = `${data[i]},${data[i + 1]},${data[i + 2]}`;
    if (data[i + 2] - data[i] > 40 && data[i + 1] - data[i] < 60) colour = "blue";
    found[colour] = (found[colour] ?? 0) + 1;
  }
  return found;
}
"""
FREE, WALL, POSE, LOOP = "255,255,255", "41,46,58", "0,135,155", "blue"
SHOWN = """([colour, least]) => {
  const canvas = document.querySelector("#map");
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  let count = 0;
  for (let i = 0; i < data.length; i += 4) if (`${data[i]},${data[i + 1]},${data[i + 2]}` === colour) count++;
  return count > least;
}"""


@pytest.fixture
def exploring(open_page: Any, played: Any) -> Any:
    """A page that shows a run without a map, whose localizer makes one."""
    played.recorded = type(played.recorded)({**played.recorded.scene, "map": None}, played.recorded.run)
    tab, seen = open_page(ADDRESS, prepare=played.attach)
    tab.wait_for_selector("#world option", state="attached")
    played.send("run", info={**played.recorded.run["info"], "localizer": "slam", "goals": []}, n=1)
    rows = played.recorded.run["rows"][:1]
    played.send("log", **{"from": 0, "rows": rows, "paths": [], "events": []})
    played.frame(goals=[], scans=[])
    tab.wait_for_selector("#pause:not([disabled])")
    assert tab.locator("#layer-graph").count() == 1
    yield tab
    assert not seen.problems


def grow(played: Any, width: int) -> None:
    """The robot has mapped a room of so many cells of 0.05 m, from poses of which a loop joins two."""
    cells = np.full((160, width), -1, np.int8)
    cells[10:-10, 10:-10] = 0
    cells[10:14, 10:-10] = 100
    grid = OccupancyGrid(cells, 0.05, Pose2D(-5.0, -4.0))
    poses = np.array([(-4.0 + 0.4 * k, 2.5 - 0.5 * (k > 3), 0.0) for k in range(8)])
    track = MapTrack(poses, np.array([(0, 4), (2, 7)], np.int32), (Correction(0.42, 0.05, 12.0, 1.0, -2.0),))
    played.send("map", **own_map_of(grid, track))


def test_the_map_grows_with_its_poses_loops_and_corrections(exploring: Any, played: Any) -> None:
    label = exploring.locator("label:has(#layer-graph)")
    assert label.get_attribute("hidden") is not None
    before = exploring.evaluate(COLOURS)
    assert before.get(FREE, 0) < 100
    grow(played, 80)
    exploring.wait_for_function(SHOWN, arg=[FREE, 1000])
    half = exploring.evaluate(COLOURS)
    assert min(half[WALL], half[LOOP], half[POSE]) > 20
    assert label.get_attribute("hidden") is None
    grow(played, 160)
    exploring.wait_for_function(SHOWN, arg=[FREE, 1.5 * half[FREE]])
    exploring.locator("summary", has_text="Layers").click()
    exploring.click("#layer-graph")
    exploring.wait_for_function("() => !document.querySelector('#layer-graph').checked")
    until(exploring, lambda: all(exploring.evaluate(COLOURS).get(of, 0) < half[of] / 2 for of in (POSE, LOOP)))


def test_a_map_of_100_m_is_drawn(exploring: Any, played: Any) -> None:
    rng = np.random.default_rng(0)
    cells = np.zeros((2000, 2000), np.int8)
    cells[rng.random(cells.shape) < 0.02] = 100
    poses = rng.uniform(-45.0, 45.0, (9_000, 3))
    shown = own_map_of(OccupancyGrid(cells, 0.05, Pose2D(-50.0, -50.0)), MapTrack(poses, np.empty((0, 2), np.int32)))
    assert len(json.dumps(shown)) < 1_000_000
    played.send("map", **shown)
    exploring.wait_for_function(SHOWN, arg=[FREE, 10_000])
