"""What a page may choose, and the scenario of its choice."""

from __future__ import annotations

from trundle.control.controller import controller_names
from trundle.errors import InputError
from trundle.mission import Scenario
from trundle.planning.planner import planner_names
from trundle.robots import robot_names
from trundle.serve.page_messages import Preview, Setup
from trundle.worlds import world_names

_OF_A_PLACE = {
    "map": None,
    "map_options": None,
    "compat": None,
    "keepout": None,
    "speed_mask": None,
    "floor_z": None,
    "start": None,
    "goal": None,
    "goals": None,
    "unmapped": None,
    "map_errors": None,
    "movers": (),
}
"""Fields of a scenario that make no sense in another world, with their defaults."""


class Choices:
    """The names that a page may choose from. Files come from the command line alone.

    Args:
        base: The scenario that the choices change; None if there is nothing to choose.

    Attributes:
        worlds: Names of worlds, that of the scenario first.
        robots: Names of robots, that of the scenario first; and so on.
    """

    def __init__(self, base: Scenario | None) -> None:
        self.worlds: list[str] = []
        self.robots: list[str] = []
        self.planners: list[str] = []
        self.controllers: list[str] = []
        if base is None:
            return
        self.worlds = _with_first(place_of(base), world_names())
        self.robots = _with_first(base.robot, robot_names())
        self.planners = _with_first(base.planner.name, planner_names())
        self.controllers = _with_first(base.controller.name, controller_names())

    def as_dict(self) -> dict[str, list[str]]:
        """Return the choices as the page gets them."""
        return {name: list(getattr(self, name)) for name in ("worlds", "robots", "planners", "controllers")}

    def check(self, message: Setup | Preview) -> None:
        """Check that all names of a message are among the choices.

        Raises:
            InputError: If one is not.
        """
        for kind in ("world", "robot", "planner", "controller"):
            name = getattr(message, kind, None)
            if name is not None and name not in getattr(self, f"{kind}s"):
                choices = ", ".join(getattr(self, f"{kind}s"))
                raise InputError(f"{kind} {name!r} is not among the choices of this server: {choices}")


def place_of(scenario: Scenario) -> str:
    """Return the name of a scenario's world, or its map."""
    return (scenario.map or "") if scenario.world is None else scenario.world.name


def choose(base: Scenario, message: Setup | Preview) -> Scenario:
    """Return the scenario of a page's choice, whose names were checked.

    Raises:
        ScenarioError: If it cannot be used.
    """
    settings = base.model_dump()
    if message.world is not None and message.world != place_of(base):
        settings |= {**_OF_A_PLACE, "world": message.world}
    if message.robot is not None:
        settings["robot"] = message.robot
    if message.seed is not None:
        settings["seed"] = message.seed
    if isinstance(message, Setup):
        settings |= _of_setup(base, message)
    return Scenario.make(**settings)


def _of_setup(base: Scenario, message: Setup) -> dict[str, object]:
    chosen: dict[str, object] = {}
    for kind, before in (("planner", base.planner), ("controller", base.controller)):
        name = getattr(message, kind)
        if name is not None and name != before.name:
            chosen[kind] = name
    if message.start is not None:
        chosen["start"] = message.start
    if message.goal is not None:
        x, y, yaw = message.goal
        chosen |= {"goal": (x, y) if yaw is None else (x, y, yaw), "goals": None}
    return chosen


def _with_first(name: str, names: list[str]) -> list[str]:
    return [name, *(other for other in names if other != name)]
