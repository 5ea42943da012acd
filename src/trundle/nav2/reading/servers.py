"""The checkers of the controller server, the velocity smoother, the behavior server and AMCL's initial pose."""

from __future__ import annotations

import math

from trundle.control import GoalChecker, ProgressChecker
from trundle.nav2.names import (
    POSE_PROGRESS,
    POSITION_GOAL,
    SIMPLE_GOAL,
    SIMPLE_PROGRESS,
    STOPPED_GOAL,
)
from trundle.nav2.parameters import NodeParameters
from trundle.nav2.reading.notes import Notes
from trundle.nav2.reading.plugins import choose_plugin

SPIN_RADPS = 1.0
"""Nav2's default of `max_rotational_vel`."""

RECOVERY = {"spin": "spin", "wait": "wait", "backup": "back_up"}
"""Behaviors that Nav2's default tree recovers by, in its order, and their names in trundle."""

SPIN_RAD, WAIT_S = 1.57, 5.0
BACK_UP = {"distance": 0.3, "speed": 0.15}
"""What that tree asks of them; it backs up at 0.05 m/s in Humble and 0.15 m/s or more since."""

RETRIES = 6
_FREQUENCIES = (0.1, 1000.0)
_TURNING_RAD = 0.5


def read_checkers(server: NodeParameters, notes: Notes) -> dict[str, object]:
    """Settings of the goal checker, the progress checker and the control frequency.

    Raises:
        InputError: If a parameter cannot be used.
    """
    given = server.number("controller_frequency", 20.0, above=0.0)
    frequency = min(max(given, _FREQUENCIES[0]), _FREQUENCIES[1])
    if frequency != given:
        notes.changed(server, "controller_frequency", f"trundle takes {_FREQUENCIES[0]:g} to {_FREQUENCIES[1]:g} Hz")
    return {"control_frequency": frequency, **_read_progress(server, notes), **_read_goal(server, notes)}


def _read_progress(server: NodeParameters, notes: Notes) -> dict[str, object]:
    lists = ("progress_checker_plugins", "progress_checker_plugin")
    name, plugin = choose_plugin(server, lists, "progress_checker", SIMPLE_PROGRESS, notes)
    block = server.of_plugin(name)
    usual = ProgressChecker().required_movement_angle
    if plugin == POSE_PROGRESS:
        if block.number("required_movement_angle", _TURNING_RAD, least=0.0) != usual:
            notes.changed(block, "required_movement_angle", f"in trundle a turn by {usual:g} rad is progress")
    elif plugin == SIMPLE_PROGRESS:
        notes.changed(block, "plugin", f"in trundle a turn by {usual:g} rad is progress too")
    else:
        notes.changed(block, "plugin", "not known: its radius and its time are taken")
    return {
        "required_movement_radius": block.number("required_movement_radius", 0.5, least=0.0),
        "movement_time_allowance": block.number("movement_time_allowance", 10.0, least=0.0),
    }


def _read_goal(server: NodeParameters, notes: Notes) -> dict[str, object]:
    name, plugin = choose_plugin(server, ("goal_checker_plugins",), "general_goal_checker", SIMPLE_GOAL, notes)
    block = server.of_plugin(name)
    distance = block.number("xy_goal_tolerance", 0.25, least=0.0)
    turn = min(block.number("yaw_goal_tolerance", 0.25, least=0.0), math.pi)
    usual = GoalChecker()
    if plugin == POSITION_GOAL:
        turn = math.pi
    elif plugin == STOPPED_GOAL:
        stopped = {"trans_stopped_velocity": usual.stopped_linear, "rot_stopped_velocity": usual.stopped_angular}
        for key, value in stopped.items():
            if block.number(key, 0.25, least=0.0) != value:
                notes.changed(block, key, f"in trundle the robot stands at {value:g} or less")
    elif plugin == SIMPLE_GOAL:
        notes.changed(block, "plugin", "in trundle the robot must stand at the goal, as for StoppedGoalChecker")
    else:
        notes.changed(block, "plugin", "not known: its tolerances are taken")
    return {"goal_tolerance": distance, "goal_yaw_tolerance": turn}


