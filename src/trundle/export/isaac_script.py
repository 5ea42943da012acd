"""A scenario as one Python file for Isaac Sim, without dependencies: the planned path and a follower for it."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Sequence
from importlib import metadata, resources
from pathlib import Path
from string import Template
from typing import TypeAlias

import numpy as np

from trundle.control.sections import Section, cut_sections, path_vertices
from trundle.errors import InputError
from trundle.export.plain import Scene
from trundle.export.usd import export_robot, export_world
from trundle.files.writing import write_text
from trundle.maps.masks import SpeedMask
from trundle.navigation.command_check import BESIDE_M, fastest_s, limits_along
from trundle.path import Path as Plan
from trundle.sim.isaac.assets import ROBOTS, environment_path, robot_path
from trundle.usd import GROUND_OFFSET, TIMESTEP

Stretch: TypeAlias = tuple[float, float, list[tuple[float, float]]]
"""Turn in place by [rad], to a heading [rad], then drive along corners [m]; perhaps none."""

Zone: TypeAlias = tuple[float, float, float]
"""From a distance along a stretch to another [m, m], no faster than this [m/s]."""

_STOP_TO_TURN = 0.35
"""At bends sharper than this [rad] the follower stops and turns: it has no footprint check for curves."""

_LOOKAHEAD = 0.4  # [m]; a smaller one follows the path more closely, but oscillates at speed.
_STEPS = 4  # physics steps for each command
_POINTS_A_LINE = 6
_ZONES_A_LINE = 4
_ZONE_STEP_M = 0.025  # half of the usual cell of a map, so that no cell of a mask is skipped


def export_scene(scene: Scene, path: Path, *, environment: str | None = None, robot_usd: str | None = None) -> None:
    """Write a script that loads the environment and the robot, follows the plan and stops at the goal.

    It runs in Isaac Sim 5.1 and 6.x, and obeys the speed limits of the scene's mask. A world that is not a USD file is
    written beside it, `<stem>_world.usd`, and so is a robot that Isaac Sim does not have, `<stem>_robot.usd`.

    Args:
        scene: The scene; it needs a path.
        path: The script.
        environment: One of Isaac Sim's by name, or a USD file; by default the scene's world.
        robot_usd: The robot's USD file; by default Isaac Sim's own, if it has one.

    Raises:
        InputError: If there is no path, or a file is missing.
        UnknownNameError: If there is no such environment.
        OutputError: If a file cannot be written.
        MissingExtraError: If a USD file is to be written and usd-core is not installed.
    """
    if not scene.paths:
        raise InputError(
            f"{path}: a script needs a planned path; the scenario has none. Give a goal that can be reached"
        )
    text = _fill(scene, path, _environment(scene, path, environment), _robot(scene, path, robot_usd))
    write_text(path, text)


def _environment(scene: Scene, path: Path, environment: str | None) -> str:
    if environment is not None:
        return environment_path(environment) or _from_here(environment, path)
    file = path.with_name(f"{path.stem}_world.usd")
    export_world(scene.world, file, profile="isaac")
    return file.name


def _robot(scene: Scene, path: Path, robot_usd: str | None) -> str:
    if robot_usd is not None or scene.robot.name in ROBOTS:
        return robot_path(scene.robot.name, robot_usd) or _from_here(str(robot_usd), path)
    file = path.with_name(f"{path.stem}_robot.usd")
    export_robot(scene.robot, file, profile="isaac")
    return file.name


def _from_here(usd: str, path: Path) -> str:
    """Return the path of a USD file in the script: relative if it lies below the script's folder, else absolute."""
    if "://" in usd:
        return usd
    file, folder = Path(usd).resolve(), path.resolve().parent
    return Path(os.path.relpath(file, folder)).as_posix() if file.is_relative_to(folder) else file.as_posix()


