"""The bridge for a long time at a higher speed: its memory, and how late its ticks are.

python benchmarks/ros2/hour.py [--speed 5] [--minutes 60] [--transport dds] [--profile turtlebot3] [--alone]

A real rclpy reads everything, unless --alone. A tick is a control period; it is late by how much later it ends than the
pace of the run wants. A run that is late by more than a quarter of a second goes on from where it is, as in `Pace`.
"""

from __future__ import annotations

import argparse
import time
from contextlib import ExitStack
from pathlib import Path

from network import join, load, own_domain, peer

from trundle.messages.codec import Codec
from trundle.mission import Scenario
from trundle.ros2.bridge import Bridge
from trundle.ros2.names import Names
from trundle.ros2.profile import Profile
from trundle.ros2.types import Types

LATE_S = 0.05
MOST_LAG_S = 0.25
"""As `Pace` has it."""


def memory_mb(process: int | str = "self") -> float:
    """Resident memory of a process, by its number or of this one [MB]."""
    lines = Path(f"/proc/{process}/status").read_text(encoding="ascii").splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith("VmRSS")) / 1024.0


class Watch:
    """An observer that counts late ticks, and looks at the memory once a minute."""

    def __init__(self, speed: float) -> None:
        self._speed = speed
        self._anchor: tuple[float, float] | None = None
        self._minute = 0.0
        self.ticks = self.late = 0
        self.worst = 0.0
        self.memory: list[float] = []

    def on_start(self, run: object) -> None:
        self._minute = time.monotonic()

    def on_step(self, step) -> None:
        now, at = time.monotonic(), step.state.time
        if self._anchor is None:
            self._anchor = now, at
        lag = now - self._anchor[0] - (at - self._anchor[1]) / self._speed
        self.ticks += 1
        self.late += lag > LATE_S
        self.worst = max(self.worst, lag)
        if lag > MOST_LAG_S:
            self._anchor = now, at
        if now - self._minute > 60.0 or not self.memory:
            self._minute = now
            self.memory.append(memory_mb())
            share = self.late / self.ticks
            print(f"{at:.0f} s: {self.memory[-1]:.1f} MB, {share:.3%} of the ticks late; {load()}", flush=True)

    def on_end(self, episode: object) -> None:
        self.memory.append(memory_mb())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--speed", type=float, default=5.0)
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--distro", default="jazzy")
    parser.add_argument("--transport", default="dds")
    parser.add_argument("--profile", default="turtlebot3")
    parser.add_argument("--alone", action="store_true")
    given = parser.parse_args()
    own_domain()
    profile = Profile.load(given.profile)
    watch = Watch(given.speed)
    with ExitStack() as opened:
        transport = join(given.transport, given.distro)
        bridge = Bridge(
            Scenario.make(
                world="warehouse",
                seed=4,
                robot=profile.robot or "nova_carter",
                time_limit_s=given.minutes * 60.0 * given.speed,
            ),
            transport,
            Types(Codec(transport.distro), transport),
            Names(),
            profile=profile,
            speed=given.speed,
            observers=lambda _mission, _number: [watch],
        )
        opened.enter_context(bridge)
        if not given.alone:
            reader = opened.enter_context(peer(given.distro, "everything", given.minutes * 60.0 + 60.0))
            reader.read()
        bridge.run()
    share = watch.late / max(watch.ticks, 1)
    print(f"{watch.ticks} ticks, {share:.3%} over {LATE_S * 1e3:.0f} ms late (aim: 0.1 %), worst {watch.worst:.3f} s")
    first, *_, last = watch.memory
    print(f"memory: {first:.1f} MB at the start, {max(watch.memory):.1f} at most, {last:.1f} at the end")


if __name__ == "__main__":
    main()
