"""`CostmapSettings`: every option of a costmap, for Python, scenarios and the command line alike."""

from __future__ import annotations

from typing import Annotated

import numpy.typing as npt
from pydantic import Field

from trundle.costmap.costmap import Costmap
from trundle.costmap.costs import DEFAULT_COST_SCALING_FACTOR, DEFAULT_UNKNOWN_COST, UnknownPolicy
from trundle.errors import InputError
from trundle.files.yaml_config import Config, NotNegative
from trundle.maps.grid import OccupancyGrid
from trundle.maps.masks import KeepoutMask
from trundle.robots import Robot


class CostmapSettings(Config):
    """How a costmap is made of a map; `Costmap.from_grid` says what each option does.

    A scenario has these fields at its top level, and `trundle run` and `trundle plan` have an option for each.

    Attributes:
        inflation_radius: Distance from an obstacle up to which costs are raised [m]. If None, the robot's
            circumscribed radius + 0.3 m.
        cost_scaling_factor: Exponential decay of the cost with the distance from an obstacle [1/m].
        unknown: How unknown cells of the map are treated: blocked, free, or costly.
        unknown_cost: Lowest cost of an unknown cell where they are costly, 0 to 252. If None, 200.

    Raises:
        InputError: If a value is out of range.
    """

    inflation_radius: NotNegative | None = None
    cost_scaling_factor: NotNegative = DEFAULT_COST_SCALING_FACTOR
    unknown: UnknownPolicy = "blocked"
    unknown_cost: Annotated[int, Field(ge=0, le=252)] | None = None

    def make_costmap(
        self, grid: OccupancyGrid, footprint: Robot | npt.ArrayLike, *, keepout: KeepoutMask | None = None
    ) -> Costmap:
        """Make the costmap of a map; arguments and errors as in `Costmap.from_grid`.

        Raises:
            InputError: If `unknown_cost` is given and unknown cells are not costly.
        """
        check_unknown_cost(self)
        return Costmap.from_grid(
            grid,
            footprint,
            self.inflation_radius,
            self.cost_scaling_factor,
            keepout=keepout,
            unknown=self.unknown,
            unknown_cost=DEFAULT_UNKNOWN_COST if self.unknown_cost is None else self.unknown_cost,
        )


def check_unknown_cost(settings: CostmapSettings) -> None:
    """Check that a cost of unknown cells comes with unknown cells that are costly.

    Raises:
        InputError: If it does not.
    """
    if settings.unknown_cost is not None and settings.unknown != "costly":
        raise InputError('unknown_cost is what unknown cells cost where unknown="costly": give both, or none')
