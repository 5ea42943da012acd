"""`ExplorerSettings`: which frontiers are worth a drive, and when one is given up."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from trundle.files.config_fields import NotNegative, Positive
from trundle.files.yaml_config import Config


class ExplorerSettings(Config):
    """When an explorer drives where.

    Attributes:
        least_frontier: Frontiers shorter than this are left out [m]: the robot does not fit through.
        least_gain: Frontiers that would show less than this are left out [m²]. With 1 instead of 0.15 an office takes
            a fifth less time, and over 99 % of its floor is still seen.
        speck_area: Unknown areas smaller than this count as seen [m²], such as what lies between two beams.
        view_range: How far what a frontier would show is counted [m].
        gain_exponent: Weight of what a frontier would show: frontiers are rated by area ** exponent / distance. With 0
            the nearest is the best.
        period: How often the explorer looks for frontiers [s].
        tries: How often it tries to get to a frontier before it gives that up.
        patience: Time without getting nearer to a frontier after which a try has failed [s].

    Raises:
        InputError: If a value is out of range.
    """

    least_frontier: NotNegative = 0.3
    least_gain: NotNegative = 1.0
    speck_area: NotNegative = 0.06
    view_range: Annotated[float, Field(gt=0.1, le=100.0)] = 6.0
    gain_exponent: Annotated[float, Field(ge=0.0, le=4.0)] = 0.5
    period: Annotated[float, Field(ge=0.05, le=60.0)] = 1.0
    tries: Annotated[int, Field(ge=1, le=20)] = 2
    patience: Positive = 40.0
