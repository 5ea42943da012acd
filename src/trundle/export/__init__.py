"""Worlds and robots as files of other programs: MJCF, USD, SDF, GLB, URDF, and a world's map."""

from trundle.export.formats import FORMATS, export_robot, export_world, format_of

__all__ = ["FORMATS", "export_robot", "export_world", "format_of"]
