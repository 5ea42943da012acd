"""How a robot that keeps pushing a wall behaves: how far and fast it is thrown back, and how far it lifts.

python benchmarks/simulation/wall_push.py [--robot NAME] [--out wall_push.md]
"""

from __future__ import annotations

import argparse
import math
import platform
import sys
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.geometry.solids import Box, Solid
from trundle.robots import Robot, robot_names
from trundle.sim.mujoco.simulator import MujocoSimulator
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
    """

    recoil: float
    back: float
    lift: float
    turn: float


def push(robot: Robot, *, gap: float, sign: float = 1.0, share: float = 1.0) -> Push:
    """Drive into a wall, keep pushing, then release.

    Args:
        robot: What pushes.
        gap: Between footprint and wall at the start [m].
        sign: 1 pushes with the front, -1 with the back.
        share: Of the top speed that is commanded.
    """
    away = float((sign * robot.outline[:, 0]).max()) + gap
    wall = Solid("wall", Box((0.2, 20.0, 1.0)), Pose3D((sign * (away + 0.1), 0.0, 0.5)))
    recoil = back = lift = turn = 0.0
    touched = False
    with MujocoSimulator(World("wall", (wall,)), robot) as simulator:
        rest = float(simulator.data.qpos[2])
        simulator.reset(Pose2D(0.0, 0.0))
        speed = share * robot.limits.linear_speed
        approach = gap / speed + speed / robot.limits.linear_acceleration + 0.5
        for step in range(round((approach + PUSH_S + RELEASE_S) / PERIOD)):
            command = Twist2D(sign * speed if step * PERIOD < approach + PUSH_S else 0.0, 0.0)
            state = simulator.step(command, PERIOD)
            touched = touched or bool(state.contacts)
            if not touched:
                continue
            recoil = max(recoil, -sign * float(simulator.data.qvel[0]))
            back = max(back, gap - sign * state.pose.x)
            lift = max(lift, float(simulator.data.qpos[2]) - rest)
            turn = max(turn, abs(state.pose.yaw))
    if not touched:
        raise RuntimeError(f"{robot.name} did not reach the wall")
    return Push(recoil, back, lift, turn)


def cases(robot: Robot) -> list[tuple[str, Push]]:
    return [
        ("front, top speed", push(robot, gap=RUN_UP)),
        ("front, from a stand 2 cm away", push(robot, gap=GAP)),
        ("front, half speed", push(robot, gap=RUN_UP, share=0.5)),
        ("back, top speed", push(robot, gap=RUN_UP, sign=-1.0)),
        ("back, from a stand 2 cm away", push(robot, gap=GAP, sign=-1.0)),
    ]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robot", action="append", help="catalogue name or YAML; may be given again")
    parser.add_argument("--out", type=Path, help="write the table here as well")
    options = parser.parse_args()
    lines = [
        "# Pushing a wall",
        "",
        f"MuJoCo {version('mujoco')}, {platform.machine()}; physics steps of 5 ms. Each robot drives into a wall "
        f"{RUN_UP:g} m or {GAP:g} m away, keeps pushing for {PUSH_S:g} s and stands still for {RELEASE_S:g} s. From "
        "its first contact on: the largest speed away from the wall, the farthest that it came away from the wall's "
        "face, and how far base_link lifted above its height at rest.",
        "",
        "| robot | push | recoil [m/s] | back [mm] | lift [mm] | turn [°] |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    for name in options.robot or robot_names():
        for label, result in cases(Robot.load(name)):
            lines.append(
                f"| {name} | {label} | {result.recoil:.3f} | {1000.0 * result.back:.2f} | {1000.0 * result.lift:.2f} "
                f"| {math.degrees(result.turn):.2f} |"
            )
    text = "\n".join(lines) + "\n"
    sys.stdout.write(text)
    if options.out:
        options.out.write_text(text)


if __name__ == "__main__":
    main()
