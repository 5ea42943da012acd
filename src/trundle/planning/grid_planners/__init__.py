"""Planners that search the grid for a point, most of which then fit the footprint along its path."""
