"""`drive_by_hand`: the loop of a drive by keys, in real time and through the stop check; also in MuJoCo's window."""

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
import sys
from typing import TYPE_CHECKING

from trundle.teleop.keys import StepDrive

if TYPE_CHECKING:
    from trundle.geometry import Pose2D
    from trundle.mission import Observer, Step
    from trundle.record.drive_log import DriveLog
    from trundle.sim import Simulator
    from trundle.viewer.native import NativeWindow


class Keys(Protocol):
    """Gives the commands of keys."""

    def read(self) -> Twist2D | None:
        """Return the command of the keys that were pressed until now; None when the driver has left."""
        ...


class _KeyObserver:
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
        except Exception:  # whatever a terminal or a window raises, the run has to end; it is raised again
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
        seed: Seed of the simulator.
        observers: Notified of the drive, too.

    Raises:
        SimulationError: If the simulator fails.
    """
    steering = Steering()
    session = Session(
        simulator,
        StandingAgent(simulator, period_s=period_s),
        start,
        observers=[_KeyObserver(keys, steering, log, show), *observers],
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


class WindowKeys:
    """The arrow keys of a window, until it is closed.

    Args:
        drive: Converts the keys.
        window: The window.
    """

    def __init__(self, drive: StepDrive, window: NativeWindow) -> None:
        self._drive = drive
        self._window = window

    def read(self) -> Twist2D | None:
        """Return the command of the keys that were pressed until now; None when the window is closed."""
        if not self._window.is_open:
            return None
        for key in self._window.read_keys():
            self._drive.press(key)
        return self._drive.twist()


def drive_in_window(
    simulator: Simulator,
    start: Pose2D,
    log: DriveLog,
    window: NativeWindow,
    *,
    period_s: float,
    seed: int = 0,
    observers: Sequence[Observer] = (),
) -> None:
    """Drive in real time by the arrow keys of a window, until it is closed or Ctrl-C; see `drive_by_hand`."""
    print("arrows: faster, slower, left, right   space: stop   close the window to end", file=sys.stderr)
    keys = WindowKeys(StepDrive(simulator.robot.limits), window)

    def show(step: Step) -> None:
        window.show(step.state)

    drive_by_hand(simulator, start, log, keys, show, period_s=period_s, seed=seed, observers=observers)
