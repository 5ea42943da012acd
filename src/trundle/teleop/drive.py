"""`drive_by_hand`: keys become commands, which pass the stop check in real time; also in MuJoCo's window."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Protocol

import numpy as np

from trundle.control.collision import FOOTPRINT_PADDING_M, stopping_poses
from trundle.geometry import Goal, Pose2D, Twist2D
from trundle.mission import End, LiveRun, Manual, Session, Steering
from trundle.navigation import Agent, AgentInfo, NavigationStatus
from trundle.navigation.agent import CONTROL_PERIOD_S
from trundle.navigation.command_check import AssistedCommand, assist_teleop
from trundle.observation import Estimate, Observation
from trundle.sim import Simulator
from trundle.sim.footprint import FootprintChecker
from trundle.worlds import World

if TYPE_CHECKING:
    from trundle.mission import Episode, Observer, RunInfo, Step
    from trundle.record.drive_log import DriveLog
    from trundle.robots import Limits
    from trundle.viewer.native import NativeWindow


DEAD_MAN_S = 0.3
"""How long a key press is active. A held key repeats faster than this; after a release the robot stops."""

SPEED_SHARE = 0.6
"""Share of the robot's maximum speeds that a key commands: a key is on or off, so the fastest is hard to steer."""

_ARROWS = {b"A": "i", b"B": "k", b"C": "l", b"D": "j"}
_FORWARD = {"i": 1.0, "w": 1.0, "k": -1.0, "s": -1.0}
_LEFT = {"j": 1.0, "a": 1.0, "l": -1.0, "d": -1.0}


class KeyDrive:
    """Converts key presses to a twist that ends when the keys are released.

    Forward and turn have separate dead-man timers, so that alternating two keys drives an arc.
    """

    def __init__(self, limits: Limits) -> None:
        self._v = SPEED_SHARE * limits.linear_speed
        self._w = SPEED_SHARE * limits.angular_speed
        self._forward = (0.0, float("-inf"))
        self._left = (0.0, float("-inf"))
        self.done = False

    def press(self, key: str, now: float) -> None:
        """Process a key at a time `now` [s]; unknown keys do nothing."""
        if key in _FORWARD:
            self._forward = (_FORWARD[key], now)
        elif key in _LEFT:
            self._left = (_LEFT[key], now)
        elif key == " ":
            self._forward = self._left = (0.0, now)
        elif key == "q":
            self.done = True

    def twist(self, now: float) -> Twist2D:
        """Return the command at a time `now` [s]."""
        forward, left = (sign if now - pressed <= DEAD_MAN_S else 0.0 for sign, pressed in (self._forward, self._left))
        return Twist2D(forward * self._v, left * self._w)


class StepDrive:
    """Converts single key presses to a twist, in steps of a fifth of the robot's maximum speeds.

    The window reports only key presses, not releases, so that a key cannot mean "while held": up and down change the
    speed, left and right the turn, and `stop` ends both.
    """

    STEPS = 5

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._forward = 0
        self._left = 0

    def press(self, key: str) -> None:
        """Process one key of `NativeWindow.read_keys`; others do nothing."""
        match key:
            case "up" | "down":
                self._forward = self._stepped(self._forward, key == "up")
            case "left" | "right":
                self._left = self._stepped(self._left, key == "left")
            case "stop":
                self._forward = self._left = 0
            case _:
                pass

    def twist(self) -> Twist2D:
        """Return the command."""
        return Twist2D(
            self._forward / self.STEPS * self._limits.linear_speed,
            self._left / self.STEPS * self._limits.angular_speed,
        )

    def _stepped(self, value: int, up: bool) -> int:
        return max(-self.STEPS, min(self.STEPS, value + (1 if up else -1)))


def split_keys(data: bytes) -> tuple[list[str], bytes]:
    """Split what a terminal sent into keys, arrows as i, k, j, l; an unfinished escape sequence is returned."""
    keys: list[str] = []
    at = 0
    while at < len(data):
        byte = data[at : at + 1]
        if byte != b"\x1b":
            keys.append(byte.decode("ascii", "replace").lower())
            at += 1
            continue
        if data[at + 1 : at + 2] not in (b"[", b"O"):
            if at + 1 == len(data):
                return keys, data[at:]
            at += 1
            continue
        end = at + 2
        while end < len(data) and not 0x40 <= data[end] <= 0x7E:
            end += 1
        if end == len(data):
            return keys, data[at:]
        if data[end : end + 1] in _ARROWS:
            keys.append(_ARROWS[data[end : end + 1]])
        at = end + 1
    return keys, b""


_TURN_STEP_RAD = np.radians(2.0)


class StandingAgent(Agent):
    """An agent that stands, for a robot that is driven by hand without a map.

    A command by hand passes if the robot can stop before it touches a solid of the simulated world; where it touches
    one already, every command passes, so that it can leave. It needs no map, and knows what a robot's sensors may not
    see. Moving obstacles are left to the collision monitor.

    Args:
        sim: The simulator, whose world is known to it or not; without a world every command passes.
        period_s: Length of a control period [s].

    Attributes:
        status: IDLE.
        dt: Length of a control period [s].
        robot: The robot.
    """

    def __init__(self, sim: Simulator, *, period_s: float = CONTROL_PERIOD_S) -> None:
        self._sim = sim
        self._world: World | None = None
        self._checker: FootprintChecker | None = None
        self.robot = sim.robot
        self.dt = period_s
        self.status = NavigationStatus.IDLE

    def info(self) -> AgentInfo:
        """Return which robot stands."""
        return AgentInfo(type(self).__name__, robot=self.robot)

    def reset(self, *, seed: int = 0) -> None:
        """Do nothing: it keeps nothing of a run."""

    def set_goal(self, goal: Goal, /) -> None:
        """Do nothing: it drives nowhere."""

    def update(self, observation: Observation, estimate: Estimate) -> Twist2D:
        """Return the command to stand."""
        return Twist2D()

    def assist_teleop(self, command: Twist2D, observation: Observation, estimate: Estimate) -> AssistedCommand:
        """Return what of a command by hand may be sent in the next control period."""
        checker = self._check_world()
        if checker is None or checker.find(np.array([estimate.pose.as_tuple()])):
            return AssistedCommand(command)
        return assist_teleop(
            command,
            command,
            lambda slower: self._can_stop(checker, estimate.pose, observation.twist, slower),
            "a solid of the world",
        )

    def _check_world(self) -> FootprintChecker | None:
        """Return what checks the world as it is now; None where the simulator does not know it."""
        world = self._sim.world
        if world is not self._world:
            body, padded = self.robot.body, self.robot.planar.padded(FOOTPRINT_PADDING_M)
            self._world = world
            self._checker = (
                None if world is None else FootprintChecker.of(world.solids, padded, body.clearance, body.height)
            )
        return self._checker

    def _can_stop(self, checker: FootprintChecker, pose: Pose2D, twist: Twist2D, command: Twist2D) -> bool:
        poses = stopping_poses(pose, twist, command, self.robot.limits, self.dt, turn_step=_TURN_STEP_RAD)
        return not checker.find(poses[1:])


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
        """Do nothing: nothing has moved yet."""

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
        """Do nothing: the last picture stays."""


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
