"""Parts of USD scenes, and values of the solids that are read from them."""

import numpy as np

from trundle.geometry.solids import Mesh

HEAD = '#usda 1.0\n(\n    metersPerUnit = 1\n    upAxis = "Z"\n)\n'
UNIT = "double size = 1"
TETRA = """
    point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    int[] faceVertexCounts = [3, 3, 3, 3]
    int[] faceVertexIndices = [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3]
"""


def only(world):
    """The one solid of a world."""
    (solid,) = world.solids
    return solid


def extent(solid):
    """Bounds of a solid [m]: low x, y, z and high x, y, z."""
    low, high = solid.bounds()
    return tuple(np.round(np.concatenate([low, high]), 6))


def volume(mesh: Mesh) -> float:
    """Volume [m³] of a closed mesh; negative if its faces look inward."""
    a, b, c = np.moveaxis(mesh.vertices[mesh.faces], 1, 0)
    return float((np.cross(a, b) * c).sum() / 6.0)


def named(world):
    """Solids by name."""
    return {solid.name: solid for solid in world.solids}
