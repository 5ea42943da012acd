"""Worlds: named solids on a floor, generated, loaded or extruded from a map."""

from trundle.worlds.world import World, world_names

__all__ = ["World", "world_names"]
