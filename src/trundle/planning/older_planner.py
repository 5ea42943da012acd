"""`OlderPlanner`: gives a planner that takes only some keywords of `Planner` the whole protocol."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol, TypeVar

from trundle.costmap import Costmap
from trundle.geometry import Pose2D
from trundle.path import Path
from trundle.planning.cancellation import Cancellation, Patience
from trundle.registry import keywords_taken

_KEYWORDS = ("goal_yaw_free", "deadline_s", "cancel")


class _SomePlanner(Protocol):
    """A planner whose `plan` takes a costmap, a start and a goal, and any of the keywords."""

    @property
    def plan(self) -> Callable[..., Path]: ...


_PlannerT = TypeVar("_PlannerT", bound=_SomePlanner)


class OlderPlanner:
    """Hands a planner the keywords that its `plan` takes.

    Without `goal_yaw_free` its paths end with the goal's own yaw. Without `deadline_s` or `cancel` it cannot be stopped
    once it has begun.

    Args:
        planner: What plans.
        taken: Which of the keywords it takes.

    Attributes:
        planner: The same.
    """

    def __init__(self, planner: _SomePlanner, taken: frozenset[str]) -> None:
        self.planner = planner
        self._taken = taken

    def plan(
        self,
        costmap: Costmap,
        start: Pose2D,
        goal: Pose2D,
        *,
        goal_yaw_free: bool = False,
        deadline_s: float | None = None,
        cancel: Cancellation | None = None,
    ) -> Path:
        """Plan from `start` to `goal`; see `Planner`."""
        Patience(deadline_s, cancel, "no path found yet").check()
        given: dict[str, Any] = {"goal_yaw_free": goal_yaw_free, "deadline_s": deadline_s, "cancel": cancel}
        return self.planner.plan(
            costmap, start, goal, **{name: value for name, value in given.items() if name in self._taken}
        )


def adapt_planner(planner: _PlannerT) -> _PlannerT | OlderPlanner:
    """The planner itself if its `plan` takes every keyword of the protocol, else an `OlderPlanner` around it."""
    taken = keywords_taken(planner.plan, _KEYWORDS)
    return planner if len(taken) == len(_KEYWORDS) else OlderPlanner(planner, taken)
