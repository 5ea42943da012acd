"""The protocol of smoothers, and the smoothers by name."""

from __future__ import annotations

from typing import Any, Protocol, runtime_checkable

from trundle.costmap import Costmap
from trundle.path import Path
from trundle.registry import Registry

SMOOTHERS: Registry[Smoother] = Registry(
    "smoother",
    "trundle.smoothers",
    {"constrained": "trundle.planning.constrained_smoother:ConstrainedSmoother"},
)


@runtime_checkable
class Smoother(Protocol):
    """Smooths a path. It keeps no state that changes a result: the same path gives the same smoothed path."""

    def smooth(self, path: Path, costmap: Costmap) -> Path:
        """A path with the same ends that is free on `costmap` wherever `path` is.

        Raises:
            PlanningError: If `path` leaves the map (`OutsideMapError`) or touches something (`BlockedPoseError`).
        """
        ...


def smoother_names() -> list[str]:
    """Names that `create_smoother` takes, sorted."""
    return SMOOTHERS.names()


def create_smoother(smoother: str | Smoother, **options: Any) -> Smoother:
    """Make a smoother from its name and options, or take one as it is.

    Raises:
        UnknownNameError: If there is no smoother of that name.
        InputError: If it does not take these options, or is no smoother.
    """
    return SMOOTHERS.take(smoother, "smooth", **options)
