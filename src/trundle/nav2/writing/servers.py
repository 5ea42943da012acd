"""The velocity smoother, the behavior server, AMCL, and the nodes whose parameters say what belongs together."""

from __future__ import annotations

from trundle.messages.topic_names import scan_topic
from trundle.nav2.names import BEHAVIORS
from trundle.nav2.reading.servers import BACK_UP, RECOVERY, RETRIES, SPIN_RAD, SPIN_RADPS, WAIT_S
from trundle.nav2.writing.draft import Block, Draft

_TREE = {"spin": {"angle": SPIN_RAD}, "wait": {"seconds": WAIT_S}, "back_up": dict(BACK_UP), "clear_costmap": {}}
"""What Nav2's default behavior tree asks of each step."""


def write_servers(draft: Draft) -> None:
    """Write them."""
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
    draft.nodes["amcl"] = _write_amcl(draft)


def _write_behaviors(draft: Draft) -> Block:
    """The behavior server, with all that Nav2's default tree calls, or the part of it that a parameter file had."""
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


def _write_amcl(draft: Draft) -> Block:
    names = draft.lidars or tuple(draft.robot.lidars)
    block: Block = {
        "global_frame_id": "map",
        "odom_frame_id": "odom",
        "base_frame_id": "base_link",
        "robot_model_type": "nav2_amcl::DifferentialMotionModel",
        "tf_broadcast": True,
        "transform_tolerance": 1.0,
    }
    if names:
        block["scan_topic"] = scan_topic(names[0], draft.robot)
        block["laser_max_range"] = float(draft.robot.lidars[names[0]].range_max)
    start = draft.scenario.start
    if start is not None:
        x, y, yaw = (*start, 0.0)[:3]
        block["set_initial_pose"] = True
        block["initial_pose"] = {"x": float(x), "y": float(y), "z": 0.0, "yaw": float(yaw)}
    return block
