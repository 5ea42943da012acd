"""Queries between two poses: their checks, where they start and end, and the base of the planners that answer them."""
