"""Worlds, robots and scenarios as files of other programs: MJCF, SDF, USD, GLB, URDF, a map, a script for Isaac Sim."""

from trundle.export.formats import FORMATS, Kind, export_robot, export_scene, export_world, format_of
from trundle.export.plain import Scene

__all__ = ["FORMATS", "Kind", "Scene", "export_robot", "export_scene", "export_world", "format_of"]
