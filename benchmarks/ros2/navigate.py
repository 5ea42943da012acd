"""`trundle ros2 navigate`, in a separate process, with robots that behave and with robots that do not.

python benchmarks/ros2/navigate.py missions [--count 100] [--speed 1] [--transport dds]
python benchmarks/ros2/navigate.py load [--seconds 60]
python benchmarks/ros2/navigate.py stops [--count 50] [--transport dds]
python benchmarks/ros2/navigate.py odd [--count 20]
python benchmarks/ros2/navigate.py lossy [--seconds 3600]

`missions` simulates Nova Carter here, with the bridge of `trundle ros2 serve`, and knows where it truly is. `load`
starts `trundle ros2 serve`. The others have a robot of tests/ros2/remote/robot.py, which behaves as badly as it is
told, in real time.
"""

from __future__ import annotations

import argparse
import contextlib
import itertools
import json
import math
import os
import random
import signal
import tempfile
import time
from collections import defaultdict, deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from hour import memory_mb
from network import ended, join, load, own_domain, percentile, started

# The network has put the folder of the tests on the path.
from ros2.remote.conftest import make_room
from ros2.remote.robot import FakeRobot, Habits
from trundle.geometry import Pose2D
from trundle.messages.codec import Codec
from trundle.messages.qos import SENSOR, Qos
from trundle.mission import End, Scenario
from trundle.mission.setup import make_place
from trundle.robots import Robot
from trundle.ros2.bridge import Bridge
from trundle.ros2.names import Names
from trundle.ros2.types import Types

ROBOT = "nova_carter"
NEAR_M = 0.3
MOST_DRIVES = 100
"""So many drives of the lossy robot are begun at most: one that cannot begin ends at once."""
PLACES = ((5.0, 3.0), (8.3, 6.4), (1.2, 4.0), (6.2, 1.0))
"""Goals in the room of the tests: no two that follow each other see each other's whole way."""


def text(pose: Any) -> str:
    """A pose as the options take it."""
    return f"{pose.x:.4f},{pose.y:.4f},{0.0 if pose.yaw is None else pose.yaw:.4f}"


# Missions ---------------------------------------------------------------------------------------------------------


class Truth:
    """An observer that keeps where the robot truly is, and ends the run when the navigator has ended."""

    def __init__(self, is_over: Callable[[], bool], end: Callable[[], None]) -> None:
        self._is_over, self._end, self._next_s = is_over, end, 0.0
        self.pose = Pose2D(0.0, 0.0)

    def on_start(self, run: object) -> None:
        pass

    def on_step(self, step: Any) -> None:
        self.pose = step.state.pose
        if step.state.time >= self._next_s:
            self._next_s = step.state.time + 0.2
            if self._is_over():
                self._end()

    def on_end(self, episode: object) -> None:
        pass


def missions(given: argparse.Namespace) -> dict[str, Any]:
    """Missions in a warehouse, each from its start to its goal: how many truly arrive, and what is touched."""
    results = [mission(given, seed) for seed in range(given.first, given.first + given.count)]
    arrived = sum(off <= NEAR_M for off, _ in results)
    touched = sum(contacts for _, contacts in results)
    print(f"{arrived} of {given.count} within {NEAR_M} m, {touched} with a contact")
    return {"off": [off for off, _ in results], "contacts": touched}


def mission(given: argparse.Namespace, seed: int) -> tuple[float, bool]:
    """One of them: how far from the goal the robot has truly come [m], and whether it has touched something."""
    own_domain()
    settings: dict[str, Any] = {"world": "warehouse", "robot": ROBOT, "backend": "kinematic", "seed": seed}
    setting = (scenario := Scenario.make(**settings)).prepare(make_place(scenario))
    start, goal = setting.start, setting.goals[0].pose
    errors = {"scale": 0.01, "heading": math.radians(1.0)}
    run = Scenario.make(**settings, start=start.as_tuple(), odometry=errors, time_limit_s=1e6)
    transport = join(given.transport, given.distro)
    types = Types(Codec(transport.distro), transport)
    bridge = Bridge(
        run,
        transport,
        types,
        Names(),
        speed=given.speed,
        observers=lambda _mission, _number: [truth],
        report=lambda _: None,
    )
    ends = ["--start", text(start), "--goal", text(goal), "--robot", ROBOT, "--seed", str(seed)]
    with bridge, started(given.transport, given.distro, "navigate", "warehouse", *ends) as (drives, _):
        until = time.monotonic() + given.limit
        truth = Truth(
            lambda: drives.poll() is not None or time.monotonic() > until,
            lambda: bridge.context.driver.steering.put(End("the navigator has ended")),
        )
        episode = bridge.run()
        said = ended(drives, 30.0)
    off = math.hypot(truth.pose.x - goal.x, truth.pose.y - goal.y)
    contacts = list(episode.metrics.contacts) if episode.metrics else []
    moved = episode.metrics.distance_m if episode.metrics else 0.0
    print(f"{seed}: {off:.3f} m from the goal after {moved:.1f} m, {said['message']}; {contacts=}", end="; ")
    print(f"stood {said['stops']}; {load()}", flush=True)
    return off, bool(contacts)


