"""`Remark`: what was not taken over as it is; `Notes`: what is written down while parameters are read."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import Literal, TypeAlias

from trundle.files.yaml_config import Plain
from trundle.nav2.names import plain_plugin
from trundle.nav2.parameters import NodeParameters, Parameter, Repeated

RemarkKind: TypeAlias = Literal["changed", "no counterpart"]
"""Whether something was taken over with another meaning, or not at all."""

ROS_OWN = "topics, frames, clocks and lifecycles"
"""Why most parameters have no counterpart."""


@dataclass(frozen=True, slots=True)
class Remark:
    """Says that the other side lacks a parameter of Nav2 or a setting of trundle, or takes it otherwise.

    Attributes:
        kind: "changed": it was taken over, but means something else; "no counterpart": it was left out.
        node: Nav2's node, such as `controller_server`; empty for a setting of trundle.
        name: The parameter, such as `FollowPath.max_lookahead_dist`, or the setting, such as `replan_margin`.
        value: Its value.
        text: What is done instead, and what to do where one can do something.
        line: Its line in the file, from 1; None where it is not in a file.
    """

    kind: RemarkKind
    node: str
    name: str
    value: Plain
    text: str
    line: int | None = None


def describe_remarks(remarks: Iterable[Remark]) -> list[str]:
    """Return lines for people: what changes the motion, then what else means something else, then what is left out.

    Each remark of kind "changed" has a line, the others one for each reason. What is ROS's own is in every file and
    says nothing about the motion: one line counts it.
    """
    given = list(remarks)
    changed = sorted((remark for remark in given if remark.kind == "changed"), key=_rank)
    lines = [_describe_change(remark) for remark in changed]
    reasons: dict[str, dict[str, list[str]]] = {}
    for remark in given:
        if remark.kind == "no counterpart":
            reasons.setdefault(remark.text, {}).setdefault(remark.node, []).append(remark.name)
    own = sum(len(names) for names in reasons.pop(ROS_OWN, {}).values())
    for text, nodes in reasons.items():
        named = "; ".join(f"{node}: {', '.join(names)}" if node else ", ".join(names) for node, names in nodes.items())
        lines.append(f"no counterpart: {named} ({text})")
    return [*lines, f"left to ROS ({ROS_OWN}): {own} parameters"] if own else lines


def _rank(remark: Remark) -> int:
    """Return the rank of a parameter: which controller, how fast, how the controller drives, and then the rest."""
    if remark.node == "controller_server":
        return 0 if remark.name.endswith(".plugin") else 2
    return {"velocity_smoother": 1, "planner_server": 3, "collision_monitor": 4}.get(remark.node, 5)


def _describe_change(remark: Remark) -> str:
    where = "" if remark.line is None else f"line {remark.line}: "
    node = f"{remark.node}: " if remark.node else ""
    return f"{where}{node}{remark.name} = {_show(remark.value)}: {remark.text}"


def _show(value: Plain) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return f"{value:g}"
    text = str(value)
    return text if len(text) <= 60 else f"{text[:57]}…"


_WINDOW = "trundle has one costmap, the global one; a controller sees all of it"
_SPEED = "trundle's own search, samples or checks take its place"

_BY_NODE = {
    "amcl": "trundle's amcl has nothing like it; without a lidar or a map the robot knows its true pose",
    "bt_navigator": "trundle has no behavior trees; `recovery` and `replan_interval_s` say what it does",
    "map_server": "the map is what trundle run is given",
    "map_saver": "trundle map writes maps",
    "waypoint_follower": "goals with tasks are a scenario's `goals`",
    "route_server": "trundle has no route graphs",
    "docking_server": "trundle does not dock",
    "following_server": "trundle does not follow objects",
    "loopback_simulator": "trundle simulates by itself",
    "lifecycle_manager": ROS_OWN,
    "robot_state_publisher": ROS_OWN,
    "smoother_server": "Nav2's default behavior trees call no smoother; --smoother constrained smooths trundle's paths",
}

_BY_NAME = (
    ("use_sim_time", ROS_OWN),
    ("bond_*", ROS_OWN),
    ("*introspection_mode", ROS_OWN),
    ("*_topic", ROS_OWN),
    ("*.topic", ROS_OWN),
    ("topic", ROS_OWN),
    ("*_frame", ROS_OWN),
    ("*_frame_id", ROS_OWN),
    ("*base_frame", ROS_OWN),
    ("*sensor_frame", ROS_OWN),
    ("*transform_tolerance", ROS_OWN),
    ("tf_*", ROS_OWN),
    ("*publish*", ROS_OWN),
    ("*visualize*", ROS_OWN),
    ("*debug*", ROS_OWN),
    ("*TrajectoryVisualizer*", ROS_OWN),
    ("*map_subscribe_transient_local", ROS_OWN),
    ("*always_send_full_costmap", ROS_OWN),
    ("*enable_stamped_cmd_vel", ROS_OWN),
    ("*use_realtime_priority", ROS_OWN),
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


class Notes:
    """Collects remarks on parameters, in the order in which they were found."""

    def __init__(self) -> None:
        self.remarks: list[Remark] = []

    def changed(self, node: NodeParameters, name: str, text: str) -> None:
        """Note that a parameter means something else here; nothing is noted where the file does not give it."""
        found = node.find(name)
        if found is not None:
            self.remarks.append(Remark("changed", node.name, found.name, found.value, text, found.line))

    def given_twice(self, found: Repeated) -> None:
        """Note that a parameter is given twice, and which one counts."""
        counts = found.counts
        text = f"it is given twice, in lines {found.first} and {found.second}: line {counts.line} counts, as in ROS"
        self.remarks.append(Remark("changed", found.node, counts.name, counts.value, text, counts.line))

    def default(self, node: NodeParameters, name: str, value: Plain, text: str) -> None:
        """Do as `changed` does, also where the file does not give the parameter and Nav2's default counts."""
        found = node.find(name)
        if found is not None:
            self.changed(node, name, text)
        else:
            self.remarks.append(Remark("changed", node.name, name, value, f"(Nav2's default) {text}"))

    def ignored(self, node: NodeParameters, name: str, text: str) -> None:
        """Note that a parameter of the file has no counterpart, for this reason."""
        found = node.find(name)
        if found is not None:
            self.ignore_parameter(node.name, found, text)

    def ignore_parameter(self, node: str, found: Parameter, text: str) -> None:
        """Note that a parameter that was not read has no counterpart."""
        self.remarks.append(Remark("no counterpart", node, found.name, found.value, text, found.line))


def choose_plugin(
    node: NodeParameters, lists: tuple[str, ...], default: str, default_plugin: str, notes: Notes
) -> tuple[str, str]:
    """Return the name and the type of the plugin that Nav2's default behavior tree calls.

    Args:
        node: The server's parameters.
        lists: Parameters that list the plugins' names, of which distributions have one or the other.
        default: The name that counts where it is in the list, and where there is no list; else the first one does.
        default_plugin: The type that counts where the file does not give it.
        notes: Where the others are noted.

    Raises:
        InputError: If a list is none of names, or a type is no text.
    """
    chosen = default
    for key in lists:
        names = node.texts(key, ())
        if names:
            chosen = default if default in names else names[0]
        if len(names) > 1:
            notes.changed(node, key, f"trundle uses one: {chosen}")
    return chosen, plain_plugin(node.of_plugin(chosen).text("plugin", default_plugin))


def reason_for(node: str, name: str) -> str:
    """Return the reason why a parameter has no counterpart."""
    for pattern, reason in _BY_NAME:
        if fnmatchcase(name, pattern):
            return reason
    for known, reason in _BY_NODE.items():
        if node.startswith(known):
            return reason
    return "trundle has nothing like it"
