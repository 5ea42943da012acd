"""Services of Nav2's servers: costmaps, planner, localizer, map server and map saver."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal
from urllib.parse import unquote, urlsplit

import numpy as np

from trundle.errors import InputError, TrundleError
from trundle.maps import OccupancyGrid
from trundle.maps.occupancy import Mode
from trundle.mission import ClearObstacles, ReinitializeGlobal
from trundle.ros2.navigator_role.context import Kit
from trundle.ros2.navigator_role.inputs import PoseInputs
from trundle.ros2.navigator_role.lifecycle import Serve
from trundle.ros2.navigator_role.outputs import local_window

_CLEARS: dict[str, tuple[str, Literal["all", "around", "except"]]] = {
    "clear_entirely": ("nav2_msgs/srv/ClearEntireCostmap", "all"),
    "clear_around": ("nav2_msgs/srv/ClearCostmapAroundRobot", "around"),
    "clear_except": ("nav2_msgs/srv/ClearCostmapExceptRegion", "except"),
}

_VALID = "nav2_msgs/srv/IsPathValid"
_SEARCH = "reinitialize_global_localization"

_AROUND_POSE = "nav2_msgs/srv/ClearCostmapAroundPose"
_SET_POSE = "nav2_msgs/srv/SetInitialPose"

OPTIONAL = frozenset({_VALID, _AROUND_POSE, _SET_POSE, "nav2_msgs/srv/SaveMap"})
"""Types that a distribution may lack."""


class Services:
    """Clears costmaps, lets the localizer search, and answers with the costmaps and whether a path is free.

    trundle has one costmap of map and obstacles: the global one of Nav2 is all of it, and the local one a window of it
    around the robot. Clearing either clears what was sensed in both.

    Args:
        kit: What actions work with.
        poses: Takes the pose of the localizer.
    """

    def __init__(self, kit: Kit, poses: PoseInputs) -> None:
        self._kit, self._poses = kit, poses

    def open(self, serve: Serve) -> None:
        """Offer the services."""
        for which in ("global", "local"):
            for verb, (type_name, region) in _CLEARS.items():
                serve(f"{which}_costmap/{verb}_{which}_costmap", type_name, self._clear(type_name, region))
            serve(f"{which}_costmap/clear_around_pose_{which}_costmap", _AROUND_POSE, self._clear_around_pose)
            serve(f"{which}_costmap/get_costmap", "nav2_msgs/srv/GetCostmap", self._costmap(which == "local"))
        # As BasicNavigator of newer distributions calls them; Nav2's own costmaps have only the names above.
        for name, kind, handler in (
            ("clear_costmap_around_robot", _CLEARS["clear_around"][0], self._clear(*_CLEARS["clear_around"])),
            ("clear_costmap_except_region", _CLEARS["clear_except"][0], self._clear(*_CLEARS["clear_except"])),
            ("clear_costmap_around_pose", _AROUND_POSE, self._clear_around_pose),
        ):
            serve(f"local_costmap/{name}", kind, handler)
        serve("set_initial_pose", _SET_POSE, self._set_pose)
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

    def _clear_around_pose(self, request: Any) -> Any:
        kit, size = self._kit, float(request.reset_distance)
        if not size > 0.0:
            raise InputError(f"reset_distance must be positive, got {size:g} m: nothing is cleared")
        pose = kit.beliefs.read(request.pose, "the pose to clear around")
        directive = ClearObstacles("around", size, pose)
        kit.context.driver.steering.put(directive, by=_AROUND_POSE.rpartition("/")[2])
        types, response = kit.types, f"{_AROUND_POSE}_Response"
        return types.make(response, success=True) if types.has(response, "success") else types.make(response)

    def _set_pose(self, request: Any) -> Any:
        self._poses.take_pose(request.pose, "set_initial_pose")
        return self._kit.types.make(f"{_SET_POSE}_Response")

    def _search(self, request: Any) -> Any:
        kit = self._kit

        def report(why: str) -> None:
            kit.context.wire.warn(f"{_SEARCH}: refused", f"a request of {_SEARCH} is refused: {why}")

        kit.context.driver.steering.put(ReinitializeGlobal(), by=_SEARCH, refused=report)
        return kit.types.make("std_srvs/srv/Empty_Response")

    def _costmap(self, local: bool) -> Callable[[Any], Any]:
        kit = self._kit

        def answer(request: Any) -> Any:
            belief, make = kit.beliefs.now, kit.types.make
            if local:
                costs, origin = local_window(belief.costmap, belief.pose, belief.map_odom)
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
            frames, names = kit.context.profile.frames, kit.context.wire.names
            header = kit.make.header(belief.time, names.frame(frames.odom) if local else kit.map_frame)
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


_LOAD, _SAVE = "nav2_msgs/srv/LoadMap", "nav2_msgs/srv/SaveMap"
_SUCCESS, _NOT_THERE, _BAD, _UNDEFINED = (
    "RESULT_SUCCESS",
    "RESULT_MAP_DOES_NOT_EXIST",
    "RESULT_INVALID_MAP_DATA",
    ("RESULT_UNDEFINED_FAILURE"),
)
_NUMBERS = {_SUCCESS: 0, _NOT_THERE: 1, _BAD: 2, _UNDEFINED: 255}


class MapServices:
    """Answers with the map, takes another one, and writes it to a file.

    Args:
        kit: What actions work with.
        use: Lets the robot drive on the map of a file, or raises an InputError that says why it cannot.
    """

    def __init__(self, kit: Kit, use: Callable[[Path], None]) -> None:
        self._kit, self._use = kit, use

    def open(self, serve: Serve) -> None:
        """Offer the services."""
        serve("map_server/map", "nav_msgs/srv/GetMap", self._map)
        serve("map_server/load_map", _LOAD, self._load)
        serve("map_saver/save_map", _SAVE, self._save)

    def _map(self, request: Any) -> Any:
        return self._kit.types.make("nav_msgs/srv/GetMap_Response", map=self._message())

    def _message(self) -> Any:
        kit = self._kit
        return kit.make.grid(0.0, self._grid(), kit.map_frame)

    def _grid(self) -> OccupancyGrid:
        """Return the map as it is now.

        Raises:
            InputError: If there is none, or none yet.
        """
        found = self._kit.beliefs.map
        if found is None:
            raise InputError("the robot has no map: it drives by its lidars alone, or has not seen a scan yet")
        return found

    def _load(self, request: Any) -> Any:
        kit, name = self._kit, f"{_LOAD}_Response"
        result, why = self._take(str(request.map_url))
        number = kit.types.constant(name, result, _NUMBERS[result])
        if result == _SUCCESS:
            return kit.types.make(name, map=self._message(), result=number)
        kit.context.wire.warn(f"load_map: {result}", f"a request of map_server/load_map is refused: {why}")
        return kit.types.make(name, result=number)

    def _take(self, url: str) -> tuple[str, str]:
        """Take a map unless it is the present one; return the name of the result, and the reason."""
        try:
            path = read_url(url)
            if not path.is_file():
                return _NOT_THERE, f"there is no file {path}"
            loaded = OccupancyGrid.load(path)
        except (TrundleError, OSError) as error:
            return _BAD, str(error)
        here = self._kit.beliefs.map
        same = here is not None and loaded.resolution == here.resolution and loaded.origin == here.origin
        if here is not None and same and np.array_equal(loaded.data, here.data):
            return _SUCCESS, ""
        try:
            self._use(path)
        except (TrundleError, OSError) as error:
            return _UNDEFINED, str(error)
        return _SUCCESS, ""

    def _save(self, request: Any) -> Any:
        kit = self._kit
        try:
            self._write(request)
        except (TrundleError, OSError) as error:
            kit.context.wire.warn("save_map: refused", f"a request of map_saver/save_map is refused: {error}")
            return kit.types.make(f"{_SAVE}_Response", result=False)
        return kit.types.make(f"{_SAVE}_Response", result=True)

    def _write(self, request: Any) -> None:
        path = read_url(str(request.map_url) or "map")
        path = path if path.suffix in (".yaml", ".yml") else path.with_name(f"{path.name}.yaml")
        topic = self._kit.context.wire.names.resolve(str(request.map_topic) or "map")
        if topic != self._kit.context.wire.names.resolve("map"):
            raise InputError(f"the map is that of the topic map, and not of {topic}")
        if path.exists():
            raise InputError(f"{path} is there already: who comes over the network overwrites nothing")
        formats: dict[str, Literal["png", "pgm"]] = {"": "pgm", "png": "png", "pgm": "pgm"}
        modes: dict[str, Mode] = {"": "trinary", "trinary": "trinary", "scale": "scale", "raw": "raw"}
        image, mode = str(request.image_format), str(request.map_mode)
        if image not in formats or mode not in modes:
            raise InputError(f"image_format is png or pgm, map_mode trinary, scale or raw; got {image!r} and {mode!r}")
        self._grid().save(path, mode=modes[mode], image_format=formats[image])


def read_url(url: str) -> Path:
    """Read the path of a file from what Nav2 calls a URL: a path, or file:///….

    Raises:
        InputError: If it names no file of this machine.
    """
    if "\0" in url or not url:
        raise InputError(f"{url!r} names no file")
    if "://" not in url:
        return Path(url)
    parts = urlsplit(url)
    if parts.scheme != "file" or parts.netloc not in ("", "localhost"):
        raise InputError(f"{url!r} is no file of this machine: give a path, or file:///…")
    return Path(unquote(parts.path))
