"""How much of its speed a run keeps that publishes everything: MuJoCo, as fast as it can, the same physics steps.

python benchmarks/ros2/speed.py [--transport dds] [--profile carter_navigation] [--seconds 20] [--rounds 5]

Three runs in turns: one that publishes nothing, one that nobody reads, and one that an rclpy node reads in full.
"""

from __future__ import annotations

import argparse
import statistics
import time
from contextlib import ExitStack

from network import join, load, own_domain, peer

from trundle.messages.codec import Codec
from trundle.mission import LiveRun, Scenario, Session, Steering
from trundle.navigation import CommandScript
from trundle.robots import Robot
from trundle.ros2.bridge import Bridge, build_mission
from trundle.ros2.names import Names
from trundle.ros2.profile import Profile
from trundle.ros2.types import Types

BEGIN_S = 2.0
"""What comes before is not measured: types are serialised for the first time."""


class Timed:
    """An observer that measures how fast simulated time passes between two moments of it."""

    def __init__(self, end_s: float) -> None:
        self._end_s = end_s
        self._began = self._ended = (0.0, 0.0, 0.0)

    def on_start(self, run: object) -> None:
        pass

    def on_step(self, step) -> None:
        now = time.perf_counter(), step.state.time, time.process_time()
        if step.state.time <= BEGIN_S:
            self._began = now
        if step.state.time <= self._end_s:
            self._ended = now

    def on_end(self, episode: object) -> None:
        pass

    @property
    def factors(self) -> tuple[float, float]:
        """Simulated seconds for each second of real time, and for each second of this process's CPU time."""
        wall, simulated, cpu = (end - begin for begin, end in zip(self._began, self._ended, strict=True))
        return simulated / wall, simulated / cpu


def scenario(given: argparse.Namespace, profile: Profile) -> Scenario:
    robot = Robot.load(profile.robot or "nova_carter")
    return Scenario.make(world="warehouse", seed=4, robot=robot.name, time_limit_s=BEGIN_S + given.seconds)


def unpublished(given: argparse.Namespace, profile: Profile) -> tuple[float, float]:
    timed = Timed(BEGIN_S + given.seconds)
    with build_mission(scenario(given, profile), profile) as mission:
        limit = BEGIN_S + given.seconds
        agent = CommandScript([(0.0, 0.0, limit)], period_s=profile.control_period_s)
        steering = Steering()

        def make(_: int | None) -> Session:
            return Session(
                mission.sim, agent, mission.start, monitor=False, measure=None, observers=[timed], steering=steering
            )

        LiveRun(make, steering, speed=float("inf")).run()
    return timed.factors


def published(given: argparse.Namespace, profile: Profile, *, is_read: bool) -> tuple[float, float]:
    timed = Timed(BEGIN_S + given.seconds)
    with ExitStack() as opened:
        transport = join(given.transport, given.distro)
        types = Types(Codec(transport.distro), transport)
        bridge = Bridge(
            scenario(given, profile),
            transport,
            types,
            Names(),
            profile=profile,
            speed=float("inf"),
            observers=lambda _mission, _number: [timed],
        )
        opened.enter_context(bridge)
        if is_read:
            reader = opened.enter_context(peer(given.distro, "everything", 600))
            reader.read()
            end = time.monotonic() + 20.0
            while any(not outlet.readers for outlet in bridge.wire.outlets) and time.monotonic() < end:
                time.sleep(0.1)
        bridge.run()
    return timed.factors


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--distro", default="jazzy")
    parser.add_argument("--transport", default="dds")
    parser.add_argument("--profile", default="carter_navigation")
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--rounds", type=int, default=5)
    given = parser.parse_args()
    profile = Profile.load(given.profile)
    own_domain()
    ratios: dict[str, list[tuple[float, float]]] = {"nobody reads": [], "one reads everything": []}
    for _ in range(given.rounds):
        base = unpublished(given, profile)
        found = published(given, profile, is_read=False), published(given, profile, is_read=True)
        for name, factors in zip(ratios, found, strict=True):
            ratios[name].append((factors[0] / base[0], factors[1] / base[1]))
        shown = ", ".join(f"{wall:.1f} x ({cpu:.1f} x CPU time)" for wall, cpu in (base, *found))
        print(f"unpublished, alone, read: {shown}; {load()}", flush=True)
    for (name, pairs), aim in zip(ratios.items(), (0.7, 0.45), strict=True):
        wall, cpu = (statistics.median(values) for values in zip(*pairs, strict=True))
        print(f"{given.transport}, {given.profile}, {name}: {wall:.2f} of unpublished (aim: {aim}), CPU time {cpu:.2f}")


if __name__ == "__main__":
    main()