def read_limits(smoother: NodeParameters, notes: Notes) -> dict[str, float]:
    """Speeds and accelerations that the velocity smoother keeps to.

    Raises:
        InputError: If a parameter cannot be used.
    """
    most = _ends(smoother, "max_velocity", (0.5, 2.5))
    least = _ends(smoother, "min_velocity", (-0.5, -2.5))
    faster = _ends(smoother, "max_accel", (2.5, 3.2))
    slower = _ends(smoother, "max_decel", (-2.5, -3.2))
    for index, name in ((0, "max_velocity"), (1, "max_velocity"), (0, "max_accel"), (1, "max_accel")):
        if not (most if name == "max_velocity" else faster)[index] > 0.0:
            raise smoother.wrong(name, "must be above 0 for x and theta: the robot would never move")
    for index, name in ((0, "min_velocity"), (1, "min_velocity"), (0, "max_decel"), (1, "max_decel")):
        value = (least if name == "min_velocity" else slower)[index]
        if value > 0.0 or (value == 0.0 and (name, index) != ("min_velocity", 0)):
            raise smoother.wrong(name, "must be below 0 for x and theta")
    if most[1] != -least[1]:
        notes.changed(smoother, "min_velocity", "trundle's turning speed is the same to both sides: the lower one")
    if (faster[0], faster[1]) != (-slower[0], -slower[1]):
        notes.changed(smoother, "max_decel", "trundle speeds up and slows down alike: by the lower one")
    return {
        "linear_speed": most[0],
        "reverse_speed": abs(least[0]),
        "angular_speed": min(most[1], -least[1]),
        "linear_acceleration": min(faster[0], -slower[0]),
        "angular_acceleration": min(faster[1], -slower[1]),
    }


def _ends(smoother: NodeParameters, name: str, default: tuple[float, float]) -> tuple[float, float]:
    """X and theta of (x, y, theta), or of all six axes."""
    values = smoother.numbers(name, (default[0], 0.0, default[1]), lengths=(3, 6))
    return values[0], values[-1]


def read_recovery(server: NodeParameters, notes: Notes) -> dict[str, object]:
    """What a blocked robot does: the steps of Nav2's default behavior tree, as far as the server has them.

    Raises:
        InputError: If a parameter cannot be used.
    """
    key = "behavior_plugins" if not server.has("recovery_plugins") else "recovery_plugins"
    known = (*RECOVERY, "drive_on_heading", "assisted_teleop")
    names = server.texts(key, known)
    speed = server.number("max_rotational_vel", SPIN_RADPS, above=0.0)
    options = {
        "spin": {"angle": SPIN_RAD, "speed": speed},
        "wait": {"seconds": WAIT_S},
        "back_up": dict(BACK_UP),
    }
    steps: list[dict[str, object]] = [{"name": "clear_costmap", "options": {}}]
    steps += [{"name": name, "options": options[name]} for plugin, name in RECOVERY.items() if plugin in names]
    unknown = [name for name in names if name not in known]
    if unknown:
        notes.changed(server, key, f"not known, and left out: {', '.join(unknown)}")
    for name in names:
        server.of_plugin(name).text("plugin", "")
    return {"recovery": steps, "recovery_retries": RETRIES}


def read_start(amcl: NodeParameters) -> tuple[float, float, float] | None:
    """The initial pose that the file gives AMCL; None where it gives none.

    Raises:
        InputError: If a coordinate is no number.
    """
    if not amcl.flag("set_initial_pose", False):
        return None
    pose = amcl.of_plugin("initial_pose")
    pose.number("z", 0.0)
    return pose.number("x", 0.0), pose.number("y", 0.0), pose.number("yaw", 0.0)
