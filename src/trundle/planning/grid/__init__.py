"""Searches over the cells of a grid: shortest paths, reachable cells and fields of costs."""
