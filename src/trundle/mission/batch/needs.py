"""`needs_python`: what of a scenario the kernel of missions does not have."""

from __future__ import annotations

from trundle.geometry.solids import Mesh
from trundle.mission.fields import MapOptions, ScenarioFields
from trundle.mission.goal_fields import make_goal
from trundle.navigation.goal_queue import tasks_of
from trundle.worlds import World
from trundle.worlds.movers.crowd import Crowd

BATCH = "batch"
"""The backend of a suite whose missions are driven by the kernel."""

NAVIGATOR = "navigator"
"""The agent that drives where none is chosen."""

CONTROLLERS = ("regulated_pure_pursuit", "mppi")
"""Those that drive there."""

_NOT_SET = (
    "localizer",
    "speed_mask",
    "assumed",
    "map_errors",
    "actuation",
    "latency",
    "odometry",
    "lidar_errors",
    "start_error",
    "rules",
    "directives",
    "through",
    "replan_interval_s",
)
"""Fields that a scenario for the kernel does not have: with each of them more happens than following one path."""


def needs_python(scenario: ScenarioFields) -> tuple[str, ...]:
    """Return what of a scenario has to be driven step by step in Python, by field; nothing where all of it need not."""
    needs = [name for name in _NOT_SET if getattr(scenario, name)]
    agent = scenario.agent
    if agent is not None and (agent.is_python or agent.name != NAVIGATOR or agent.options):
        needs.insert(0, f"agent {agent.short_name}")
    if scenario.controller.is_python or scenario.controller.name not in CONTROLLERS:
        needs.insert(0, f"controller {scenario.controller.short_name}")
    if scenario.backend.options:
        needs.append("options of the backend")
    obstacle = scenario.layers.obstacle if scenario.layers is not None else None
    if obstacle is not None and obstacle.doubt_static:  # it works without lidars, too
        needs.append("layers: doubt_static")
    needs += _needed_by_lidars(scenario)
    goals = scenario.goals or ()
    if len(goals) > 1 or any(tasks_of(make_goal(goal)) for goal in goals):
        needs.append("several goals or tasks")
    walls = scenario.map_options or MapOptions()
    if walls.unknown == "solid" and scenario.unknown != "blocked":
        needs.append("map_options: unknown solid where the robot may drive")
    return tuple(needs)


def _needed_by_lidars(scenario: ScenarioFields) -> list[str]:
    """Return what of a scenario's lidars is not known beforehand to make no difference."""
    if not scenario.lidar:
        return ["collision_monitor without lidars"] if scenario.collision_monitor else []
    needs: list[str] = []
    if scenario.movers:
        needs.append("movers that lidars see")
    if not scenario.known_map:
        needs.append("known_map: false")
    if scenario.unknown != "blocked":
        needs.append(f"lidars where unknown is {scenario.unknown}")
    layers = scenario.layers
    if layers is not None and layers.rolling_window:
        needs.append("layers: rolling_window")
    if layers is not None and layers.obstacle is not None and layers.obstacle.clear_static:
        needs.append("layers: clear_static")
    return needs


def world_needs_python(world: World) -> str:
    """Return what of a world has to be simulated in Python; empty where nothing has.

    The kernel looks for contacts in the cells of the map, which hold all of a solid, but not of a mesh's hull. A drive
    that is repeated differs in its last digits, and a crowd that sees the robot makes other steps of that in time.
    """
    if any(isinstance(solid.shape, Mesh) for solid in world.solids):
        return "the world has meshes"
    if any(isinstance(mover, Crowd) and mover.sees_robot for mover in world.movers):
        return "a crowd that sees the robot"
    return ""
