"""The places of episodes, kept from one episode to the next: world, robot and map, what is measured on, simulators."""

from __future__ import annotations

import json
from collections import OrderedDict
from dataclasses import dataclass, field

from trundle.costmap import Costmap, CostmapSettings
from trundle.mission import Scenario
from trundle.mission.batch import MissionBatch
from trundle.mission.fields import Assumed
from trundle.mission.metrics import TrueMaps
from trundle.mission.place import Place, make_place, place_key
from trundle.mission.simulation import backend_of, backend_options, start_backend, wrap_backend
from trundle.sim import Simulator
from trundle.worlds import World

MOST_PLACES = 4
MOST_CELLS = 20_000_000
"""Cells of all maps that are kept, which bounds the memory of a worker."""

_MOST_SIMULATORS = 2
"""Simulators that are kept for a place."""

_REPEATABLE = ("kinematic", "batch", "mujoco", "physx")
"""Backends that `reset` puts back bit for bit, so that one simulator serves many episodes."""


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
