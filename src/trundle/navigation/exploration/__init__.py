"""Exploration: where unknown space begins, and an agent that drives there until nothing is left to see."""

from trundle.navigation.exploration.explorer import Explorer
from trundle.navigation.exploration.frontiers import ExplorerSettings, Frontier, GivenUp, find_frontiers

__all__ = ["Explorer", "ExplorerSettings", "Frontier", "GivenUp", "find_frontiers"]
