"""How unknown cells are treated: as blocked, free, or free at a price."""

from __future__ import annotations

from typing import Literal, get_args

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError, MapError
from trundle.maps.cells import FREE, UNKNOWN

UnknownPolicy = Literal["blocked", "free", "costly"]
"""How unknown cells are treated."""
UNKNOWN_POLICIES: tuple[UnknownPolicy, ...] = get_args(UnknownPolicy)
"""Every `UnknownPolicy`."""

DEFAULT_UNKNOWN_COST = 200
"""What an unknown cell costs at least where unknown space is costly: by NavFn's weights 4.2 times a free one."""

_MOST = 252  # 253 blocks


def check_unknown(policy: str, cost: int) -> None:
    """Raise `InputError` unless these are a policy and a cost that can be used."""
    if policy not in UNKNOWN_POLICIES:
        raise InputError(f"unknown is one of {', '.join(UNKNOWN_POLICIES)}; got {policy!r}")
    if isinstance(cost, bool) or not isinstance(cost, int | np.integer) or not 0 <= cost <= _MOST:
        raise InputError(f"unknown_cost must be an integer from 0 to {_MOST}, got {cost!r}")


def check_unseen(policy: UnknownPolicy, unseen: npt.NDArray[np.bool_] | None, shape: tuple[int, ...]) -> None:
    """Raise `MapError` unless `unseen` names the unknown cells where the costs do not show them."""
    if policy == "blocked":
        if unseen is not None:
            raise MapError("where unknown cells block, their cost of 255 tells which they are; unseen is for others")
    elif unseen is None or unseen.shape != shape or unseen.dtype != np.bool_:
        got = "none" if unseen is None else f"{unseen.dtype} {unseen.shape}"
        raise MapError(f"where unknown cells are {policy}, unseen tells which: bool of shape {shape}, got {got}")


def open_unknown(cells: npt.NDArray[np.int8]) -> tuple[npt.NDArray[np.int8], npt.NDArray[np.bool_]]:
    """Occupancy with unknown cells free, and which they are."""
    unseen = cells == UNKNOWN
    return np.where(unseen, np.int8(FREE), cells), unseen


def raise_unknown(costs: npt.NDArray[np.uint8], unseen: npt.NDArray[np.bool_], cost: int) -> npt.NDArray[np.uint8]:
    """Costs with those of unknown cells at least as high."""
    return np.maximum(costs, unseen.view(np.uint8) * np.uint8(cost))
