"""`Rules`: what ends a run, where a benchmark judges it and not the robot."""

from __future__ import annotations

from trundle.files.config_fields import Positive
from trundle.files.yaml_config import Config


class Rules(Config):
    """What ends a run besides the usual: `{arrival_radius: 1.0, every_contact: true}`, as in BARN.

    Attributes:
        arrival_radius: The run ends as arrived when the robot truly is this close to its last goal [m], at any speed
            and yaw, whatever it believes; none means when the robot says that it has arrived.
        every_contact: A moving obstacle that runs into the robot while it stands is a collision, too.
    """

    arrival_radius: Positive | None = None
    every_contact: bool = False
