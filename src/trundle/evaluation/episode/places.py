"""The places of episodes, kept from one episode to the next: world, robot and map, what is measured on, simulators."""

from __future__ import annotations

import json
from collections import OrderedDict
from dataclasses import dataclass, field

from trundle.control.controller import CONTROLLERS
from trundle.costmap import Costmap, CostmapSettings
from trundle.files.choice import Choice
from trundle.mission import Scenario
from trundle.mission.batch.missions import MissionBatch
from trundle.mission.batch.needs import BATCH, needs_python
from trundle.mission.fields import Assumed
from trundle.mission.metrics import TrueMaps
from trundle.mission.scenario import Setting
from trundle.mission.setup import Place, backend_of, backend_options, make_place, place_key, start_backend, wrap_backend
from trundle.navigation import Navigator
from trundle.planning.planner import PLANNERS
from trundle.planning.smoother import SMOOTHERS
from trundle.sim import Simulator
from trundle.worlds import World

MOST_PLACES = 4
MOST_CELLS = 20_000_000
"""Cells of all maps that are kept, which bounds the memory of a worker."""

_MOST_SIMULATORS = 2
"""Simulators that are kept for a place."""

_REPEATABLE = ("kinematic", BATCH, "mujoco", "physx")
"""Backends that `reset` puts back bit for bit, so that one simulator serves many episodes."""


_RECOVERY = Scenario.model_fields["recovery"].default
_OF_A_MISSION = {"start", "goal", "goals", "seed", "name", "floor_z"}
"""Fields of a scenario that differ between missions that one navigator may drive."""


def _is_own(choice: Choice) -> bool:
    """Return whether a planner, controller or smoother is one of trundle's."""
    if choice.is_python or ":" in choice.name:
        return False
    modules = [registry.module_of(choice.name) for registry in (PLANNERS, CONTROLLERS, SMOOTHERS)]
    return any(module is not None and module.startswith("trundle.") for module in modules)


@dataclass(slots=True, eq=False)
class KeptPlace:
    """A place with what episodes there share.

    Attributes:
        place: World, robot and map.
        true_maps: Maps of the world that runs are measured on.
        batch: Drives the missions of the backend "batch".
    """

    place: Place
    true_maps: TrueMaps = field(default_factory=TrueMaps)
    batch: MissionBatch = field(default_factory=MissionBatch)
    _simulators: dict[str, Simulator] = field(default_factory=dict)
    _costmaps: dict[str, Costmap] = field(default_factory=dict)
    _navigator: tuple[str, Navigator] | None = None

    def sampling_costmap(self) -> Costmap:
        """Return the costmap with default settings: missions are sampled on it, whatever a suite crosses."""
        return self.costmap(CostmapSettings())

    def costmap(self, settings: CostmapSettings, assumed: Assumed | None = None) -> Costmap:
        """Return the map as the robot sees it with these settings, and with what its software takes it for."""
        outline = None if assumed is None else assumed.footprint
        key = json.dumps([settings.model_dump(mode="json"), outline])
        if key not in self._costmaps:
            place = self.place
            robot = place.robot if assumed is None else assumed.of(place.robot)
            self._costmaps[key] = settings.make_costmap(place.grid, robot, keepout=place.keepout)
        return self._costmaps[key]

    def prepare(self, scenario: Scenario) -> Setting:
        """Prepare a scenario; for the backend `batch` with the navigator of the last one, where that is the same.

        See `Scenario.prepare` for the errors.
        """
        costmap = self.costmap(scenario.part(CostmapSettings), scenario.assumed)
        choices = (scenario.planner, scenario.controller, scenario.smoother)
        # A plug-in may keep something from one mission to the next, and is made again for each.
        is_own = all(choice is None or _is_own(choice) for choice in choices) and scenario.recovery == _RECOVERY
        if scenario.backend.name != BATCH or not is_own or needs_python(scenario):
            return scenario.prepare(self.place, costmap=costmap)
        key = scenario.model_dump_json(exclude=_OF_A_MISSION)
        kept = self._navigator[1] if self._navigator is not None and self._navigator[0] == key else None
        setting = scenario.prepare(self.place, costmap=costmap, navigator=kept)
        self._navigator = key, setting.navigator
        return setting

    def simulator(self, scenario: Scenario, world: World) -> Simulator:
        """Return a simulator for a scenario in the world of this place, or in one with more in it.

        It is one that ran before where that makes no difference.
        """
        backend = scenario.backend
        key = json.dumps([backend.name, backend_options(scenario)], sort_keys=True)
        shared = world is self.place.world
        made = self._simulators.pop(key, None) if shared else None
        if made is None:
            made = start_backend(scenario, world, self.place.robot)
        if shared and backend.name in _REPEATABLE:
            self._simulators[key] = made
            if len(self._simulators) > _MOST_SIMULATORS:
                self._simulators.pop(next(iter(self._simulators))).close()
        return wrap_backend(scenario, made)

    def release(self, simulator: Simulator) -> None:
        """Close a simulator that does not serve another episode."""
        backend = backend_of(simulator)
        if not any(backend is kept for kept in self._simulators.values()):
            simulator.close()

    def close(self) -> None:
        """Close the simulators."""
        for simulator in self._simulators.values():
            simulator.close()
        self._simulators.clear()


class Places:
    """Places that were made, the last used ones kept.

    Args:
        most_places: How many to keep.
        most_cells: How many cells the maps that are kept may have together; the last place is always kept.
    """

    def __init__(self, most_places: int = MOST_PLACES, most_cells: int = MOST_CELLS) -> None:
        self._most_places = most_places
        self._most_cells = most_cells
        self._kept: OrderedDict[str, KeptPlace] = OrderedDict()

    def __len__(self) -> int:
        return len(self._kept)

    def get(self, scenario: Scenario) -> KeptPlace:
        """Return the place of a scenario.

        Raises:
            UnknownNameError: If a name is not known; the nearest is offered.
            InputError: If a file or an option cannot be used.
        """
        key = place_key(scenario)
        kept = self._kept.pop(key, None) or KeptPlace(make_place(scenario))
        self._kept[key] = kept
        while len(self._kept) > 1 and (len(self._kept) > self._most_places or self._cells() > self._most_cells):
            self._kept.popitem(last=False)[1].close()
        return kept

    def _cells(self) -> int:
        return sum(kept.place.grid.data.size for kept in self._kept.values())
