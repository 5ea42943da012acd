"""Costmaps: how dear each cell is for one robot, and whether its footprint touches something."""

from trundle.costmap.costmap import FREE_SPACE, INSCRIBED, LETHAL, NO_INFORMATION, Costmap

__all__ = ["FREE_SPACE", "INSCRIBED", "LETHAL", "NO_INFORMATION", "Costmap"]
