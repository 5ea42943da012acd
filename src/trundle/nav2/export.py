"""`export_nav2`: a folder with which Nav2 drives a robot as trundle does."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import yaml

from trundle.errors import InputError
from trundle.files.writing import make_folder, write_text
from trundle.maps import KeepoutMask, OccupancyGrid, SpeedMask
from trundle.maps.ros_writer import choose_mode, save_map
from trundle.messages.codec import DEFAULT, DISTROS, Distro
from trundle.mission import Scenario
from trundle.mission.setup import Place, make_place
from trundle.nav2.controllers import write_controllers
from trundle.nav2.costmaps import write_costmaps
from trundle.nav2.draft import Block, Draft, note_leftovers
from trundle.nav2.filters import UNIT_NUMBERS
from trundle.nav2.launch import launch_text
from trundle.nav2.monitor import monitor_of, write_monitor
from trundle.nav2.planners import write_planners
from trundle.nav2.remarks import Remark, describe_remarks
from trundle.nav2.servers import write_servers

PARAMS, LAUNCH, REMARKS = "nav2_params.yaml", "nav2.launch.py", "no_counterpart.txt"
MAP, KEEPOUT, SPEED = "map.yaml", "keepout.yaml", "speed.yaml"
"""Files of an export: the map and the masks each have their image beside them."""

_COSTMAPS = ("local_costmap", "global_costmap")


@dataclass(frozen=True, slots=True)
class Nav2Export:
    """What was written.

    Attributes:
        folder: The folder.
        files: The names of the files in it.
        remarks: Every setting that means something else in Nav2, or has no counterpart.
    """

    folder: Path
    files: tuple[str, ...]
    remarks: tuple[Remark, ...]


def export_nav2(scenario: Scenario, folder: str | os.PathLike[str], *, distro: Distro = DEFAULT) -> Nav2Export:
    """Write a scenario's settings as Nav2's parameters, with the map, the masks and a launch file.

    `no_counterpart.txt` has the remarks, one on a line. Files of these names in the folder are replaced.

    Args:
        scenario: The scenario.
        folder: The folder; it is created.
        distro: The distribution whose names are written.

    Raises:
        UnknownNameError: If the scenario names a robot or a world that is not known.
        InputError: If a file or an option of the scenario cannot be used, or there is no such distribution.
        OutputError: If the folder cannot be written to.
    """
    if distro not in DISTROS:
        raise InputError(f"distro is one of {', '.join(DISTROS)}; got {distro!r}")
    place = make_place(scenario)
    draft = draft_params(scenario, place, distro)
    target = make_folder(folder)
    masks = _write_maps(target, scenario, place.grid, place.keepout, place.speed_mask)
    launch = launch_text(
        LAUNCH,
        draft.robot.name,
        distro,
        masks=masks,
        has_map=scenario.known_map,
        has_monitor=monitor_of(draft) is not None,
    )
    lines = describe_remarks(draft.remarks) or ["everything has a counterpart"]
    write_text(target / LAUNCH, launch)
    write_text(target / REMARKS, "\n".join(lines) + "\n")
    write_text(target / PARAMS, params_text(draft))
    files = [PARAMS, *([MAP] if scenario.known_map else []), *(f"{mask}.yaml" for mask in masks), LAUNCH, REMARKS]
    return Nav2Export(target, tuple(files), tuple(draft.remarks))


def draft_params(scenario: Scenario, place: Place, distro: Distro) -> Draft:
    """Make the parameters for a scenario in its place; see `export_nav2` for the errors."""
    draft = Draft(scenario, scenario.assumed_robot(place.robot), distro)
    _check_lidars(draft)
    write_controllers(draft)
    write_planners(draft)
    write_costmaps(draft, place.grid, place.keepout, place.speed_mask)
    write_servers(draft)
    write_monitor(draft)
    note_leftovers(draft)
    return draft


def params_text(draft: Draft) -> str:
    """Return the text of the parameter file: each costmap stands in a namespace named like itself, as Nav2 has it."""
    nodes: dict[str, object] = {}
    for name, parameters in draft.nodes.items():
        block: Block = {"ros__parameters": parameters}
        nodes[name] = {name: block} if name in _COSTMAPS else block
    robot = " ".join(draft.robot.name.split())
    head = (
        f"# Nav2's parameters for ROS 2 {draft.distro.capitalize()}, written by trundle for {robot}.\n"
        f"# {REMARKS} lists what Nav2 does differently, and what it does not have.\n"
    )
    return head + yaml.dump(nodes, Dumper=_Dumper, sort_keys=False, default_flow_style=False, width=1000)


class _Dumper(yaml.SafeDumper):
    """Writes lists of plain values on one line, and nothing as an alias, which ROS does not read."""

    def ignore_aliases(self, data: object) -> bool:
        return True

    def represent_sequence(self, tag: str, sequence: object, flow_style: bool | None = None) -> yaml.SequenceNode:
        return super().represent_sequence(tag, sequence, flow_style=True)  # type: ignore[arg-type]


def _check_lidars(draft: Draft) -> None:
    for name in draft.lidars:
        if name not in draft.robot.lidars:
            lidars = ", ".join(draft.robot.lidars) or "none"
            raise InputError(f"{draft.robot.name} has no lidar {name!r}; it has: {lidars}")


def _write_maps(
    folder: Path, scenario: Scenario, grid: OccupancyGrid, keepout: KeepoutMask | None, speeds: SpeedMask | None
) -> list[str]:
    """Write the map and the masks, and return the names of the masks."""
    if scenario.known_map:
        grid.save(folder / MAP, mode=choose_mode(grid))
    masks: list[str] = []
    if keepout is not None:
        keepout.grid.save(folder / KEEPOUT, mode=choose_mode(keepout.grid))
        masks.append("keepout")
    if speeds is not None:
        path = folder / SPEED
        kind, base, multiplier = UNIT_NUMBERS[speeds.unit], float(speeds.base), float(speeds.multiplier)
        own = f"type: {kind}\nbase: {base!r}\nmultiplier: {multiplier!r}\n"
        save_map(speeds.grid, path, mode=choose_mode(speeds.grid), more=own)
        masks.append("speed")
    return masks
