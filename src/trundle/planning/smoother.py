"""The protocol of smoothers, and the smoothers by name."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol, TypeAlias, cast, runtime_checkable

from trundle.costmap import Costmap
from trundle.files.choice import Choice, split_choice
from trundle.path import Path
from trundle.registry import Contract, Registry

SMOOTHERS: Registry[Smoother] = Registry(
    "smoother",
    "trundle.smoothers",
    {"constrained": "trundle.planning.constrained_smoother:ConstrainedSmoother"},
    contract=Contract({"smooth": "path, costmap"}),
)


@runtime_checkable
class Smoother(Protocol):
    """Smooths a path. It keeps no state that changes a result: the same path gives the same smoothed path.

    `smooth` is all that trundle uses of a smoother, so a class needs nothing else.
    """

    def smooth(self, path: Path, costmap: Costmap) -> Path:
        """Return a path with the same ends that is free on `costmap` wherever `path` is.

        Raises:
            PlanningError: If `path` leaves the map (`OutsideMapError`) or touches something (`BlockedPoseError`).
        """
        ...


SmootherLike: TypeAlias = str | Choice | Smoother | Callable[..., object]
"""Whatever smooths a path: a name, `"module:name"`, an object with `smooth`, or a class of such objects."""


def smoother_names() -> list[str]:
    """Return names that `create_smoother` takes, sorted."""
    return SMOOTHERS.names()


def create_smoother(smoother: SmootherLike, **options: Any) -> Smoother:
    """Make a smoother from its name or class and options, or take one as it is.

    Raises:
        UnknownNameError: If there is no smoother of that name.
        InputError: If it does not take these options, or is no smoother.
    """
    _, given, chosen = split_choice(smoother)
    return cast("Smoother", SMOOTHERS.resolve(given, {}, {**chosen, **options}))
