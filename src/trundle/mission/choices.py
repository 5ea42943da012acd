"""A scenario's world, and how a map becomes one."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from trundle.files.choice import Choice
from trundle.files.config_fields import Positive
from trundle.files.yaml_config import Config
from trundle.maps.cells import MOST_CELLS
from trundle.worlds.load import is_world_file

_READING = ("trusted", "time_limit_s", "memory_limit_gb")
"""Options of `World.load` that say how far a file is trusted."""


class WorldChoice(Choice):
    """A world: `warehouse`, `{name: warehouse, seed: 7, options: {aisle_width: 1.4}}`, or a file, `hall.sdf`.

    Attributes:
        name: Name of a generated world, or the path of a world's file; a path in a file is relative to that file.
        options: Options of the generator, or of the file's loader.
        seed: Seed of a generated world; none means the scenario's.
    """

    seed: int | None = None

    @property
    def is_file(self) -> bool:
        """Whether it is loaded from a file."""
        return is_world_file(self.name)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.is_file and self.seed is not None:
            raise ValueError("seed is for generated worlds; this one is a file")
        for option in _READING:
            if self.is_file and option in self.options:
                raise ValueError(
                    f"{option} is no option of a scenario, which others may have written: set TRUNDLE_TRUSTED, "
                    "TRUNDLE_READ_SECONDS or TRUNDLE_READ_GIGABYTES instead"
                )
        return self


class MapOptions(Config):
    """How a map becomes a world: `{height: 0.5, unknown: free}`.

    Attributes:
        height: Height of the walls [m].
        unknown: What unknown cells are in the simulated world; in the map they stay unknown. None means solid where
            the scenario's `unknown` is blocked, and free otherwise.
        max_cells: The most cells of the map; none means 20 million.
    """

    height: Positive = 1.0
    unknown: Literal["solid", "free"] | None = None
    max_cells: Annotated[int, Field(ge=1, le=MOST_CELLS)] | None = None


class RecordChoice(Config):
    """How a run is recorded besides its folder: `mcap`, or `{name: mcap, distro: kilted}`.

    Attributes:
        name: The format: "mcap" is rosbag2's.
        distro: The distribution of ROS 2 whose message types, hashes and QoS the recording has; none means jazzy.
    """

    name: Literal["mcap"] = "mcap"
    distro: Literal["humble", "jazzy", "kilted", "lyrical"] | None = None