# Load -------------------------------------------------------------------------------------------------------------


def cpu_s(process: int) -> float:
    """The processor time of a process and of all that it has started [s]."""
    fields = Path(f"/proc/{process}/stat").read_text(encoding="ascii").rpartition(") ")[2].split()
    own = (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    return own + sum(cpu_s(child) for child in children(process))


def children(process: int) -> list[int]:
    """The processes that a process has started."""
    found: list[int] = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):  # it has ended meanwhile
            if int(path.read_text(encoding="utf-8").rpartition(") ")[2].split()[1]) == process:
                found.append(int(path.parent.name))
    return found


def measure_load(given: argparse.Namespace) -> dict[str, Any]:
    """Latency from a scan to its command, and the processor time, at 20 Hz with two lidars of 720 beams."""
    own_domain()
    goals = [part for x in (8, 0, -8, 0) for part in ("--goal", f"{x},0")] * 20
    place = ("warehouse", "--robot", ROBOT, "--start", "0,0,0", "--seed", "3")
    with (
        started(given.transport, given.distro, "serve", *place, "--backend", "kinematic") as (serves, _),
        started(given.transport, given.distro, "navigate", *place, *goals) as (drives, _),
    ):
        transport = join("dds", given.distro)
        codec = Codec(transport.distro)
        scan = "sensor_msgs/msg/LaserScan"
        scans = [transport.subscription(f"/{one}/scan", scan, SENSOR) for one in ("front", "back")]
        commands = transport.subscription("/cmd_vel", "geometry_msgs/msg/Twist", Qos(10))
        moving, last, late, began = False, 0.0, [], 0.0
        until = time.monotonic() + 60.0
        used = 0.0
        while time.monotonic() < until:
            time.sleep(0.0005)
            now = time.monotonic()
            if any(list(one.take()) for one in scans):
                last = now
            for sample in commands.take():
                moving = moving or codec.decode("geometry_msgs/msg/Twist", sample.data).linear.x > 0.0
                if moving and last:
                    late.append(now - last)
                    last = 0.0
            if moving and not began:
                began, used, until = now, cpu_s(drives.pid), now + given.seconds
        share = (cpu_s(drives.pid) - used) / (time.monotonic() - began) if began else math.nan
        transport.close()
        said = ended(drives, 30.0)
        ended(serves, 30.0)
    print(f"{given.transport}: {share:.1%} of a core (aim: 20 %), {len(late)} commands; stood {said['stops']}")
    half, most, largest = (percentile(late, share) * 1e3 for share in (0.5, 0.95, 1.0))
    print(f"scan to command: p50 {half:.1f} ms, p95 {most:.1f} ms (aim: 25 ms), largest {largest:.1f} ms; {load()}")
    return {"share": share, "p50_ms": half, "p95_ms": most, "largest_ms": largest, "commands": len(late)}


# Robots that behave badly -------------------------------------------------------------------------------------------


class Domain:
    """The network of a robot of the tests: that of this machine."""

    def __init__(self, distro: Any) -> None:
        self._distro = distro

    def transport(self, name: str) -> Any:
        return join("dds", self._distro)

    def most_waiting(self, sender: Any, node: str) -> int:
        """None, as far as the robot knows: it does not wait for those who read it."""
        return 0


class LossyRobot(FakeRobot):
    """Drops 5 % of what it sends, sends everything 0.1 s later, and 5 % of it twice."""

    def __init__(self, *given: Any) -> None:
        super().__init__(*given)
        self._late: deque[tuple[float, str, Any]] = deque()

    def send(self, topic: str, message: Any, qos: Qos | None = None) -> None:
        if qos is not None:  # what is sent only once
            super().send(topic, message, qos)
            return
        now = time.monotonic()
        chance = random.random()
        if chance >= 0.05:
            self._late += [(now + 0.1, topic, message)] * (2 if chance >= 0.95 else 1)
        while self._late and self._late[0][0] <= now:
            _, name, due = self._late.popleft()
            super().send(name, due)


