"""`World`: named solids on a floor at z = 0, and what moves among them."""

from __future__ import annotations

import inspect
import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np

from trundle.errors import WorldError
from trundle.geometry import FloatArray
from trundle.geometry.solids import Solid, solids_bounds
from trundle.maps import OccupancyGrid
from trundle.registry import Registry
from trundle.values import check_kind
from trundle.worlds.movers import Crowd, Mover
from trundle.worlds.options import Unknown

WORLDS: Registry[World] = Registry(
    "world",
    "trundle.worlds",
    {
        "corridors": "trundle.worlds.generators.corridors:generate_corridors",
        "cylinders": "trundle.worlds.generators.cylinders:generate_cylinders",
        "lot": "trundle.worlds.generators.lot:generate_lot",
        "maze": "trundle.worlds.generators.maze:generate_maze",
        "office": "trundle.worlds.generators.office:generate_office",
        "warehouse": "trundle.worlds.generators.warehouse:generate_warehouse",
    },
)


@dataclass(frozen=True, slots=True)
class World:
    """Solids on a floor, the plane z = 0 of the map frame. Besides the robot only the movers move.

    Attributes:
        name: For messages, pictures and folder names.
        solids: The solids; names are unique.
        seeds: Points (x, y) [m] that are known to be free and reachable, where a map's flood fill may start.
        ground_z: Height [m] of the infinite ground plane that its file declares, the lowest possible floor; None if the
            file declares none. If it is not 0, `worlds.floors.lower_world` moves it there.
        movers: What moves on the floor: `Mover`s and `Crowd`s. Maps leave them out. Names are unique among movers, the
            members of crowds and solids.

    Raises:
        WorldError: If two solids or movers have the same name.
    """

    name: str
    solids: tuple[Solid, ...]
    seeds: tuple[tuple[float, float], ...] = ()
    ground_z: float | None = None
    movers: tuple[Mover | Crowd, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "solids", tuple(self.solids))
        object.__setattr__(self, "movers", tuple(self.movers))
        seen: set[str] = set()
        for solid in self.solids:
            if solid.name in seen:
                raise WorldError(f"world {self.name!r} has two solids named {solid.name!r}")
            seen.add(solid.name)
        for mover in self.movers:
            check_kind(mover, (Mover, Crowd), f"a mover of the world {self.name!r}", "see trundle.worlds.movers")
            for name in mover.members if isinstance(mover, Crowd) else (mover.name,):
                if name in seen:
                    raise WorldError(f"world {self.name!r} has two solids or movers named {name!r}")
                seen.add(name)

    @classmethod
    def generate(cls, name: str, /, *, seed: int = 0, exclude: str | Sequence[str] = (), **options: Any) -> World:
        """Generate a built-in world, e.g. `World.generate("warehouse", seed=7, aisle_width=1.6)`.

        Args:
            name: Name of the generator.
            seed: Seed of its random numbers.
            exclude: What to leave out, as in `load`.
            **options: Options of the generator.

        Raises:
            UnknownNameError: If there is no such world; the nearest name is offered.
            InputError: If an option is unknown (the nearest is offered) or a value is out of range.

        Warns:
            WorldWarning: About words of `exclude` that match nothing.
        """
        from trundle.worlds.leave_out import leave_out
        from trundle.worlds.options import check_options

        make = cast("Any", WORLDS.load(name))
        known = world_options(name)
        if known is not None:
            check_options(f"world {name!r}", "this world", options, [*known, "exclude"])
        made = cast("World", make(seed=seed, **options))
        return leave_out(made, exclude, f"world {name!r}") if exclude else made

    @classmethod
    def load(
        cls,
        path: str | os.PathLike[str],
        /,
        *,
        exclude: str | Sequence[str] = (),
        floor_z: float | None = None,
        trusted: bool | None = None,
        time_limit_s: float | None = None,
        memory_limit_gb: float | None = None,
        **options: Any,
    ) -> World:
        """Read a world from a file, by its suffix.

        All formats but maps and JSON are read in a separate process, because a bad file may crash or block the reader.

        | suffix | what | options (see the loader) |
        | --- | --- | --- |
        | .sdf, .world, .sdf.xacro | Gazebo's SDF 1.2 to 1.12 | `worlds.gazebo.load.load_sdf` |
        | .xml, .mjcf, .urdf | MuJoCo's MJCF, and URDF; fixed geometry | `worlds.mjcf.load_mjcf` |
        | .glb, .gltf, .obj, .stl, .ply, .dae | meshes | `worlds.meshes.load_mesh` |
        | .yaml, .yml, .map | a ROS or MovingAI map as walls | `worlds.from_map.load_map` |
        | .json | DynaBARN's moving cylinders | `worlds.dynabarn.load_dynabarn` |
        | .usd, .usda, .usdc, .usdz | OpenUSD, Isaac Sim's scenes | `worlds.usd.load_usd` |

        Args:
            path: The file.
            exclude: What to leave out, as a sequence, or one text with commas: names of solids or of groups above them
                (`/World/Robot`, `shelf::board`), with `*` and `?` as wildcards; kinds, which in USD are semantic
                labels; and `floor` (solids that end within 1 cm above z = 0) and `ceiling` (solids that start above
                2 m and are wider than high).
            floor_z: Height of the floor in the file [m]: the world is moved down by it, so that the floor is at z = 0
                as in every world. By default it stays; `worlds.floors.find_floor` finds the floor under a robot.
            trusted: Read the file in this process, without limits. If None, TRUNDLE_TRUSTED (0 or 1) decides.
            time_limit_s: Time limit for reading [s]. If None, it is TRUNDLE_READ_SECONDS, or 20.
            memory_limit_gb: Memory limit for reading, if the system supports one (Linux) [GB]. If None, it is
                TRUNDLE_READ_GIGABYTES, or 2.
            **options: Options of the loader.

        Raises:
            WorldError: If the file is missing, of another kind, or cannot be used; the message says which part of it.
                If it takes too much time or memory, or crashes the reader.
            MapError: If a map cannot be used.
            InputError: If the file's loader does not have an option, or its value is out of range.
            MissingExtraError: If the library that reads this kind of file is not installed.

        Warns:
            WorldWarning: If parts were left out, `exclude` matches nothing, or the world is empty or so large that its
                unit must be wrong.
        """
        from trundle.guard import read_limits
        from trundle.worlds.load import load_world

        limits = read_limits(trusted=trusted, time_limit_s=time_limit_s, memory_limit_gb=memory_limit_gb)
        return cast("World", load_world(path, limits=limits, exclude=exclude, floor_z=floor_z, **options))

    @classmethod
    def from_map(
        cls, grid: OccupancyGrid | str | os.PathLike[str], *, height: float = 1.0, unknown: Unknown = "solid"
    ) -> World:
        """Extrude a map into walls.

        Args:
            grid: A grid, or the path of a ROS map YAML.
            height: Height of the walls [m].
            unknown: Treat unknown cells as "solid" (a robot must not drive there) or "free".
        """
        from trundle.worlds.walls import extrude

        return cls(*extrude(grid, height=height, unknown=unknown))

    def __repr__(self) -> str:
        return f"World({self.name!r}, {self._size_text()})"

    def _size_text(self) -> str:
        low, high = self.bounds
        wide, deep, tall = (f"{side:.4g}" for side in high - low)
        count = len(self.solids)
        moving = sum(mover.count if isinstance(mover, Crowd) else 1 for mover in self.movers)
        movers = f", {moving} mover{'' if moving == 1 else 's'}" if moving else ""
        return f"{count} solid{'' if count == 1 else 's'}{movers}, {wide} x {deep} x {tall} m"

    def _repr_png_(self) -> bytes:
        """Show a picture from above in notebooks, with north up and without solids that start above 2 m."""
        from trundle.pictures.figure import to_png
        from trundle.worlds.picture import draw_world

        lines = [self._size_text()]
        return to_png(draw_world(self.solids, self.seeds, f"World {self.name}", lines, movers=self.movers))

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Axis-aligned bounds (low, high) [m] of all solids, each of shape (3,); zeros for an empty world."""
        if not self.solids:
            return np.zeros(3), np.zeros(3)
        lows, highs = solids_bounds(self.solids)
        return lows.min(axis=0), highs.max(axis=0)


def world_names() -> list[str]:
    """Return the names that `World.generate` takes, sorted."""
    return WORLDS.names()


def world_options(name: str) -> tuple[str, ...] | None:
    """Return the options of a generator, without its seed; None where it takes any.

    Raises:
        UnknownNameError: If there is no such world; the nearest name is offered.
    """
    parameters = inspect.signature(cast("Any", WORLDS.load(name))).parameters.values()
    if any(parameter.kind is inspect.Parameter.VAR_KEYWORD for parameter in parameters):
        return None
    return tuple(parameter.name for parameter in parameters if parameter.name != "seed")