def _fill(scene: Scene, path: Path, environment: str, robot_usd: str) -> str:
    robot, start, goal = scene.robot, scene.start, scene.paths[-1].goal
    drive, limits = robot.drive, robot.limits
    if drive.axles:
        raise InputError(f"the robot {robot.name!r} has several wheels on each side, but the script supports one")
    fastest = (2.0 * limits.linear_speed + limits.angular_speed * drive.track_width) / (2.0 * drive.wheel_radius)
    length = sum(plan.length for plan in scene.paths)
    route = [stretch for plan in scene.paths for stretch in plan_stretches(plan)]
    turned = sum(abs(turn) for turn, _, _ in route)
    needed = sum(fastest_s(plan, robot, scene.speed_mask) for plan in scene.paths) + turned / limits.angular_speed
    template = resources.files("trundle.export") / "isaac_script.template"
    return Template(template.read_text(encoding="utf-8")).substitute(
        title=_plain(
            f"{robot.name} in {scene.world.name} from ({start.x:.2f}, {start.y:.2f}) to ({goal.x:.2f}, {goal.y:.2f}), "
            f"{length:.1f} m."
        ),
        version=metadata.version("trundle"),
        file=_plain(path.name),
        environment=_text(environment),
        robot=_text(robot_usd),
        wheel_joints=f"[{_text(drive.left_joint)}, {_text(drive.right_joint)}]",
        wheel_radius=drive.wheel_radius,
        track_width=drive.track_width,
        max_wheel_speed=round(drive.max_wheel_speed or fastest, 3),
        max_speed=limits.linear_speed,
        max_turn=limits.angular_speed,
        acceleration=limits.linear_acceleration,
        turn_acceleration=limits.angular_acceleration,
        start=f"({start.x:.4f}, {start.y:.4f}, {start.yaw:.4f})",
        ground_offset=GROUND_OFFSET,
        lookahead=_LOOKAHEAD,
        physics_dt=TIMESTEP,
        steps=_STEPS,
        time_limit=math.ceil(3.0 * needed + 30.0),
        route="\n".join(_route_lines(route)),
        limits=_limits_text(route, scene.speed_mask, limits.linear_speed),
    )


def plan_stretches(plan: Plan) -> Iterator[Stretch]:
    """Split a path into stretches driven without stopping, each with the turn in place before it.

    Raises:
        InputError: If a part of the path is driven backwards, which the script cannot do.
    """
    if plan.backward.any():
        raise InputError(
            f"the path of planner {plan.planner!r} is driven backwards in places, and the script drives forward only; "
            "use planner least_cost, or hybrid_astar with motion_model dubins"
        )
    vertices = path_vertices(plan)
    sections = cut_sections(vertices, [abs(vertex.turn) > _STOP_TO_TURN for vertex in vertices])
    turn = vertices[0].turn
    for section in sections:
        yield turn, section.headings[0], section.points
        turn = section.end_turn
    yield turn, plan.goal.yaw, []


def _route_lines(route: list[Stretch]) -> Iterator[str]:
    for turn, heading, points in route:
        numbers = [f"({x:.3f}, {y:.3f})" for x, y in points]
        yield f"    ({turn:.4f}, {heading:.4f}, [{']),' if not numbers else ''}"
        for index in range(0, len(numbers), _POINTS_A_LINE):
            yield f"        {', '.join(numbers[index : index + _POINTS_A_LINE])},"
        if numbers:
            yield "    ]),"


def speed_zones(points: Sequence[tuple[float, float]], mask: SpeedMask, top_speed: float) -> Iterator[Zone]:
    """Yield where a mask limits the speed along a stretch, or 0.1 m beside it, before it and beyond it."""
    section = Section(points, 0.0)
    count = math.ceil((section.length + 2.0 * BESIDE_M) / _ZONE_STEP_M)
    along = np.linspace(-BESIDE_M, section.length + BESIDE_M, count + 1)
    poses = np.array([(*section.point_at(s), section.heading_at(s)) for s in along.tolist()])
    limits = np.minimum(limits_along(poses, mask, top_speed), top_speed)
    first = 0
    for end in [*(np.flatnonzero(np.diff(limits)) + 1).tolist(), len(limits)]:
        if limits[first] < top_speed:
            yield float(along[max(first - 1, 0)]), float(along[min(end, count)]), float(limits[first])
        first = end


def _limits_text(route: list[Stretch], mask: SpeedMask | None, top_speed: float) -> str:
    """Write a Python dictionary of speed zones by the number of their stretch."""
    lines: list[str] = []
    for number, (_, _, points) in enumerate(route):
        zones = [] if mask is None or not points else list(speed_zones(points, mask, top_speed))
        words = [f"({begin:.3f}, {end:.3f}, {limit:g})" for begin, end, limit in zones]
        if words:
            lines.append(f"    {number}: [")
            lines += [
                f"        {', '.join(words[i : i + _ZONES_A_LINE])}," for i in range(0, len(words), _ZONES_A_LINE)
            ]
            lines.append("    ],")
    return "\n".join(["{", *lines, "}"]) if lines else "{}"


def _text(value: str) -> str:
    """Write a Python literal with double quotes."""
    quoted = repr(value)
    return f'"{quoted[1:-1]}"' if quoted[0] == "'" and '"' not in value else quoted


def _plain(value: str) -> str:
    """Return a text that is safe in a docstring."""
    return "".join(letter if letter.isprintable() and letter not in '\\"' else "_" for letter in value)
