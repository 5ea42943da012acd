"""`trundle drive --browser`: a drive by hand in the page, or commands that are watched in it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

from trundle.cli.shared import browser

if TYPE_CHECKING:
    from trundle.geometry import Pose2D
    from trundle.mission import Episode, Observer, RunInfo, Session, Step
    from trundle.navigation import Agent, CommandScript
    from trundle.record.drive_log import DriveLog
    from trundle.sim import Simulator
    from trundle.worlds import World

Command: TypeAlias = tuple[float, float, float]

_CELL_M = 0.05
_ROOM_M = 15.0
"""How far the map of an empty floor reaches from the start."""


class _Logger:
    """Writes a drive into its log; the legs are the commands of a script, or one for a drive by hand."""

    def __init__(self, log: DriveLog, script: CommandScript | None, commands: Sequence[Command]) -> None:
        self._log, self._script, self._commands = log, script, commands
        self._leg = -1

    def on_start(self, run: RunInfo) -> None:
        """Begin the leg of a drive by hand."""
        if self._script is None:
            self._log.begin(0.0, 0.0, 0.0)

    def on_step(self, step: Step) -> None:
        """Add the state."""
        script = self._script
        if script is not None and step.index and script.index != self._leg:
            self._leg = script.index
            self._log.begin(*self._commands[self._leg])
        self._log.add(step.state, step.sent)

    def on_end(self, episode: Episode) -> None:
        """Do nothing: the command saves the log."""


def drive_in_browser(
    simulator: Simulator,
    start: Pose2D,
    commands: Sequence[Command] | None,
    log: DriveLog,
    *,
    observers: Sequence[Observer],
    period_s: float,
    speed: float,
    seed: int,
    quiet: bool,
) -> None:
    """Drive in the page: by hand, or by clicking goals; or watch commands.

    By hand the robot knows the map of the world, so that its navigator stops it before walls.

    Args:
        simulator: Moves the robot.
        start: Where it starts.
        commands: (v [m/s], w [rad/s], seconds) of each; None for a drive by hand, which ends in the page or by Ctrl-C.
        log: Gets every state.
        observers: Of the drive, such as a recording.
        period_s: Length of a control period of the commands [s].
        speed: Simulated seconds per second.
        seed: Of the simulator.
        quiet: Without remarks.
    """
    from trundle.mission import Session
    from trundle.navigation import CommandScript
    from trundle.serve.steerer import Steerer
    from trundle.serve.watch import Watch

    script = None if commands is None else CommandScript(commands, period_s=period_s)
    agent = _navigator(simulator, start) if script is None else script
    options: dict[str, Any] = {} if script is None else {"monitor": False}
    steerer = Steerer(speed=speed, restarts=False)

    def make(_seed: int | None) -> Session:
        watch = Watch(page.hub, 1, None, world=lambda: simulator.world, steering=steerer.steering)
        return Session(
            simulator,
            agent,
            start,
            seed=seed,
            stop_on_contact=False,
            measure=None,
            observers=[_Logger(log, script, commands or ()), *observers, watch, watch.recorded],
            steering=steerer.steering,
            **options,
        )

    with browser.serving(None) as page:
        page.hub.controls = steerer
        browser.announce(page, quiet=quiet)
        steerer.drive(make)
        error = None if steerer.session is None else steerer.session.error
        if error is not None and not isinstance(error, KeyboardInterrupt):
            raise error
        browser.linger(page, browser.wait_until, quiet=quiet)


def _navigator(simulator: Simulator, start: Pose2D) -> Agent:
    """A navigator without a goal, on the map of the simulated world."""
    import numpy as np

    from trundle.geometry import Pose2D
    from trundle.maps import OccupancyGrid
    from trundle.navigation import Navigator
    from trundle.worlds import World

    world: World = simulator.world or World(name="empty", solids=())
    low, high = world.bounds if world.solids else ((start.x, start.y, 0.0), (start.x, start.y, 0.0))
    bounds = (
        (min(low[0], start.x - _ROOM_M), min(low[1], start.y - _ROOM_M)),
        (max(high[0], start.x + _ROOM_M), max(high[1], start.y + _ROOM_M)),
    )
    robot = simulator.robot
    if not world.solids:
        cells = np.zeros((int(2.0 * _ROOM_M / _CELL_M), int(2.0 * _ROOM_M / _CELL_M)), dtype=np.int8)
        return Navigator(OccupancyGrid(cells, _CELL_M, Pose2D(start.x - _ROOM_M, start.y - _ROOM_M)), robot)
    grid = OccupancyGrid.from_world(
        world, resolution=_CELL_M, z_range=robot.z_range, bounds=bounds, seeds=[(start.x, start.y)]
    )
    return Navigator(grid, robot)
