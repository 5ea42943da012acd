"""The costmap filters, read and written: masks of keep-out zones and speed limits, and their servers."""

from __future__ import annotations

from typing import Literal

from trundle.errors import InputError
from trundle.files.opening import exists
from trundle.maps import KeepoutMask, SpeedMask
from trundle.nav2.draft import Block
from trundle.nav2.names import KEEPOUT_FILTER, SPEED_FILTER, plain_plugin
from trundle.nav2.notes import Notes
from trundle.nav2.parameters import NodeParameters, ParameterFile

_FIELDS = {KEEPOUT_FILTER: "keepout", SPEED_FILTER: "speed_mask"}
_OPTIONS = {"keepout": "--keepout", "speed_mask": "--speed-mask"}
_UNITS: dict[int, Literal["percent", "absolute"]] = {1: "percent", 2: "absolute"}
"""The units of a mask of speeds, by the `type` that Nav2 gives them."""

UNIT_NUMBERS = {unit: number for number, unit in _UNITS.items()}


def read_filters(
    file: ParameterFile, costmaps: list[NodeParameters], given: frozenset[str], notes: Notes
) -> dict[str, object]:
    """Read the paths of the masks, for the fields `keepout` and `speed_mask` of a scenario.

    Args:
        file: The parameters.
        costmaps: The costmaps, whose filters are read.
        given: Fields that come from elsewhere, whose masks are not looked for.
        notes: Where masks are noted that the file does not name.

    Raises:
        InputError: If a mask is named that is not there, or a speed mask's own file says otherwise.
    """
    found: dict[str, object] = {}
    for costmap in costmaps:
        for name in costmap.texts("filters", ()):
            block = costmap.of_plugin(name)
            plugin = plain_plugin(block.text("plugin", ""))
            field = _FIELDS.get(plugin)
            if field is None:
                notes.ignored(block, "plugin", "this filter is not known to trundle: it is left out")
            elif _is_on(block, notes) and field not in given:
                path = _find_mask(file, block, field, notes)
                if path is not None:
                    found[field] = path
    return found


def _is_on(block: NodeParameters, notes: Notes) -> bool:
    value = block.value("enabled", True)
    if isinstance(value, str):
        notes.changed(block, "enabled", "a launch file would replace this name by true or false: true is taken")
        return True
    return block.flag("enabled", True)


def _find_mask(file: ParameterFile, block: NodeParameters, field: str, notes: Notes) -> str | None:
    topic = block.text("filter_info_topic", "").rpartition("/")[2]
    nodes = [found for found in (file.node(name) for name in file.nodes()) if found is not None]
    infos = [node for node in nodes if node.has("mask_topic") and _ends_with(node, "filter_info_topic", topic)]
    masks = [
        node
        for info in infos
        for node in nodes
        if node.has("topic_name") and _ends_with(node, "topic_name", info.text("mask_topic", "").rpartition("/")[2])
    ]
    named = [node for node in masks if node.value("yaml_filename")]
    if not infos or not named:
        advice = f"the file does not name its mask, a launch file does: give it with {_OPTIONS[field]}"
        notes.changed(block, "plugin", advice)
        return None
    path = _resolve(file, named[0], field)
    if field == "speed_mask":
        _check_speeds(infos[0], path)
    else:
        for key, usual in (("type", 0), ("base", 0.0), ("multiplier", 1.0)):
            if infos[0].value(key, usual) != usual:
                raise infos[0].wrong(key, f"must be {usual:g} for a keep-out mask")
    return path


def _ends_with(node: NodeParameters, name: str, topic: str) -> bool:
    return node.text(name, "").rpartition("/")[2] == topic


def _resolve(file: ParameterFile, server: NodeParameters, field: str) -> str:
    """Return the path of a mask: as it is given, or relative to the parameter file."""
    text = server.text("yaml_filename", "")
    place = file.path.parent / text  # an absolute path stays as it is
    if "$(" in text or not exists(place):
        raise server.wrong(
            "yaml_filename", f"is no file on this machine; correct it, or give the mask with {_OPTIONS[field]}"
        )
    return str(place)


def _check_speeds(info: NodeParameters, path: str) -> None:
    """Check that the mask's file says what its values mean, because a scenario names this file alone."""
    kind, base, multiplier = info.integer("type", 0), info.number("base", 0.0), info.number("multiplier", 1.0)
    if kind not in _UNITS:
        raise info.wrong("type", "must be 1 (percent) or 2 (m/s) for a speed mask")
    mask = SpeedMask.load(path, unit=_UNITS[kind], base=base, multiplier=multiplier)
    own = SpeedMask.load(path) if _says(path) else None
    if own is None or (own.unit, own.base, own.multiplier) != (mask.unit, mask.base, mask.multiplier):
        raise InputError(
            f"{path}: a scenario names the mask alone, so its YAML must say what {info.name} says: add the lines "
            f"type: {kind}, base: {base:g} and multiplier: {multiplier:g}, which Nav2's map server ignores"
        )


def _says(path: str) -> bool:
    from trundle.maps.ros_yaml import read_fields

    return "type" in read_fields(path).nodes


def write_filters(keepout: KeepoutMask | None, speeds: SpeedMask | None) -> tuple[Block, dict[str, Block]]:
    """Return the filters of the global costmap, and the servers of their masks."""
    filters: Block = {}
    servers: dict[str, Block] = {}
    given = (("keepout", KEEPOUT_FILTER, keepout), ("speed", SPEED_FILTER, speeds))
    for name, plugin, mask in given:
        if mask is None:
            continue
        info, topic = f"/{name}_costmap_filter_info", f"/{name}_filter_mask"
        filters[f"{name}_filter"] = {"plugin": plugin, "enabled": True, "filter_info_topic": info}
        kind, base, multiplier = 0, 0.0, 1.0
        if isinstance(mask, SpeedMask):
            kind, base, multiplier = UNIT_NUMBERS[mask.unit], mask.base, mask.multiplier
            filters[f"{name}_filter"]["speed_limit_topic"] = "/speed_limit"  # type: ignore[index]
        servers[f"{name}_filter_mask_server"] = {"topic_name": topic, "yaml_filename": f"{name}.yaml"}
        servers[f"{name}_costmap_filter_info_server"] = {
            "type": kind,
            "filter_info_topic": info,
            "mask_topic": topic,
            "base": float(base),
            "multiplier": float(multiplier),
        }
    return filters, servers
