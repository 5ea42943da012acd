"""How a robot that keeps pushing a wall behaves: how far and fast it is thrown back, and how far it lifts.

python benchmarks/simulation/wall_push.py [--robot NAME] [--out wall_push.md]
"""

from __future__ import annotations

import argparse
import importlib.util
import math
import platform
import sys
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.geometry.solids import Box, Solid
from trundle.robots import Robot, robot_names
from trundle.sim import simulate
from trundle.worlds import World

PERIOD = 0.005
"""One physics step: nothing of the motion is missed between two states."""

RUN_UP, PUSH_S, RELEASE_S = 1.0, 4.0, 1.0
GAP = 0.02
"""From a standing start this far from the wall [m], beside the run-up that reaches the top speed."""


@dataclass(frozen=True, slots=True)
class Push:
    """What a robot did from its first contact with the wall on.

    Attributes:
        recoil: Largest speed away from the wall [m/s].
        back: Farthest that it came away from the wall [m].
        lift: Highest that base_link was above its height at rest [m].
        turn: Largest change of yaw [rad].
        slip: How far the wheels have turned in vain [m].
    """

    recoil: float
    back: float
    lift: float
    turn: float
    slip: float


def push(robot: Robot, backend: str, *, gap: float, sign: float = 1.0, share: float = 1.0) -> Push:
    """Drive into a wall, keep pushing, then release.

    Args:
        robot: What pushes.
        backend: In which simulator.
        gap: Between footprint and wall at the start [m].
        sign: 1 pushes with the front, -1 with the back.
        share: Of the top speed that is commanded.
    """
    away = float((sign * robot.outline[:, 0]).max()) + gap
    wall = Solid("wall", Box((0.2, 20.0, 1.0)), Pose3D((sign * (away + 0.1), 0.0, 0.5)))
    recoil = back = lift = turn = 0.0
    touched = False
    with simulate(World("wall", (wall,)), robot, backend=backend) as simulator:
        rest = height(simulator)
        simulator.reset(Pose2D(0.0, 0.0))
        speed = share * robot.limits.linear_speed
        approach = gap / speed + speed / robot.limits.linear_acceleration + 0.5
        for step in range(round((approach + PUSH_S + RELEASE_S) / PERIOD)):
            command = Twist2D(sign * speed if step * PERIOD < approach + PUSH_S else 0.0, 0.0)
            state = simulator.step(command, PERIOD)
            touched = touched or bool(state.contacts)
            if not touched:
                continue
            if {contact.other for contact in state.contacts} - {"wall"}:
                raise RuntimeError(f"{robot.name} touches {state.contacts}")
            recoil = max(recoil, -sign * state.twist.v)
            back = max(back, gap - sign * state.pose.x)
            lift = max(lift, height(simulator) - rest)
            turn = max(turn, abs(state.pose.yaw))
    if not touched:
        raise RuntimeError(f"{robot.name} did not reach the wall")
    return Push(recoil, back, lift, turn, state.odometry.distance_to(state.pose))


def height(simulator: Any) -> float:
    """Height of base_link [m]."""
    return float(simulator.data.qpos[2]) if hasattr(simulator, "data") else simulator.base_pose().position[2]


def cases(robot: Robot, backend: str) -> list[tuple[str, Push]]:
    return [
        ("front, top speed", push(robot, backend, gap=RUN_UP)),
        ("front, from a stand 2 cm away", push(robot, backend, gap=GAP)),
        ("front, half speed", push(robot, backend, gap=RUN_UP, share=0.5)),
        ("back, top speed", push(robot, backend, gap=RUN_UP, sign=-1.0)),
        ("back, from a stand 2 cm away", push(robot, backend, gap=GAP, sign=-1.0)),
    ]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robot", action="append", help="catalogue name or YAML; may be given again")
    parser.add_argument("--out", type=Path, help="write the table here as well")
    options = parser.parse_args()
    has_physx = importlib.util.find_spec("ovphysx") is not None
    physx = f", PhysX (ovphysx {version('ovphysx')})" if has_physx else ""
    lines = [
        "# Pushing a wall",
        "",
        f"MuJoCo {version('mujoco')}{physx}, {platform.machine()}; physics steps of 5 ms. Each robot drives into a "
        f"wall {RUN_UP:g} m or {GAP:g} m away, keeps pushing for {PUSH_S:g} s and stands still for {RELEASE_S:g} s. "
        "From its first contact on: the largest speed away from the wall, the farthest that it came away from the "
        "wall's face, how far base_link lifted above its height at rest, and how far the wheels turned in vain.",
        "",
        "| simulator | robot | push | recoil [m/s] | back [mm] | lift [mm] | turn [°] | slip [m] |",
        "| --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    for backend in ("mujoco", "physx") if physx else ("mujoco",):
        for name in options.robot or robot_names():
            for label, result in cases(Robot.load(name), backend):
                lines.append(
                    f"| {backend} | {name} | {label} | {result.recoil:.3f} | {1000.0 * result.back:.2f} | "
                    f"{1000.0 * result.lift:.2f} | {math.degrees(result.turn):.2f} | {result.slip:.2f} |"
                )
    text = "\n".join(lines) + "\n"
    sys.stdout.write(text)
    if options.out:
        options.out.write_text(text)


if __name__ == "__main__":
    main()
