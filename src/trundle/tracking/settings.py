"""`TrackerSettings`: what a tracker takes for something that moves."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from trundle.files.config_fields import NotNegative, Positive
from trundle.files.yaml_config import Config


class TrackerSettings(Config):
    """What a tracker takes for something that moves, and how long it remembers it.

    Attributes:
        max_range: Hits farther away than this are left out [m].
        max_size: Larger things are parts of the building [m].
        min_points: So many points of a scan count as something.
        same_surface: Points of two scans that are this close belong to one surface [m]; several times the noise of the
            lidars.
        acceleration: Of the movers that are followed [m/s²]: how much their velocity may change in a second, one
            standard deviation.
        min_speed: What is slower stands [m/s].
        confirm_scans: So many scans must show that something moves before its track is confirmed.
        hidden_s: How long a confirmed track is kept while something hides it [s], at most: one whose velocity has just
            changed is forgotten earlier.
        aside_s: How long a confirmed track is kept while it is outside the field of view of every lidar [s], at most.
        source_timeout: Scans that are older than this are ignored [s].

    Raises:
        InputError: If a value is out of range.
    """

    max_range: Positive = 15.0
    max_size: Positive = 3.0
    min_points: Annotated[int, Field(ge=2)] = 3
    same_surface: Positive = 0.07
    acceleration: Positive = 0.6
    min_speed: NotNegative = 0.2
    confirm_scans: Annotated[int, Field(ge=1)] = 2
    hidden_s: NotNegative = 0.8
    aside_s: NotNegative = 1.5
    source_timeout: Positive = 1.0
