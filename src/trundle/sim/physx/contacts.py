"""The robot's contacts in PhysX, by name."""

from __future__ import annotations

from trundle.sim.footprint import CellNames
from trundle.sim.physx.attachment import Attachment
from trundle.sim.physx.scene import ROBOT, Scene
from trundle.sim.state import Contact
from trundle.worlds import World

FLOOR_BAND = 0.02
"""In somebody else's stage contacts up to this far above the lowest one [m] are with the floor."""

_CHASSIS = "chassis"


class ContactReader:
    """Reads contacts of the robot with everything but the floor.

    Solids have the names of the world that trundle wrote, or their prims' paths in any other stage.

    Args:
        scene: The stage.
        world: Used for the names of cells.
    """

    def __init__(self, scene: Scene, world: World) -> None:
        self._scene = scene
        self._floor: float | None = None
        self._added: dict[str, str] = {}
        self._labels: dict[str, str] = {}
        self._chassis = scene.root.rpartition("/")[2]
        self.change_world(world, {})

    def change_world(self, world: World, added: dict[str, str]) -> None:
        """Name the cells of another world from now on, and the solids that were added to the stage, by path."""
        self._cells = CellNames(world)
        self._added = added
        self._labels.clear()

    def attached(self) -> None:
        """Forget handles, which another attachment may give to other prims, and the floor: it is below the start."""
        self._harmless: set[int] = set()
        self._floor = None if self._scene.knows_floor else self._scene.height

    def find_floor(self, attachment: Attachment) -> None:
        """Take the lowest contact of the robot at rest as the height of the floor, if the stage does not tell it."""
        if not self._scene.knows_floor:
            heights = [float(points[:, 2].min()) for _, _, points in attachment.contacts()]
            self._floor = min(heights, default=0.0)

    def read(self, attachment: Attachment, touched: dict[tuple[str, str], Contact]) -> None:
        """Add the robot's current contacts to `touched`, by part and solid; the first position of each pair is kept."""
        colliders = attachment.touched_colliders()
        if colliders <= self._harmless:
            return
        lowest = -float("inf") if self._floor is None else self._floor + FLOOR_BAND
        for body, collider, points in attachment.contacts():
            if collider in self._harmless:
                continue
            path = attachment.path(collider)
            if self._is_harmless(path, lowest):
                self._harmless.add(collider)
                continue
            above = points[points[:, 2] > lowest]
            part = self._part(body)
            for x, y in above[:, :2].tolist():
                # All cells of a map are one collider.
                name = self._cells.name(self._name(path), x, y)
                touched.setdefault((part, name), Contact(part, name, x, y))

    def _is_harmless(self, path: str, lowest: float) -> bool:
        """Whether a collider is the robot's own, or lies below the height at which contacts count."""
        if path == ROBOT or path.startswith(f"{ROBOT}/"):
            return True
        return self._floor is not None and self._scene.top(path) <= lowest

    def _part(self, body: str) -> str:
        name = body.rpartition("/")[2]
        return _CHASSIS if name == self._chassis and self._scene.knows_floor else name

    def _name(self, path: str) -> str:
        if path not in self._labels:
            self._labels[path] = self._added.get(path) or self._scene.name(path)
        return self._labels[path]
