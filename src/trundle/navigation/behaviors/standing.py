"""Behaviors in which the robot stands: `ClearCostmap`, `Replan`, `ReplanWith` and `Wait`."""

from __future__ import annotations

import math
from typing import Any

from trundle.errors import BehaviorFailedError, InputError
from trundle.files.choice import split_choice
from trundle.geometry import Twist2D
from trundle.navigation.behaviors.behavior import Behavior, BehaviorContext
from trundle.planning import Planner, create_planner
from trundle.planning.planner import PlannerLike
from trundle.registry import is_plugin_file
from trundle.values import check_number

_STAND = Twist2D()
_SCANS_WITHIN_S = 2.0


class ClearCostmap(Behavior):
    """Forget what the scans saw, and stand until new ones have come in. The map stays.

    What no lidar sees from here is free again afterwards, even where something stands that was seen before.
    """

    def __init__(self) -> None:
        self._began: float | None = None

    def __repr__(self) -> str:
        return "ClearCostmap()"

    def start(self, context: BehaviorContext) -> None:
        """Begin now."""
        self._began = None

    def update(self, context: BehaviorContext) -> Twist2D | None:
        """Return zero; None when new scans have come in, or nothing was sensed.

        Raises:
            BehaviorFailedError: If none come in within 2 s: the robot would drive blindly.
        """
        if self._began is None:
            self._began = context.time
            if not context.sees:
                return None
            context.clear_costmap()
        elif context.sees:
            return None
        if context.time - self._began > _SCANS_WITHIN_S:
            raise BehaviorFailedError(f"no scans came in within {_SCANS_WITHIN_S:g} s after the costmap was cleared")
        return _STAND


class Replan(Behavior):
    """Plan from here to the goal by the navigator's planner, and follow that path."""

    def __repr__(self) -> str:
        return f"{type(self).__name__}()"

    def update(self, context: BehaviorContext) -> Twist2D | None:
        """Plan; done at once.

        Raises:
            BehaviorFailedError: If there is no goal, or no path to it.
        """
        context.replan(self._planner())

    def _planner(self) -> Planner | None:
        return None


class ReplanWith(Replan):
    """Plan from here to the goal by another planner, and follow that path. Later plans are the navigator's again.

    Args:
        planner: The planner: its name, a class, a function or an object.
        options: Its options.

    Raises:
        UnknownNameError: If there is no such planner.
        InputError: If it does not take an option.
    """

    def __init__(self, planner: PlannerLike, **options: Any) -> None:
        if isinstance(planner, str) and is_plugin_file(planner):  # a step of recovery is named by files of others, too
            raise InputError(f"planner {planner!r} of replan_with is a file: give its class, or write module:name")
        self.planner = create_planner(planner, **options)
        self._label = split_choice(planner)[0]

    def __repr__(self) -> str:
        return f"ReplanWith({self._label!r})"

    def _planner(self) -> Planner | None:
        return self.planner


class Wait(Behavior):
    """Stand for a while.

    Args:
        seconds: For how long [s].

    Raises:
        InputError: If that is negative, or not finite.
    """

    def __init__(self, seconds: float = 5.0) -> None:
        self.seconds = check_number("seconds", seconds, 0.0, math.inf)
        if math.isinf(self.seconds):
            raise InputError("wait needs a finite number of seconds")
        self._until = 0.0

    def __repr__(self) -> str:
        return f"Wait({self.seconds:g})"

    @property
    def time_allowance(self) -> float:
        """That time, and 5 s [s]."""
        return self.seconds + 5.0

    def start(self, context: BehaviorContext) -> None:
        """Begin now."""
        self._until = context.time + self.seconds

    def update(self, context: BehaviorContext) -> Twist2D | None:
        """Return zero; None when the time is over."""
        return None if context.time >= self._until - 1e-9 else _STAND
