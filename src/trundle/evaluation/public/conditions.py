"""`Conditions`: with what, and under which errors, a public benchmark is driven; and its robots."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from trundle.errors import InputError
from trundle.files.choice import Choice
from trundle.files.writing import write_text
from trundle.robots import Robot, is_robot_file
from trundle.robots.parts import Lidar, Limits

TIME_LIMIT_S = 100.0
ARRIVAL_RADIUS = 1.0
"""Both benchmarks end a run after this time [s], and at this distance from the goal [m]."""

DRIFT = {"walk": 0.005, "heading_walk": 0.005}
"""Random walk of the odometry [m/√m, rad/√m]."""

BEAMS, FIELD_OF_VIEW, RANGE, RATE = 720, 1.5 * math.pi, 10.0, 20.0
"""BARN's lidar. The robot uses 10 m of its 30 m, and 20 of its 50 scans a second."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Conditions:
    """What drives in a benchmark, and what it has to live with.

    Attributes:
        robots: Names or files.
        seeds: Seeds of the runs in each world, as in a suite.
        planners: Planners by name, or with options.
        controllers: Controllers by name, or with options.
        backends: Simulators, likewise.
        drift: Whether the robot only has odometry that drifts, by 5 mm and 5 mrad per √m; otherwise its true pose.
        scan_age_s: Age of the scans when they arrive [s].
        command_delay_s: Delay of the commands [s].
        collision_monitor: Whether every command passes a collision monitor.
    """

    robots: Sequence[str] = ("jackal",)
    seeds: int | str | Sequence[int] = 10
    planners: Sequence[str | Choice] = ("auto",)
    controllers: Sequence[str | Choice] = ("regulated_pure_pursuit",)
    backends: Sequence[str] = ("mujoco",)
    drift: bool = True
    scan_age_s: float = 0.0
    command_delay_s: float = 0.0
    collision_monitor: bool = True

    def suite_fields(self) -> dict[str, Any]:
        """Return the fields of a suite that they decide, and those that are the same in both benchmarks.

        Only the time limit ends a run without a contact, so the robot does not give up earlier.
        """
        fields: dict[str, Any] = {
            "robots": self.robots,
            "planners": self.planners,
            "controllers": self.controllers,
            "backends": self.backends,
            "lidar": True,
            "known_map": False,
            "rules": {"arrival_radius": ARRIVAL_RADIUS, "every_contact": True},
            "movement_time_allowance": TIME_LIMIT_S,
            "patience_s": TIME_LIMIT_S,
            "limits": {"time_limit_s": TIME_LIMIT_S},
        }
        if not self.collision_monitor:
            fields["collision_monitor"] = False
        if self.drift:
            fields |= {"odometry": DRIFT, "localizer": "odometry"}
        if self.scan_age_s or self.command_delay_s:
            fields["latency"] = {"scan_age_s": self.scan_age_s, "command_delay_s": self.command_delay_s}
        return fields


def benchmark_robot(base: str, *, speed: float, noise: float) -> dict[str, Any]:
    """Return the YAML of a robot with BARN's lidar.

    Args:
        base: Robot that it builds on, by its catalogue name or file.
        speed: Its largest speed forwards and backwards [m/s].
        noise: Standard deviation of its lidars' ranges [m].

    Raises:
        InputError: If there is no such robot, it has no lidar, or a number is out of range; the message names it.
    """
    robot = Robot.load(base)
    if not robot.lidars:
        raise InputError(f"the robot {robot.name} has no lidar, and these benchmarks give no map: choose another one")
    limits = {"linear_speed": speed, "reverse_speed": speed}
    seen = {"beams": BEAMS, "fov": FIELD_OF_VIEW, "range_max": RANGE, "rate": RATE, "noise": noise}
    Limits(**{**robot.limits.model_dump(), **limits})
    for lidar in robot.lidars.values():
        Lidar(**{**lidar.model_dump(), **seen})
    return {
        "base": str(Path(base).resolve()) if is_robot_file(base) else base,
        "name": f"{robot.name}_{speed:g}mps",
        "limits": limits,
        "lidars": {name: dict(seen) for name in robot.lidars},
    }


def write_robot(folder: str | os.PathLike[str], settings: Mapping[str, Any]) -> str:
    """Write a robot's settings into a folder as the YAML of its name, and return its path.

    Raises:
        OutputError: If it cannot be written.
    """
    path = Path(folder) / f"{settings['name']}.yaml"
    write_text(path, yaml.safe_dump(dict(settings), sort_keys=False))
    return str(path)
