"""How far a simulator's robot ends from where its commands lead: exact integration of the twist after its limits.

MuJoCo always, PhysX where ovphysx is installed.

python benchmarks/simulation/accuracy.py [--robot NAME] [--out accuracy.md]
"""

from __future__ import annotations

import argparse
import math
import platform
import sys
from importlib.metadata import version
from pathlib import Path

import numpy as np

from trundle.errors import TrundleError
from trundle.geometry import FloatArray, Pose2D, Twist2D, wrap_angle
from trundle.robots import Robot
from trundle.sim import Simulator, simulate
from trundle.sim.kinematic import KinematicSimulator
from trundle.sim.mujoco.robot_parts import Servo
from trundle.sim.mujoco.simulator import MujocoSimulator
from trundle.sim.physx.engine import check_installation
from trundle.worlds import World

EMPTY = World("empty", ())
PERIOD, DURATION = 0.05, 5.0
COMMANDS = ((0.4, 0.0), (0.0, 0.8), (0.25, -0.5))
RANDOM_TWISTS, RANDOM_SEED = 30, 20_240_601
"""Nothing was tuned on these twists."""


def end_of(simulator: Simulator, command: Twist2D) -> tuple[Pose2D, float]:
    """Drive from rest; return the last pose and the whole turn [rad]."""
    last, turn = simulator.reset(Pose2D(0.0, 0.0)).pose, 0.0
    for _ in range(round(DURATION / PERIOD)):
        pose = simulator.step(command, PERIOD).pose
        turn += wrap_angle(pose.yaw - last.yaw)
        last = pose
    return last, turn


def errors(engine: Simulator, exact: Simulator, command: Twist2D) -> tuple[float, float]:
    """Distance [mm] and turn [°] by which the engine's robot ends elsewhere."""
    (got, turned), (expected, turn) = end_of(engine, command), end_of(exact, command)
    return 1000.0 * got.distance_to(expected), math.degrees(turned - turn)


def has_physx() -> bool:
    try:
        check_installation()
    except TrundleError:
        return False
    return True


def report_physx(robot: Robot, twists: FloatArray) -> list[str]:
    lines = [
        "",
        f"PhysX (ovphysx {version('ovphysx')}), from trailing casters; turn and distance are those of the commands "
        "along one axis, drift is to the side:",
        "",
        "| command (v [m/s], w [rad/s]) | position [mm] | yaw [°] | turn [%] | distance [%] | drift [mm] |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    with KinematicSimulator(EMPTY, robot) as exact, simulate(EMPTY, robot, backend="physx") as engine:
        for v, w in COMMANDS:
            (got, turned), (expected, turn) = (end_of(each, Twist2D(v, w)) for each in (engine, exact))
            if w == 0.0:
                shares = f"| – | {100.0 * (got.x / expected.x - 1.0):+.2f} | {1000.0 * got.y:+.2f} |"
            else:
                shares = f"| {100.0 * (turned / turn - 1.0):+.2f} | – | – |"
            distance, by = 1000.0 * got.distance_to(expected), math.degrees(turned - turn)
            lines.append(f"| ({v:g}, {w:g}) | {distance:.2f} | {by:+.3f} {shares}")
        found = np.abs([errors(engine, exact, Twist2D(v, w)) for v, w in twists])
    return [*lines, "", f"The same {RANDOM_TWISTS} random twists:", "", *table_of(found)]


def table_of(found: FloatArray) -> list[str]:
    lines = ["| | median | p90 | maximum |", "| --- | --- | --- | --- |"]
    for label, values in (("position [mm]", found[:, 0]), ("yaw [°]", found[:, 1])):
        middle, high, most = np.median(values), np.percentile(values, 90), values.max()
        lines.append(f"| {label} | {middle:.2f} | {high:.2f} | {most:.2f} |")
    return lines


def report(robot: Robot) -> list[str]:
    servo = Servo.of(robot)
    lines = [
        f"## {robot.name}",
        "",
        f"MuJoCo {version('mujoco')}, {platform.machine()}. {DURATION:g} s from rest, {PERIOD:g} s control periods, "
        f"5 ms physics steps; limits {robot.limits.linear_speed:g} m/s, {robot.limits.angular_speed:g} rad/s, "
        f"{robot.limits.linear_acceleration:g} m/s², {robot.limits.angular_acceleration:g} rad/s². Wheel servos "
        f"{servo.gain:.3g} N·m·s/rad with acceleration feed-forward, at most {servo.torque:.3g} N·m, motor inertia "
        f"{servo.armature:.3g} kg·m²; {robot.total_mass:.4g} kg.",
        "",
        "| command (v [m/s], w [rad/s]) | casters | position [mm] | yaw [°] |",
        "| --- | --- | --- | --- |",
    ]
    with KinematicSimulator(EMPTY, robot) as exact:
        swivel = any(caster.is_swivel for caster in robot.casters)
        for casters in ("trailing", "reversed") if swivel else ("trailing",):
            with MujocoSimulator(EMPTY, robot, casters=casters) as engine:
                for v, w in COMMANDS:
                    distance, turn = errors(engine, exact, Twist2D(v, w))
                    lines.append(
                        f"| ({v:g}, {w:g}) | {casters if swivel else 'balls'} | {distance:.2f} | {turn:+.3f} |"
                    )
        rng = np.random.default_rng(RANDOM_SEED)
        limits = np.array([robot.limits.linear_speed, robot.limits.angular_speed])
        twists = rng.uniform(-limits, limits, (RANDOM_TWISTS, 2))
        with MujocoSimulator(EMPTY, robot) as engine:
            found = np.abs([errors(engine, exact, Twist2D(v, w)) for v, w in twists])
        lines += [
            "",
            f"{RANDOM_TWISTS} random twists, uniform within ± the limits (seed {RANDOM_SEED}), from trailing casters:",
            "",
            *table_of(found),
        ]
        if swivel:
            ahead = found[twists[:, 0] >= 0.0].max(axis=0)
            back = found[twists[:, 0] < 0.0].max(axis=0)
            lines += [
                "",
                f"Driving forward at most {ahead[0]:.2f} mm and {ahead[1]:.2f}°; backward, where the casters swing "
                f"round first, {back[0]:.2f} mm and {back[1]:.2f}°.",
            ]
    return lines + (report_physx(robot, twists) if has_physx() else [])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robot", action="append", help="catalogue name or YAML; may be given again")
    parser.add_argument("--out", type=Path, help="write the tables here as well")
    options = parser.parse_args()
    names = options.robot or ["nova_carter", "turtlebot3_burger", "turtlebot3_waffle", "jackal"]
    text = "# Accuracy of the simulators\n\n" + "\n".join("\n".join(report(Robot.load(name))) + "\n" for name in names)
    sys.stdout.write(text)
    if options.out:
        options.out.write_text(text)


if __name__ == "__main__":
    main()