@contextmanager
def driven(
    given: argparse.Namespace, robot: type[FakeRobot], start: Pose2D, habits: Habits, *options: str
) -> Iterator[tuple[Any, FakeRobot]]:
    """A robot in the room of the tests, and the navigator that drives it."""
    with tempfile.TemporaryDirectory() as folder:
        make_room().save(f"{folder}/room.yaml")
        theirs = robot(Domain(given.distro), Codec(given.distro), make_room(), Robot.load(ROBOT), start)  # pyright: ignore[reportArgumentType]
        theirs.habits = habits
        theirs.start()
        said = ("navigate", f"{folder}/room.yaml", "--robot", ROBOT, "--start", text(start), *options)
        try:
            with started(given.transport, given.distro, *said) as (drives, _):
                yield drives, theirs
        finally:
            theirs.close()
            theirs.transport.close()


def goals(count: int) -> list[str]:
    """The option for goals, round and round the room."""
    return [part for x, y in itertools.islice(itertools.cycle(PLACES), count) for part in ("--goal", f"{x},{y}")]


def wait_until_moving(robot: FakeRobot, drives: Any) -> bool:
    """Wait until the robot drives fast; return False where it does not."""
    until = time.monotonic() + 60.0
    while time.monotonic() < until and drives.poll() is None:
        time.sleep(0.02)
        if robot.twist.v > 0.3:
            return True
    return False


def stops(given: argparse.Namespace) -> dict[str, Any]:
    """How soon the robot is not commanded to move any more, after a silence, or after the child was killed."""
    silences = {
        "scans": {"scans": False},
        "odometry": {"odometry": False, "tf": False},
        "clock": {"clock": False},
        "robot": {"scans": False, "odometry": False, "tf": False, "clock": False},
    }
    took: dict[str, list[float]] = defaultdict(list)
    own_domain()
    with driven(given, FakeRobot, Pose2D(2.0, 2.0), Habits(), *goals(400)) as (drives, robot):
        for number, (kind, changes) in itertools.product(range(given.count), silences.items()):
            if not wait_until_moving(robot, drives):
                print(f"{kind} {number}: it does not move again: {drives.poll()}")
                break
            began = time.monotonic()
            for name, value in changes.items():
                setattr(robot.habits, name, value)
            took[kind].append(moved_s(robot, began))
            for name in changes:
                setattr(robot.habits, name, True)
        said = ended(drives, 30.0) if drives.poll() is None else {"stops": "?"}
        contacts = len(robot.contacts)
    for _ in range(given.count if given.transport == "rclpy" else 0):  # which ends the drive
        own_domain()
        with driven(given, FakeRobot, Pose2D(2.0, 2.0), Habits(), *goals(4)) as (drives, robot):
            if wait_until_moving(robot, drives):
                began = time.monotonic()
                os.kill(children(drives.pid)[0], signal.SIGKILL)
                took["child"].append(moved_s(robot, began))
            contacts += len(robot.contacts)
    for kind, values in took.items():
        print(f"{kind}: {len(values)} times, p50 {percentile(values, 0.5):.2f} s, largest {max(values):.2f} s")
    print(f"stood {said['stops']}; {contacts} contacts; {load()}")
    return {"took": took, "contacts": contacts}


def moved_s(robot: FakeRobot, began: float) -> float:
    """How long the robot is still commanded to move [s]."""
    time.sleep(1.5)
    moving = [at for at, command in list(robot.commands) if at > began and (command.v or command.w)]
    return moving[-1] - began if moving else 0.0


def odd(given: argparse.Namespace) -> dict[str, Any]:
    """Goals of a robot that waits for a pose, sends odometry only while commanded, and moves at half speed."""
    arrived, at, touched = 0, Pose2D(*PLACES[(given.first - 1) % len(PLACES)]) if given.first else Pose2D(2.0, 2.0), 0
    for number in range(given.first, given.first + given.count):
        x, y = PLACES[number % len(PLACES)]
        own_domain()
        habits = Habits(when_commanded=True, waits_for_pose=True, speed_share=0.5)
        options = ["--goal", f"{x},{y}", "--localizer", given.localizer]
        if given.localizer == "tf":
            habits.map_odom = at
        began = time.monotonic()
        with driven(given, FakeRobot, at, habits, *options) as (drives, robot):
            while drives.poll() is None and time.monotonic() - began < given.limit:
                time.sleep(0.1)
            said = ended(drives, 30.0)
            at, contacts = robot.pose, robot.contacts
        off = math.hypot(at.x - x, at.y - y)
        arrived += off <= NEAR_M and not contacts
        touched += bool(contacts)
        print(f"{number}: {off:.2f} m off after {time.monotonic() - began:.0f} s, {said['message']}; ", end="")
        print(f"{len(contacts)} contacts; stood {said['stops']}; {load()}", flush=True)
    print(f"{arrived} of {given.count} arrived")
    return {"arrived": arrived, "contacts": touched}


