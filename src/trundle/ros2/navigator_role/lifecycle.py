"""`Lifecycle`: the states of Nav2's nodes, and the lifecycle managers that change them."""

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
"""Nodes of Nav2 whose state can be asked for and changed."""

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

_CONFIGURE, _CLEANUP, _ACTIVATE, _DEACTIVATE = 1, 2, 3, 4
_TRANSITIONS: dict[int, tuple[tuple[str, ...], str]] = {
    # A manager that starts beside trundle configures first: nodes that are active already go back for it.
    _CONFIGURE: (("unconfigured", "active"), "inactive"),
    _CLEANUP: (("inactive",), "unconfigured"),
    _ACTIVATE: (("inactive",), "active"),
    _DEACTIVATE: (("active",), "inactive"),
    5: (("unconfigured",), "finalized"),
    6: (("inactive",), "finalized"),
    7: (("active",), "finalized"),
}
"""Numbers of lifecycle_msgs/msg/Transition: from which states, and to which one."""

_LABELS = {"configure": 1, "cleanup": 2, "activate": 3, "deactivate": 4}

_CHANGE = "lifecycle_msgs/srv/ChangeState"

Serve = Callable[[str, str, Callable[[Any], Any]], object]
"""Serves a service of a name, a type and a handler."""


class Lifecycle:
    """Answers who asks for the state of a node, and takes the commands of lifecycle managers.

    The nodes are active from the start. Where one of them is not, goals are refused and what the robot does is
    cancelled; when all are active again, it takes goals.

    Args:
        wire: What serves it.
        changed: Called with the reason why goals are refused from now on; empty where they are taken.

    Attributes:
        states: The state of each node.
    """

    def __init__(self, wire: Wire, changed: Callable[[str], None]) -> None:
        self._wire, self._changed = wire, changed
        self.states: dict[str, str] = dict.fromkeys(NODES, "active")
        self._refuses = ""

    @property
    def state(self) -> str:
        """The state of all nodes: that of the first one that is not active."""
        return next((state for state in self.states.values() if state != "active"), "active")

    def open(self, serve: Serve) -> None:
        """Offer the services."""
        for node in NODES:
            serve(f"{node}/get_state", "lifecycle_msgs/srv/GetState", self._get_state(node))
            serve(f"{node}/change_state", _CHANGE, self._change_state(node))
        for manager in MANAGERS:
            serve(f"{manager}/manage_nodes", "nav2_msgs/srv/ManageLifecycleNodes", self._manage)
            serve(f"{manager}/is_active", "std_srvs/srv/Trigger", self._is_active)

    def _get_state(self, node: str) -> Callable[[Any], Any]:
        def answer(request: Any) -> Any:
            make, state = self._wire.types.make, self.states[node]
            return make(
                "lifecycle_msgs/srv/GetState_Response",
                current_state=make("lifecycle_msgs/msg/State", id=_STATES[state], label=state),
            )

        return answer

    def _change_state(self, node: str) -> Callable[[Any], Any]:
        def answer(request: Any) -> Any:
            number = int(request.transition.id) or _LABELS.get(str(request.transition.label), 0)
            before, after = _TRANSITIONS.get(number, ((), ""))
            ok = self.states[node] in before
            if ok:
                self.states[node] = after
                self._tell(f"{node} is {after}: a lifecycle manager made it so")
            return self._wire.types.make(f"{_CHANGE}_Response", success=ok)

        return answer

    def _is_active(self, request: Any) -> Any:
        active = self.state == "active"
        message = "" if active else f"the navigator is {self.state}"
        return self._wire.types.make("std_srvs/srv/Trigger_Response", success=active, message=message)

    def _manage(self, request: Any) -> Any:
        after = _AFTER.get(int(request.command))
        ok = after is not None and (self.state != "finalized" or after == "finalized")
        if after is not None and ok:
            self.states = dict.fromkeys(NODES, after)
            self._tell(f"the navigator is {after}: a lifecycle manager made it so")
        return self._wire.types.make("nav2_msgs/srv/ManageLifecycleNodes_Response", success=ok)

    def _tell(self, why: str) -> None:
        """Tell whether goals are taken, where that has changed."""
        refuses = "" if self.state == "active" else why
        if bool(refuses) != bool(self._refuses):
            self._changed(refuses)
        self._refuses = refuses
