"""Services of Nav2's map server and map saver."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal
from urllib.parse import unquote, urlsplit

import numpy as np

from trundle.errors import InputError, TrundleError
from trundle.maps import OccupancyGrid
from trundle.maps.occupancy import Mode
from trundle.ros2.navigator_role.context import Kit
from trundle.ros2.navigator_role.lifecycle import Serve

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
