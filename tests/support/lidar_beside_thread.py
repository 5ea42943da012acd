"""A run with a lidar beside a thread that is busy in Python.

    python -m support.lidar_beside_thread BACKEND

writes how many scans there were, and whether they were the same as without that thread.
"""

from __future__ import annotations

import sys
import threading

import numpy as np

from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.geometry.solids import Box, Cylinder, Solid
from trundle.sim import simulate
from trundle.worlds import World

STEPS = 300
ROOM = World(
    "room",
    (
        Solid("wall", Box((0.1, 6.0, 1.0)), Pose3D((4.0, 0.0, 0.5))),
        Solid("post", Cylinder(0.2, 1.0), Pose3D((2.0, -1.0, 0.5))),
    ),
)


def ranges_of_run(backend: str) -> list[np.ndarray]:
    with simulate(ROOM, "nova_carter", backend=backend, lidar=True) as simulator:
        simulator.reset(Pose2D(0.0, 0.0), seed=0)
        states = (simulator.step(Twist2D(0.1, 0.2), 0.05) for _ in range(STEPS))
        return [scan.ranges for state in states for scan in state.scans]


def main(backend: str) -> None:
    alone = ranges_of_run(backend)
    done = threading.Event()

    def be_busy() -> None:
        kept: list[tuple[int, str]] = []
        while not done.is_set():
            kept = [(number, str(number)) for number in range(200)]
            kept.clear()

    thread = threading.Thread(target=be_busy)
    thread.start()
    try:
        beside = ranges_of_run(backend)
    finally:
        done.set()
        thread.join()
    same = len(alone) == len(beside) and all(map(np.array_equal, alone, beside))
    sys.stdout.write(f"{len(beside)} {'same' if same else 'different'}\n")


if __name__ == "__main__":
    # Threads that take turns a hundred times as often meet what is not guarded a hundred times as often.
    sys.setswitchinterval(5e-5)
    main(sys.argv[1])
