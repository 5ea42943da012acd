"""Services of Nav2's nodes: their lifecycle, and those of costmaps, map server and planner server."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

import numpy as np

from trundle.errors import InputError
from trundle.mission import ClearObstacles, ReinitializeGlobal
from trundle.ros2.navigator_role.context import Kit
from trundle.ros2.navigator_role.costmap_outputs import local_window
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

_CLEARS: dict[str, tuple[str, Literal["all", "around", "except"]]] = {
    "clear_entirely": ("nav2_msgs/srv/ClearEntireCostmap", "all"),
    "clear_around": ("nav2_msgs/srv/ClearCostmapAroundRobot", "around"),
    "clear_except": ("nav2_msgs/srv/ClearCostmapExceptRegion", "except"),
}

_VALID = "nav2_msgs/srv/IsPathValid"
_SEARCH = "reinitialize_global_localization"

OPTIONAL = frozenset({_VALID})
"""Types that a distribution may lack."""

Serve = Callable[[str, str, Callable[[Any], Any]], object]
"""Serves a service of a name, a type and a handler."""


class Lifecycle:
    """Answers who asks for the state of a node, and takes the commands of lifecycle managers.

    The navigator is active from the start. Where it is paused, reset or shut down, goals are refused and what the robot
    does is cancelled; started up again, it goes on.

    Args:
        wire: What serves it.
        changed: Called with the reason why goals are refused from now on; empty where they are taken.

    Attributes:
        state: The state of all nodes.
    """

    def __init__(self, wire: Wire, changed: Callable[[str], None]) -> None:
        self._wire, self._changed = wire, changed
        self.state = "active"

    def open(self, serve: Serve) -> None:
        """Offer the services."""
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


class Services:
    """Clears costmaps, lets the localizer search, and answers with the map, the costmaps and whether a path is free.

    trundle has one costmap of map and obstacles: the global one of Nav2 is all of it, and the local one a window of it
    around the robot. Clearing either clears what was sensed in both.

    Args:
        kit: What actions work with.
    """

    def __init__(self, kit: Kit) -> None:
        self._kit = kit

    def open(self, serve: Serve) -> None:
        """Offer the services."""
        for which in ("global", "local"):
            for verb, (type_name, region) in _CLEARS.items():
                serve(f"{which}_costmap/{verb}_{which}_costmap", type_name, self._clear(type_name, region))
            serve(f"{which}_costmap/get_costmap", "nav2_msgs/srv/GetCostmap", self._costmap(which == "local"))
        serve("map_server/map", "nav_msgs/srv/GetMap", self._map)
        serve("is_path_valid", _VALID, self._is_path_valid)
        serve(_SEARCH, "std_srvs/srv/Empty", self._search)

    def _clear(self, type_name: str, region: Literal["all", "around", "except"]) -> Callable[[Any], Any]:
        kit = self._kit

        def clear(request: Any) -> Any:
            size = 0.0 if region == "all" else float(request.reset_distance)
            if region != "all" and not size > 0.0:
                raise InputError(f"reset_distance must be positive, got {size:g} m: nothing is cleared")
            steering = kit.context.driver.steering
            steering.put(ClearObstacles(region, size), by=type_name.rpartition("/")[2])
            return kit.types.make(f"{type_name}_Response")

        return clear

    def _search(self, request: Any) -> Any:
        kit = self._kit

        def report(why: str) -> None:
            kit.context.wire.warn(f"{_SEARCH}: refused", f"a request of {_SEARCH} is refused: {why}")

        kit.context.driver.steering.put(ReinitializeGlobal(), by=_SEARCH, refused=report)
        return kit.types.make("std_srvs/srv/Empty_Response")

    def _map(self, request: Any) -> Any:
        kit = self._kit
        grid = kit.make.grid(0.0, kit.context.mission.grid, kit.map_frame)
        return kit.types.make("nav_msgs/srv/GetMap_Response", map=grid)

    def _costmap(self, local: bool) -> Callable[[Any], Any]:
        kit = self._kit

        def answer(request: Any) -> Any:
            belief, make = kit.beliefs.now, kit.types.make
            if local:
                costs, origin = local_window(belief.costmap, belief.pose)
            else:
                costs, origin = belief.costmap.data, belief.costmap.origin
            stamp = kit.make.stamp(belief.time)
            metadata = make(
                "nav2_msgs/msg/CostmapMetaData",
                map_load_time=stamp,
                update_time=stamp,
                layer="master",
                resolution=belief.costmap.resolution,
                size_x=costs.shape[1],
                size_y=costs.shape[0],
                origin=kit.make.pose(origin),
            )
            header = kit.make.header(belief.time, kit.map_frame)
            message = make("nav2_msgs/msg/Costmap", header=header, metadata=metadata, data=np.ravel(costs))
            return make("nav2_msgs/srv/GetCostmap_Response", map=message)

        return answer

    def _is_path_valid(self, request: Any) -> Any:
        """Answer whether the footprint touches nothing at the poses of a path, with the indices where it does."""
        kit = self._kit
        poses = [kit.beliefs.read(stamped, "a pose of the path").as_tuple() for stamped in request.path.poses]
        costmap = kit.beliefs.now.costmap
        hits = np.flatnonzero(costmap.footprint_collides(np.array(poses))) if poses else np.zeros(0, np.intp)
        return kit.types.make(
            f"{_VALID}_Response",
            success=True,
            is_valid=bool(poses) and len(hits) == 0,
            invalid_pose_indices=hits.astype(np.int32),
        )
