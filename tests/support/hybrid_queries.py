"""Kinds of motions for hybrid A*, and walls to drive around."""

from support.swept import room

KINDS = [
    {},
    {"in_place": True},
    {"motion_model": "dubins"},
    {"motion_model": "dubins", "in_place": True},
    {"in_place": True, "minimum_turning_radius": 0.0},
]
WALLS = room(10, 6, (4, 0, 4.3, 4.6), (6.5, 1.6, 6.8, 6))
