"""A planner that fails at some starts, as a plug-in may."""

import ctypes
import time

from trundle.planning import create_planner

CRASH, HANG, LEAK, RAISE = 1.0, 1.5, 2.0, 2.5
"""x of the starts [m] at which it does."""


class FaultyPlanner:
    """Plans as `astar`, but for a few starts."""

    def __init__(self) -> None:
        self._planner = create_planner("astar")

    def plan(self, costmap, start, goal):
        if start.x == CRASH:
            ctypes.string_at(0)
        if start.x == HANG:
            time.sleep(1000.0)
        if start.x == LEAK:
            self.kept = [bytearray(50_000_000) for _ in range(1000)]
        if start.x == RAISE:
            raise ZeroDivisionError("planted")
        return self._planner.plan(costmap, start, goal)
