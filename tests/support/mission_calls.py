"""One call of each kernel of whole missions."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from trundle import _core

OUTLINE = np.array([(0.2, 0.1), (-0.2, 0.1), (-0.2, -0.1), (0.2, -0.1)])
DRIVER = _core.MissionDriver(
    *(np.zeros((60, 60), np.uint8), _core.chebyshev_field(np.zeros((60, 60), np.uint8)), 0.1, np.zeros(3)),
    *(np.array([0.1, 10.0, 0.5]), OUTLINE, OUTLINE * 1.05, np.array([1, 1, 2, 1, 2, 0.1, 0.3, 99, 0.01, 5, 0.05])),
    *(np.array([1, 0.6, 0.3, 0.8, 1.8, 0.9, 0.2, 0.6, 0.6, 0.05, 0.5, 1, 0.01]), np.array([0.2, 9, 0.02, 0.02])),
    np.array([0.5, 0.5, 10.0]),
)
WAY = np.array([(1.0, 1.0, 0.0), (4.0, 1.0, 0.0), (4.0, 4.0, 1.5)])
ONE_WAY = WAY[0], WAY[2], 30.0, WAY, np.zeros(3, bool), WAY, np.array([0.0, 3.0, 6.0]), np.array([0.5, 7.0, 20.0])


def step_mission(periods: int = 20) -> Any:
    run = DRIVER.begin(*ONE_WAY)
    for _ in range(periods):
        run.decide()
        run.move(0.2, 0.1)
    return run


def take_command() -> int:
    run = step_mission()
    run.look()
    return run.take(0.2, 0.1)


MISSION_CALLS: dict[str, Callable[[], Any]] = {
    "MissionDriver": lambda: type(DRIVER).__name__,
    "MissionDriver.drive": lambda: DRIVER.drive(
        *(WAY[:1], WAY[2:], np.array([30.0]), WAY, np.zeros(3, bool), np.array([3])),
        *(WAY, np.array([0.0, 3.0, 6.0]), np.array([3]), 2),
    ),
    "MissionDriver.begin": lambda: type(DRIVER.begin(*ONE_WAY)).__name__,
    "MissionRun": lambda: type(step_mission(0)).__name__,
    "MissionRun.decide": lambda: step_mission().decide(),
    "MissionRun.look": lambda: step_mission().look(),
    "MissionRun.take": lambda: take_command(),
    "MissionRun.move": lambda: step_mission().result(),
    "MissionRun.result": lambda: step_mission().result(),
}
