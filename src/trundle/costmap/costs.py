"""Costs of cells: Nav2's numbers, how they fall with the distance from what is occupied, and unknown cells."""

from __future__ import annotations

import functools
from typing import Literal, get_args

import numpy as np
import numpy.typing as npt

from trundle import _core
from trundle.errors import InputError, MapError
from trundle.maps.cells import FREE, OCCUPIED, UNKNOWN
from trundle.values import is_finite_number, show_value

FREE_SPACE = 0
"""Cost of a cell that is farther from every obstacle than the inflation radius."""
INSCRIBED = 253
"""Cost of a cell in which the robot's inscribed circle touches an obstacle."""
LETHAL = 254
"""Cost of an occupied cell."""
NO_INFORMATION = 255
"""Cost of an unknown cell that is blocked."""

DEFAULT_MARGIN_M = 0.3
"""By how much the inflation reaches past the circumscribed radius by default [m]."""

DEFAULT_COST_SCALING_FACTOR = 3.0
"""Decay of the cost with distance [1/m], as in Nav2's bring-up parameters."""

UnknownPolicy = Literal["blocked", "free", "costly"]
"""How unknown cells are treated."""
UNKNOWN_POLICIES: tuple[UnknownPolicy, ...] = get_args(UnknownPolicy)
"""Every `UnknownPolicy`."""

DEFAULT_UNKNOWN_COST = 200
"""What an unknown cell costs at least where unknown space is costly: by NavFn's weights 4.2 times a free one."""

_MOST_UNKNOWN_COST = INSCRIBED - 1  # that of an inscribed cell blocks

_MAX_INFLATION_CELLS = 4096  # a table of costs by squared distance then has 16 million entries


def check_inflation(inflation_radius: float, cost_scaling_factor: float, resolution: float) -> None:
    """Raise `InputError` unless these are inflation numbers that can be used."""
    if not (is_finite_number(inflation_radius) and 0.0 <= inflation_radius <= _MAX_INFLATION_CELLS * resolution):
        raise InputError(
            f"inflation_radius must be from 0 to {_MAX_INFLATION_CELLS} cells "
            f"({_MAX_INFLATION_CELLS * resolution:g} m here), got {show_value(inflation_radius)}"
        )
    if not (is_finite_number(cost_scaling_factor) and cost_scaling_factor >= 0.0):
        raise InputError(f"cost_scaling_factor must be a number of 0 or more, got {show_value(cost_scaling_factor)}")


def cost_table(
    inscribed: float, inflation_radius: float, cost_scaling_factor: float, resolution: float
) -> npt.NDArray[np.uint8]:
    """Return the costs of free cells by squared distance [cells²] to the nearest blocked cell; see `Costmap.from_grid`.

    Raises:
        InputError: If a number is out of range.
    """
    check_inflation(inflation_radius, cost_scaling_factor, resolution)
    check_inflation(inscribed, cost_scaling_factor, resolution)
    return _costs_by_distance(inscribed, inflation_radius, cost_scaling_factor, resolution)


@functools.lru_cache(maxsize=4)
def _costs_by_distance(
    inscribed: float, inflation_radius: float, cost_scaling_factor: float, resolution: float
) -> npt.NDArray[np.uint8]:
    reach = (max(inflation_radius, inscribed) + 1e-9) / resolution
    distances = np.sqrt(np.arange(int(reach * reach) + 1)) * resolution
    # Nav2's inflation layer: computeCost in nav2_costmap_2d/inflation_layer.hpp.
    costs = (252.0 * np.exp(-cost_scaling_factor * np.maximum(0.0, distances - inscribed))).astype(np.uint8)
    costs[distances <= inscribed + 1e-9] = INSCRIBED
    costs[0] = LETHAL
    costs.flags.writeable = False
    return costs


def inflate(
    cells: npt.NDArray[np.int8], table: npt.NDArray[np.uint8], floor: npt.NDArray[np.uint8] | None
) -> npt.NDArray[np.uint8]:
    """Inflate occupancy, and raise the costs to those that a keep-out mask asks for at least."""
    if floor is None:
        return _core.inflate(np.ascontiguousarray(cells), table)
    costs = _core.inflate(np.where(floor == LETHAL, np.int8(OCCUPIED), cells), table)
    return np.maximum(costs, floor)


def check_unknown(policy: str, cost: int) -> None:
    """Raise `InputError` unless these are a policy and a cost that can be used."""
    if policy not in UNKNOWN_POLICIES:
        raise InputError(f"unknown is one of {', '.join(UNKNOWN_POLICIES)}; got {policy!r}")
    if isinstance(cost, bool) or not isinstance(cost, int | np.integer) or not 0 <= cost <= _MOST_UNKNOWN_COST:
        raise InputError(f"unknown_cost must be an integer from 0 to {_MOST_UNKNOWN_COST}, got {cost!r}")


def check_unseen(policy: UnknownPolicy, unseen: npt.NDArray[np.bool_] | None, shape: tuple[int, ...]) -> None:
    """Raise `MapError` unless `unseen` names the unknown cells where the costs do not show them."""
    if policy == "blocked":
        if unseen is not None:
            raise MapError("where unknown cells block, their cost of 255 tells which they are; unseen is for others")
    elif unseen is None or unseen.shape != shape or unseen.dtype != np.bool_:
        got = "none" if unseen is None else f"{unseen.dtype} {unseen.shape}"
        raise MapError(f"where unknown cells are {policy}, unseen tells which: bool of shape {shape}, got {got}")


def open_unknown(cells: npt.NDArray[np.int8]) -> tuple[npt.NDArray[np.int8], npt.NDArray[np.bool_]]:
    """Return occupancy with unknown cells free, and which they are."""
    unseen = cells == UNKNOWN
    return np.where(unseen, np.int8(FREE), cells), unseen


def raise_unknown(costs: npt.NDArray[np.uint8], unseen: npt.NDArray[np.bool_], cost: int) -> npt.NDArray[np.uint8]:
    """Raise the costs of unknown cells to a least one."""
    return np.maximum(costs, unseen.view(np.uint8) * np.uint8(cost))
