"""`Latency`: how late data and commands arrive."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from trundle.files.yaml_config import Config

_Delay = Annotated[float, Field(ge=0.0, le=2.0)]


class Latency(Config):
    """How late data and commands arrive: `{scan_age_s: 0.1, command_delay_s: 0.05}`.

    Attributes:
        scan_age_s: Time [s] from the measurement of a scan until the robot's software gets it, at most 2. The scan
            keeps the time of its measurement.
        command_delay_s: Time [s] from a command until the wheels receive it, at most 2: it takes effect at the next
            physics step, or control period where a simulator does not give its `timestep`.
    """

    scan_age_s: _Delay = 0.0
    command_delay_s: _Delay = 0.0
