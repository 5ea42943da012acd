"""The velocity smoother and the behavior server, read and written; and what else an export starts."""

from __future__ import annotations

from trundle.nav2.amcl import write_amcl
from trundle.nav2.draft import Block, Draft
from trundle.nav2.names import (
    BEHAVIORS,
)
from trundle.nav2.notes import Notes
from trundle.nav2.parameters import NodeParameters

SPIN_RADPS = 1.0
"""Nav2's default of `max_rotational_vel`."""

RECOVERY = {"spin": "spin", "wait": "wait", "backup": "back_up"}
"""Behaviors that Nav2's default tree recovers by, in its order, and their names in trundle."""

SPIN_RAD, WAIT_S = 1.57, 5.0
BACK_UP = {"distance": 0.3, "speed": 0.15}
"""What that tree asks of them; it backs up at 0.05 m/s in Humble and 0.15 m/s or more since."""

RETRIES = 6
"""How often that tree recovers before it gives up."""

_TREE = {"spin": {"angle": SPIN_RAD}, "wait": {"seconds": WAIT_S}, "back_up": dict(BACK_UP), "clear_costmap": {}}
"""What Nav2's default behavior tree asks of each step."""


def read_limits(smoother: NodeParameters, notes: Notes) -> dict[str, float]:
    """Read the speeds and accelerations that the velocity smoother keeps to.

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
    """Read x and theta of (x, y, theta), or of all six axes."""
    values = smoother.numbers(name, (default[0], 0.0, default[1]), lengths=(3, 6))
    return values[0], values[-1]


def read_recovery(server: NodeParameters, notes: Notes) -> dict[str, object]:
    """Read what a blocked robot does: the steps of Nav2's default behavior tree that the server has.

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


def write_servers(draft: Draft) -> None:
    """Write the velocity smoother, the behavior server, AMCL, and the servers that an export starts besides."""
    limits = draft.robot.limits
    back = limits.linear_speed if limits.reverse_speed is None else limits.reverse_speed
    linear, turning = float(limits.linear_acceleration), float(limits.angular_acceleration)
    draft.nodes["velocity_smoother"] = {
        "smoothing_frequency": float(draft.scenario.control_frequency),
        "scale_velocities": False,
        "feedback": "OPEN_LOOP",
        "max_velocity": [float(limits.linear_speed), 0.0, float(limits.angular_speed)],
        "min_velocity": [-float(back), 0.0, -float(limits.angular_speed)],
        "max_accel": [linear, 0.0, turning],
        "max_decel": [-linear, 0.0, -turning],
        "odom_topic": "odom",
        "odom_duration": 0.1,
        "deadband_velocity": [0.0, 0.0, 0.0],
        "velocity_timeout": 1.0,
    }
    draft.nodes["behavior_server"] = _write_behaviors(draft)
    draft.nodes["bt_navigator"] = {
        "global_frame": "map",
        "robot_base_frame": "base_link",
        "odom_topic": "/odom",
        "bt_loop_duration": 10,
        "default_server_timeout": 20,
    }
    draft.nodes["waypoint_follower"] = {
        "loop_rate": 20,
        "stop_on_failure": False,
        "waypoint_task_executor_plugin": "wait_at_waypoint",
        "wait_at_waypoint": {
            "plugin": "nav2_waypoint_follower::WaitAtWaypoint",
            "enabled": True,
            "waypoint_pause_duration": 200,
        },
    }
    draft.nodes["amcl"] = write_amcl(draft)


def _write_behaviors(draft: Draft) -> Block:
    """Write the behavior server, with all that Nav2's default tree calls, or with what a parameter file had of it."""
    steps = draft.scenario.recovery
    names = [step.name for step in steps]
    order = [name for name in RECOVERY.values() if name in names]
    is_tree = names == ["clear_costmap", *order]
    plugins = [plugin for plugin, name in RECOVERY.items() if not is_tree or name in order]
    plugins = [*plugins, "drive_on_heading"]
    if not is_tree:
        text = "Nav2's steps of recovery are those of its behavior tree: clear the costmaps, spin, wait, back up"
        draft.left_out("recovery", ", ".join(names), text)
    speed = SPIN_RADPS
    for step in steps if is_tree else ():
        options = dict(step.options)
        if step.name == "spin":
            speed = float(str(options.pop("speed", SPIN_RADPS)))
        usual = _TREE[step.name]
        if any(value != usual.get(key, value) for key, value in options.items()):
            draft.left_out(f"recovery.{step.name}", str(options), "Nav2's behavior tree says how far and how long")
    if draft.scenario.recovery_retries != RETRIES:
        draft.left_out("recovery_retries", draft.scenario.recovery_retries, "Nav2's behavior tree has the number: 6")
    topics: Block
    if draft.distro == "humble":
        topics = {
            "costmap_topic": "local_costmap/costmap_raw",
            "footprint_topic": "local_costmap/published_footprint",
            "global_frame": "odom",
        }
    else:
        topics = {
            "local_costmap_topic": "local_costmap/costmap_raw",
            "global_costmap_topic": "global_costmap/costmap_raw",
            "local_footprint_topic": "local_costmap/published_footprint",
            "global_footprint_topic": "global_costmap/published_footprint",
            "local_frame": "odom",
            "global_frame": "map",
        }
    blocks: Block = {name: {"plugin": draft.plugin(f"nav2_behaviors::{BEHAVIORS[name]}")} for name in plugins}
    return {
        **topics,
        "cycle_frequency": 10.0,
        "behavior_plugins": list(plugins),
        **blocks,
        "robot_base_frame": "base_link",
        "transform_tolerance": 0.1,
        "simulate_ahead_time": 2.0,
        "max_rotational_vel": speed,
        "min_rotational_vel": min(0.4, speed),
        "rotational_acc_lim": float(draft.robot.limits.angular_acceleration),
    }
