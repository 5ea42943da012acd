"""Why a parameter of Nav2 has no counterpart in trundle."""

from __future__ import annotations

from fnmatch import fnmatchcase

_ROS = "ROS's own: topics, frames, clocks and lifecycles"
_WINDOW = "trundle has one costmap, the global one; a controller sees all of it"
_SPEED = "trundle's own search, samples or checks take its place"

_BY_NODE = {
    "amcl": "AMCL's own; the localizer of a scenario is chosen with --localizer",
    "bt_navigator": "trundle has no behavior trees; `recovery` and `replan_interval_s` say what it does",
    "map_server": "the map is what trundle run is given",
    "map_saver": "trundle map writes maps",
    "waypoint_follower": "goals with tasks are a scenario's `goals`",
    "route_server": "trundle has no route graphs",
    "docking_server": "trundle does not dock",
    "following_server": "trundle does not follow objects",
    "loopback_simulator": "trundle simulates by itself",
    "lifecycle_manager": _ROS,
    "robot_state_publisher": _ROS,
    "smoother_server": "Nav2's default behavior trees call no smoother; --smoother constrained smooths trundle's paths",
}

_BY_NAME = (
    ("use_sim_time", _ROS),
    ("bond_*", _ROS),
    ("*introspection_mode", _ROS),
    ("*_topic", _ROS),
    ("*.topic", _ROS),
    ("topic", _ROS),
    ("*_frame", _ROS),
    ("*_frame_id", _ROS),
    ("*base_frame", _ROS),
    ("*sensor_frame", _ROS),
    ("*transform_tolerance", _ROS),
    ("tf_*", _ROS),
    ("*publish*", _ROS),
    ("*visualize*", _ROS),
    ("*debug*", _ROS),
    ("*TrajectoryVisualizer*", _ROS),
    ("*map_subscribe_transient_local", _ROS),
    ("*always_send_full_costmap", _ROS),
    ("*enable_stamped_cmd_vel", _ROS),
    ("*use_realtime_priority", _ROS),
    ("*update_frequency", "trundle's costmap is updated with every scan"),
    ("rolling_window", _WINDOW),
    ("resolution", _WINDOW),
    ("width", _WINDOW),
    ("height", _WINDOW),
    ("*.z_*", "trundle's lidars are planar"),
    ("*origin_z", "trundle's lidars are planar"),
    ("*_obstacle_height", "trundle's lidars are planar"),
    ("*.m??_height", "trundle's lidars are planar"),
    ("*mark_threshold", "trundle's lidars are planar"),
    ("*inf_is_valid", "it is a setting of the robot's lidars"),
    ("*.v?_*", _SPEED),
    ("*.a?_*", _SPEED),
    ("*y_velocity*", "trundle's robots do not drive sideways"),
)


def reason_for(node: str, name: str) -> str:
    """The reason why a parameter has no counterpart."""
    for pattern, reason in _BY_NAME:
        if fnmatchcase(name, pattern):
            return reason
    for known, reason in _BY_NODE.items():
        if node.startswith(known):
            return reason
    return "trundle has nothing like it"
