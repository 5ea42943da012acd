"""One call of each kernel of crowds."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from trundle import _core

OUTLINE = np.array([(0.2, 0.1), (-0.2, 0.1), (-0.2, -0.1), (0.2, -0.1)])
WALLED = np.pad(np.full((40, 60), 10, np.uint8), 1, constant_values=255)
FLOOR = _core.CrowdFloor(WALLED, np.zeros_like(WALLED), 0.0, 0.0, 0.1, 1.0, 3)
PEOPLE = _core.CrowdModel(
    *([FLOOR], np.array([6]), np.tile(np.array([0.2, 1.2, 1.0, 0.0]), (6, 1)), np.tile(OUTLINE, (6, 1))),
    *(np.full(6, len(OUTLINE)), np.zeros(0)),
)
WORDS, FAR, NOBODY = np.arange(4, dtype=np.uint64)[None], np.array([9.0, 9.0, 0.0, 0.0, 0.3]), np.zeros((0, 4))


def walked() -> _core.CrowdRun:
    run = _core.CrowdRun(PEOPLE)
    assert run.reset(WORDS, FAR, NOBODY) == -1
    for _ in range(40):
        run.step(FAR, NOBODY)
    return run


def crowded() -> tuple[_core.BatchCrowds, Any]:
    crowds = _core.BatchCrowds([PEOPLE], np.array([0]), np.array([0]), [np.zeros((1, 0, 4))], 5)
    where = np.arange(5), np.zeros(5, np.int64), np.full((5, 3), 9.0), 0.3
    return crowds, crowds.place(*where, np.arange(20, dtype=np.uint64).reshape(5, 1, 4), 2)


CROWD_CALLS: dict[str, Callable[[], Any]] = {
    "BatchCrowds": lambda: type(crowded()[0]).__name__,
    "BatchCrowds.place": lambda: crowded()[1],
    "BatchCrowds.members": lambda: crowded()[0].members(3, 0.02),
    "CrowdFloor": lambda: type(FLOOR).__name__,
    "CrowdModel": lambda: type(PEOPLE).__name__,
    "CrowdRun": lambda: type(walked()).__name__,
    "CrowdRun.reset": lambda: _core.CrowdRun(PEOPLE).reset(WORDS, FAR, NOBODY),
    "CrowdRun.step": lambda: walked().step(FAR, NOBODY),
    "CrowdRun.at": lambda: walked().at(2.03),
    "CrowdRun.index": lambda: walked().index,
}
