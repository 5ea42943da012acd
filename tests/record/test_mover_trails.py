from __future__ import annotations

import numpy as np
from PIL import Image

from trundle.mission import Scenario
from trundle.pictures.colors import WARNING
from trundle.record import RunFolder

LINES = """\
world: {name: warehouse, seed: 1, options: {size: [16, 12]}}
backend: kinematic
start: [6.5, 3, -1.57]
goal: [6.5, 1]
movers: [{name: bob, body: person, path: [[7, 4.5], [7, -4]], speed: 1.0}]
"""


def count_of(path):
    pixels = np.asarray(Image.open(path).convert("RGB")).astype(int)
    return int((np.abs(pixels - WARNING).sum(axis=-1) < 12).sum())


def test_the_overlay_of_a_run_shows_its_movers_with_trails(tmp_path):
    (tmp_path / "s.yaml").write_text(LINES)
    counts = []
    for movers in (True, False):
        scenario = Scenario.load(tmp_path / "s.yaml")
        if not movers:
            scenario = scenario.model_copy(update={"movers": ()})
        folder = RunFolder(tmp_path / str(movers), video=False)
        with scenario.build() as mission:
            mission.run(observers=[folder])
        counts.append(count_of(folder.path / "overlay.png"))
    assert counts[0] > counts[1] + 100