def lossy(given: argparse.Namespace) -> dict[str, Any]:
    """A robot that loses, delays and repeats messages, for a long time: contacts, memory, how far it comes.

    A drive that ends early, as one does where the machine is so busy that all falls silent for long, is counted, and
    the next one sets off from where the robot stands, until they have taken the time.
    """
    seconds, moved, contacts, reached = 0.0, 0.0, 0, 0
    at, drives = Pose2D(2.0, 2.0), list[dict[str, Any]]()
    while (left := given.seconds - seconds) > 0.0 and len(drives) < MOST_DRIVES:
        number = len(drives)
        at, drive = lossy_drive(given, at, left, number % len(PLACES))
        seconds, moved, contacts = seconds + drive["seconds"], moved + drive["moved"], contacts + drive["contacts"]
        reached += drive["reached"]
        drives.append(drive)
        print(
            f"drive {number + 1} ended after {drive['seconds']:.0f} s and {drive['moved']:.0f} m: {drive['message']}; ",
            end="",
        )
        print(f"stood {drive['stops']}; {drive['warnings']}", flush=True)
    early = len(drives) - 1
    print(f"{seconds:.0f} s, {moved:.0f} m, {reached} goals, {contacts} contacts; {early} drives ended early")
    for number, drive in enumerate(drives, 1):
        if memory := drive["memory"]:
            print(f"memory of drive {number}: {memory[0]:.1f} MB after 30 s, {max(memory):.1f} at most, ", end="")
            print(f"{memory[-1]:.1f} at the end")
    return {
        "moved": moved,
        "reached": reached,
        "contacts": contacts,
        "early": early,
        "drives": drives,
        "seconds": seconds,
    }


def lossy_drive(given: argparse.Namespace, start: Pose2D, seconds: float, first: int) -> tuple[Pose2D, dict[str, Any]]:
    """One drive of the lossy robot, of so long at most: where it ends, and what came of it."""
    own_domain()
    ends, reached = goals(1000)[2 * first :], 0
    with driven(given, LossyRobot, start, Habits(), *ends) as (drives, robot):
        began, moved, before = time.monotonic(), 0.0, robot.pose
        memory: list[float] = []
        while drives.poll() is None and time.monotonic() - began < seconds:
            time.sleep(0.1)
            moved += math.hypot(robot.pose.x - before.x, robot.pose.y - before.y)
            before = robot.pose
            x, y = PLACES[(first + reached) % len(PLACES)]
            reached += math.hypot(before.x - x, before.y - y) <= NEAR_M
            if time.monotonic() - began > 30.0 * (len(memory) + 1):
                memory.append(memory_mb(drives.pid))
                print(f"{time.monotonic() - began:.0f} s: {memory[-1]:.1f} MB, {moved:.0f} m, ", end="")
                print(f"{reached} goals, {len(robot.contacts)} contacts; {load()}", flush=True)
        took = time.monotonic() - began
        said = ended(drives, 30.0)
        at, contacts = robot.pose, len(robot.contacts)
    kept = {key: said[key] for key in ("message", "stops", "warnings")}
    return at, {"moved": moved, "contacts": contacts, "memory": memory, "seconds": took, "reached": reached, **kept}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    what = {"missions": missions, "load": measure_load, "stops": stops, "odd": odd, "lossy": lossy}
    parser.add_argument("what", choices=what)
    parser.add_argument("--count", type=int, default=10, help="missions, kills of each kind, or goals")
    parser.add_argument("--first", type=int, default=0, help="seed of the first mission, or number of the first goal")
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--speed", type=float, default=1.0, help="of the simulated missions")
    parser.add_argument("--limit", type=float, default=180.0, help="of a mission or goal, real time [s]")
    parser.add_argument("--localizer", default="tf", help="of the odd robot")
    parser.add_argument("--distro", default="jazzy")
    parser.add_argument("--transport", default="dds", choices=["dds", "rclpy"])
    parser.add_argument("--json", action="store_true", help="print the figures as JSON at the end")
    given = parser.parse_args()
    figures = what[given.what](given)
    if given.json:
        print(json.dumps(figures))


if __name__ == "__main__":
    main()
