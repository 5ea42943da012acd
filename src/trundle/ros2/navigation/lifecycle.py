"""`Lifecycle`: the states of Nav2's nodes, as scripts wait for them and lifecycle managers change them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from trundle.ros2.wire import Wire

NODES = (
    "amcl",
    "behavior_server",
    "bt_navigator",
    "collision_monitor",
    "controller_server",
    "global_costmap/global_costmap",
    "local_costmap/local_costmap",
    "map_server",
    "planner_server",
    "smoother_server",
    "velocity_smoother",
    "waypoint_follower",
)
"""Nodes of Nav2 whose state can be asked for: all have the state of the navigator."""

MANAGERS = ("lifecycle_manager_localization", "lifecycle_manager_navigation")

_STATES = {"unconfigured": 1, "inactive": 2, "active": 3, "finalized": 4}
"""Numbers of lifecycle_msgs/msg/State."""

_STARTUP, _PAUSE, _RESUME, _RESET, _SHUTDOWN = range(5)
"""Commands of nav2_msgs/srv/ManageLifecycleNodes; CONFIGURE and CLEANUP follow from Kilted on."""

_AFTER = {
    _STARTUP: "active",
    _PAUSE: "inactive",
    _RESUME: "active",
    _RESET: "unconfigured",
    _SHUTDOWN: "finalized",
    5: "inactive",
    6: "unconfigured",
}


class Lifecycle:
    """Answers who asks for the state of a node, and takes the commands of lifecycle managers.

    The navigator is active from the start. Where it is paused, reset or shut down, goals are refused and what the robot
    does is cancelled; started up again, it goes on.

    Args:
        wire: What serves it.
        changed: Called with the reason why goals are refused from now on; empty where they are taken.

    Attributes:
        state: Of all nodes.
    """

    def __init__(self, wire: Wire, changed: Callable[[str], None]) -> None:
        self._wire, self._changed = wire, changed
        self.state = "active"

    def open(self, serve: Callable[[str, str, Callable[[Any], Any]], object]) -> None:
        """Offer the services, by what serves one of a name, a type and a handler."""
        for node in NODES:
            serve(f"{node}/get_state", "lifecycle_msgs/srv/GetState", self._get_state)
        for manager in MANAGERS:
            serve(f"{manager}/manage_nodes", "nav2_msgs/srv/ManageLifecycleNodes", self._manage)
            serve(f"{manager}/is_active", "std_srvs/srv/Trigger", self._is_active)

    def _get_state(self, request: Any) -> Any:
        make = self._wire.types.make
        state = make("lifecycle_msgs/msg/State", id=_STATES[self.state], label=self.state)
        return make("lifecycle_msgs/srv/GetState_Response", current_state=state)

    def _is_active(self, request: Any) -> Any:
        active = self.state == "active"
        message = "" if active else f"the navigator is {self.state}"
        return self._wire.types.make("std_srvs/srv/Trigger_Response", success=active, message=message)

    def _manage(self, request: Any) -> Any:
        after = _AFTER.get(int(request.command))
        ok = after is not None and (self.state != "finalized" or after == "finalized")
        if after is not None and ok and after != self.state:
            self.state = after
            self._changed("" if after == "active" else f"the navigator is {after}: a lifecycle manager made it so")
        return self._wire.types.make("nav2_msgs/srv/ManageLifecycleNodes_Response", success=ok)
