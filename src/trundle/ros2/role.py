"""`Role`: what the bridge is for; and `BridgeContext`: the time, the run and the network that a role plugs into."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Literal, Protocol, TypeAlias

from trundle.geometry import Pose2D
from trundle.messages import MessageMaker
from trundle.mission import Episode, LiveRun, LiveStatus, Mission, Observer, Session, Steering
from trundle.mission.setup import SessionOptions
from trundle.navigation import Agent
from trundle.observation import Observation
from trundle.ros2.profile import Profile
from trundle.ros2.static_frames import StaticFramesMode
from trundle.ros2.wire import Wire

RoleName: TypeAlias = Literal["simulator", "navigator"]
"""Whether other programs drive the robot, or trundle does."""

_KEPT_S = 60.0
"""What the episode at the end has of the run [s]: it may take days."""

JUMP_S = 1.0
"""After a restart the clock goes on at the next full multiple of this [s], so that the time never goes back."""


class SimulationClock:
    """Time [s] on the network: that of the run, plus that of the runs before.

    The thread that drives the run sets it; any thread reads it.

    Attributes:
        now: The time now [s].
        offset: What is added to the time of the present run [s].
    """

    def __init__(self) -> None:
        self.now = 0.0
        self.offset = 0.0
        self._begun = False
        self._from_zero = False

    def begin(self) -> None:
        """Begin a run: the first one at 0; the next ones at the next full `JUMP_S`, or at 0 after `start_over`."""
        if self._from_zero or not self._begun:
            self.offset = 0.0
        else:
            self.offset = (self.now // JUMP_S + 1.0) * JUMP_S
        self._begun, self._from_zero = True, False
        self.now = self.offset

    def start_over(self) -> None:
        """Let the next run begin at 0, for a client that resets the time."""
        self._from_zero = True

    def set(self, time: float) -> float:
        """Set the time [s] since the start of the run, and return the time on the network."""
        self.now = now = self.offset + time
        return now


class PeriodCounter:
    """Counts control periods over all runs; the thread that drives adds, the listening thread waits.

    Attributes:
        count: How many were driven.
        runs: How many runs have begun.
    """

    def __init__(self) -> None:
        self.count = 0
        self.runs = 0
        self._awaited: tuple[int, Callable[[], None]] | None = None

    def add(self) -> None:
        """Count a control period that was driven."""
        self.count += 1
        awaited = self._awaited
        if awaited is not None and self.count >= awaited[0]:
            self._awaited = None
            awaited[1]()

    def expect(self, count: int, call: Callable[[], None]) -> None:
        """Call this, in the thread that drives, once so many were driven in all; it replaces what was expected."""
        self._awaited = count, call


class Driver(Protocol):
    """Drives sessions one after another and steers them; a page's does, and so does `LiveDriver`."""

    @property
    def steering(self) -> Steering:
        """Where the session of each run takes its directives from."""
        ...

    @property
    def status(self) -> LiveStatus:
        """What runs now."""
        ...

    def drive(self, make_session: Callable[[int | None], Session]) -> Episode:
        """Drive to the end, and again after each restart; see `LiveRun`."""
        ...


class LiveDriver:
    """Drives sessions at a speed relative to real time, and again after restarts.

    Args:
        speed: How fast the first run passes, 0.1 to 50, or infinity for as fast as it can.

    Attributes:
        steering: Where the session of each run takes its directives from.
    """

    def __init__(self, *, speed: float = 1.0) -> None:
        self.steering = Steering()
        self._speed = speed
        self._live: LiveRun | None = None

    @property
    def status(self) -> LiveStatus:
        """What runs now."""
        return LiveStatus("idle", speed=self._speed) if self._live is None else self._live.status

    def drive(self, make_session: Callable[[int | None], Session]) -> Episode:
        """Drive to the end, and again after each restart; see `LiveRun`."""
        self._live = LiveRun(make_session, self.steering, speed=self._speed)
        return self._live.run()


@dataclass(slots=True)
class BridgeContext:
    """What a role plugs into.

    Attributes:
        wire: Topics, services and actions.
        profile: Their names, and those of frames.
        clock: The time on the network.
        mission: World, robot, map, navigator and simulator.
        driver: Drives and steers.
        static_frames: When fixed frames and those of the wheels are published.
        origin: Where the odometry of the simulator began in this run: the frame `odom` on the network begins there.
        periods: Counts control periods and runs.
        session: The present run, or None before the first one.
        maker: Makes messages of trundle's values.
    """

    wire: Wire
    profile: Profile
    clock: SimulationClock
    mission: Mission
    driver: Driver
    static_frames: StaticFramesMode = "auto"
    origin: Pose2D = field(default_factory=lambda: Pose2D(0.0, 0.0))
    periods: PeriodCounter = field(default_factory=PeriodCounter)
    session: Session | None = None
    maker: MessageMaker = field(init=False)

    def __post_init__(self) -> None:
        self.maker = MessageMaker(self.wire.types.codec)

    def odometry(self, observation: Observation) -> Pose2D:
        """Return the pose of the base in the frame `odom` on the network, which begins at (0, 0, 0) in every run."""
        return self.origin.inverse() @ observation.odometry

    def begin_session(
        self, agent: Agent, observers: Sequence[Observer], seed: int | None, options: SessionOptions
    ) -> Session:
        """Begin a run on the mission's simulator that has no goal and goes on after a contact, steered by the driver.

        Args:
            agent: What drives the robot.
            observers: What follows the run.
            seed: Seed of the run. If None, it is the scenario's.
            options: What stands between the simulator and the agent.
        """
        scenario = self.mission.scenario
        return Session(
            self.mission.sim,
            agent,
            self.mission.start,
            None,
            time_limit_s=scenario.time_limit_s,
            observers=observers,
            seed=scenario.seed if seed is None else seed,
            stop_on_contact=False,
            name=scenario.title,
            measure=None,
            keeps_s=_KEPT_S,
            steering=self.driver.steering,
            **options,
        )


class Role(Protocol):
    """What the bridge does besides publishing the robot."""

    def open(self) -> None:
        """Open topics, services and actions; once, before the first run."""
        ...

    def begin(self, observers: Sequence[Observer], seed: int | None) -> Session:
        """Begin a run on the mission's simulator, with these observers, which publish the robot.

        Args:
            observers: What else follows the run.
            seed: Seed of the run. If None, it is the scenario's.
        """
        ...

    def lost(self, why: str) -> None:
        """Take note, in the listening thread, that the other side is lost for this reason, or back ("")."""
        ...

    def close(self) -> None:
        """End what the role has begun: the bridge ends."""
        ...
