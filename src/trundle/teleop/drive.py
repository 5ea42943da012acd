"""`drive_by_hand`: the loop of a drive by keys, in real time and through the stop check."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Protocol

from trundle.geometry import Twist2D
from trundle.mission import End, LiveRun, Manual, Session, Steering
from trundle.mission.steering.standing_agent import StandingAgent

if TYPE_CHECKING:
    from trundle.geometry import Pose2D
    from trundle.mission import Episode, Observer, RunInfo, Step
    from trundle.record.drive_log import DriveLog
    from trundle.sim import Simulator


class Keys(Protocol):
    """Where keys come from."""

    def read(self) -> Twist2D | None:
        """The command of the keys that were pressed until now; None when the driver has left."""
        ...


class _Driver:
    """An observer that turns keys into directives, records the drive, and shows it."""

    def __init__(self, keys: Keys, steering: Steering, log: DriveLog, show: Callable[[Step], None]) -> None:
        self._keys, self._steering, self._log, self._show = keys, steering, log, show

    def on_start(self, run: RunInfo) -> None:
        """Nothing has moved yet."""

    def on_step(self, step: Step) -> None:
        """Record and show what was driven, and ask for what the keys say."""
        try:
            if step.index == 0:
                self._log.add(step.state)
                self._log.begin(0.0, 0.0, 0.0)
            else:
                self._log.add(step.state, step.sent)
                self._show(step)
            command = self._keys.read()
        except Exception:
            self._steering.put(End("the keys or the screen failed"))
            raise
        self._steering.put(End("the driver has left") if command is None else Manual(command.v, command.w))

    def on_end(self, episode: Episode) -> None:
        """Leave the last picture as it is."""


def drive_by_hand(
    simulator: Simulator,
    start: Pose2D,
    log: DriveLog,
    keys: Keys,
    show: Callable[[Step], None],
    *,
    period_s: float,
    seed: int,
    observers: Sequence[Observer] = (),
) -> None:
    """Drive in real time by keys until the driver leaves, or Ctrl-C, which is a normal end.

    The robot slows down and stops before it touches a solid, and before what its lidars see.

    Args:
        simulator: Moves the robot.
        start: The start pose, map frame.
        log: Gets every control period.
        keys: Where the keys come from; read once per control period.
        show: Shows each step.
        period_s: Length of a control period [s].
        seed: Of the simulator.
        observers: Notified of the drive, too.

    Raises:
        SimulationError: If the simulator fails.
    """
    steering = Steering()
    session = Session(
        simulator,
        StandingAgent(simulator, period_s=period_s),
        start,
        observers=[_Driver(keys, steering, log, show), *observers],
        seed=seed,
        stop_on_contact=False,
        measure=None,
        steering=steering,
    )
    episode = LiveRun(lambda _seed: session, steering).run()
    if session.error is not None and not isinstance(session.error, KeyboardInterrupt):
        raise session.error
    for error in episode.observer_errors:
        raise error
