"""`Latency`, how late data and commands arrive; `DelayedCommands`, where a robot is when a command takes effect."""

from __future__ import annotations

import itertools
import math
from typing import Annotated

from pydantic import Field

from trundle.files.yaml_config import Config
from trundle.geometry import Pose2D, Twist2D, integrate_twist, wrap_angle
from trundle.robots import Limits

_SUBSTEP_S = 0.05  # the prediction's steps: as long as a usual control period
_SAME_S = 1e-6
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


class DelayedCommands:
    """Commands that were sent and have not reached the wheels yet, and where they will take the robot.

    A command that is computed now takes effect after the delay. Until then the robot follows the commands sent before,
    within its limits of acceleration. What drives it should start from the pose that it has then.

    Args:
        limits: Limits of the robot.
        delay_s: Time [s] from a command until the wheels receive it.

    Attributes:
        delay_s: The same; may be changed.
    """

    def __init__(self, limits: Limits, delay_s: float = 0.0) -> None:
        self._limits = limits
        self.delay_s = delay_s
        self.clear()

    def clear(self) -> None:
        """Forget all commands, at the start of a run."""
        self._sent: list[tuple[float, Twist2D]] = []

    def send(self, command: Twist2D, time: float) -> None:
        """Record a command that is sent now [s]; it replaces those sent at this time or later."""
        if self.delay_s <= 0.0:
            return
        sent = self._sent
        while sent and sent[-1][0] > time - _SAME_S:
            sent.pop()
        sent.append((time, command))
        # The newest of those that have arrived is still in effect.
        while len(sent) > 1 and sent[1][0] + self.delay_s <= time + _SAME_S:
            del sent[0]

    def replace_last(self, command: Twist2D) -> None:
        """Replace the last command by what was really sent, such as what a monitor made of it."""
        if self._sent:
            self._sent[-1] = (self._sent[-1][0], command)

    def in_effect(self, time: float) -> Twist2D | None:
        """Return the command that the wheels follow at a time [s]; None if none has arrived by then."""
        arrived = [command for sent, command in self._sent if sent + self.delay_s <= time + _SAME_S]
        return arrived[-1] if arrived else None

    def predict(self, pose: Pose2D, twist: Twist2D, time: float) -> tuple[Pose2D, Twist2D]:
        """Return the pose and twist of the robot when a command that is sent now takes effect.

        Args:
            pose: Pose of base_link now, any frame.
            twist: How it moves now, base_link. It goes on so until the first command arrives.
            time: Now [s].
        """
        if self.delay_s <= 0.0:
            return pose, twist
        end = time + self.delay_s
        first = self.in_effect(time)
        pieces = [(time, twist if first is None else first)]
        pieces += [(sent + self.delay_s, command) for sent, command in self._sent]
        pieces = [(max(begin, time), command) for begin, command in pieces if begin < end - _SAME_S]
        x, y, yaw = pose.as_tuple()
        for (begin, target), (until, _) in itertools.pairwise([*pieces, (end, twist)]):
            steps = math.ceil((until - begin) / _SUBSTEP_S - _SAME_S)
            for _ in range(steps):
                before, twist = twist, self._limits.approach(twist, target, (until - begin) / steps)
                mean_v, mean_w = 0.5 * (before.v + twist.v), 0.5 * (before.w + twist.w)
                x, y, yaw = integrate_twist(x, y, yaw, mean_v, mean_w, (until - begin) / steps)
        return Pose2D(x, y, wrap_angle(yaw)), twist
