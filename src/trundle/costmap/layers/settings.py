"""`LayersSettings`: every option of the layers, with the names that Nav2 uses where it has the option."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field, model_validator

from trundle.files.config_fields import NotNegative, Positive
from trundle.files.yaml_config import Config


class ObstacleLayerSettings(Config):
    """How scans mark and clear cells.

    A cell is hit by a scan in which at least one beam ends in it, and passed by one whose beams only go through it. One
    hit alone marks nothing unless `hits_to_mark` is 1: a range that is a few centimetres short now and then does not
    thicken a wall. What moved away disappears after `misses_to_clear` scans through its place. Between the two a cell
    stays as it is.

    Attributes:
        obstacle_max_range: Farthest range at which a beam marks [m].
        obstacle_min_range: Nearest range at which a beam marks [m].
        raytrace_max_range: Up to where a beam clears [m].
        raytrace_min_range: From where a beam clears [m].
        observation_persistence: A mark that no scan has hit for so long disappears [s]; none means that only beams
            clear.
        source_timeout: Scans that are older than this are ignored [s].
        hits_to_mark: In how many scans a cell must be hit before it is marked, 1 to 5.
        misses_to_clear: How many scans must pass through a marked cell before it is cleared, 1 to 10.
        clear_static: Whether beams also clear obstacles of the static map.
        static_tolerance: Nothing is marked within this distance of an obstacle of the static map [m], between centres
            of cells, as a robot that is not quite where it believes to be sees walls a little beside their place. None
            means the eight cells around it; 0 marks everything. Without effect with `clear_static`.
        footprint_clearing_enabled: Whether what lies within the robot's footprint is cleared.

    Raises:
        InputError: If a value is out of range.
    """

    obstacle_max_range: Positive = 10.0
    obstacle_min_range: NotNegative = 0.0
    raytrace_max_range: Positive = 12.0
    raytrace_min_range: NotNegative = 0.0
    observation_persistence: NotNegative | None = None
    source_timeout: Positive = 1.0
    hits_to_mark: Annotated[int, Field(ge=1, le=5)] = 2
    misses_to_clear: Annotated[int, Field(ge=1, le=10)] = 5
    clear_static: bool = False
    static_tolerance: NotNegative | None = None
    footprint_clearing_enabled: bool = True

    @model_validator(mode="after")
    def _check(self) -> Self:
        for name in ("obstacle", "raytrace"):
            low, high = getattr(self, f"{name}_min_range"), getattr(self, f"{name}_max_range")
            if not low < high <= 1000.0:
                raise ValueError(
                    f"{name}_max_range {high:g} m must be above {name}_min_range {low:g} m, and at most 1000 m"
                )
        return self


class LayersSettings(Config):
    """The layers of a costmap and its extent.

    Attributes:
        obstacle: Obstacles from scans; none leaves them out.
        rolling_window: Whether the costmap is a window that moves with the robot instead of the whole map. What was
            sensed outside the window is forgotten.
        width: Of the window, or of the first extent where there is no map [m].
        height: As width [m].

    Raises:
        InputError: If a value is out of range.
    """

    obstacle: ObstacleLayerSettings | None = ObstacleLayerSettings()
    rolling_window: bool = False
    width: Annotated[float, Field(gt=0.0, le=1000.0)] = 12.0
    height: Annotated[float, Field(gt=0.0, le=1000.0)] = 12.0
