"""Warnings about motions that leave the world, pass through solids, or start on the robot."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence

import numpy as np

from trundle.errors import WorldWarning
from trundle.geometry import FloatArray, Footprint
from trundle.sim.footprint import FootprintChecker
from trundle.sim.state import Contact
from trundle.worlds import World
from trundle.worlds.movers.mover import Mover, outline_of, top_of

_STEP_S = 0.1
_MOST_STEPS = 2000
_LONGEST_S = 600.0
_FLOOR_TOP = 0.05  # what is not higher is no obstacle [m]


def warn_of_motions(world: World, movers: Sequence[Mover]) -> None:
    """Warn once for every mover that leaves the world or passes through a solid, with when and where.

    Its motion is sampled ten times a second, over ten minutes at most.
    """
    if not world.solids:
        return
    low, high = world.bounds
    for mover in movers:
        if mover.may_cross:
            continue
        times = _times(mover)
        states = np.array([mover.motion.at(time) for time in times])
        text = _leaving(times, states, low, high) or _crossing(times, states, mover, world)
        if text:
            warnings.warn(f"the mover {mover.name!r} of the world {world.name!r} {text}", WorldWarning, stacklevel=4)


def warn_of_start(movers: Sequence[Mover], contacts: Sequence[Contact]) -> None:
    """Warn of movers that touch the robot at the start of a run."""
    names = {mover.name for mover in movers}
    for contact in contacts:
        if contact.other in names:
            warnings.warn(
                f"the mover {contact.other!r} is on the robot at 0 s, at ({contact.x:.2f}, {contact.y:.2f}); let it "
                "start elsewhere, or later",
                WorldWarning,
                stacklevel=4,
            )


def _times(mover: Mover) -> list[float]:
    last = min(mover.motion.duration, _LONGEST_S)
    count = min(_MOST_STEPS, max(1, math.ceil(last / _STEP_S)))
    return np.linspace(0.0, last, count + 1).tolist()


def _leaving(times: Sequence[float], states: FloatArray, low: FloatArray, high: FloatArray) -> str:
    outside = ((states[:, :2] < low[:2]) | (states[:, :2] > high[:2])).any(axis=1)
    if not outside.any():
        return ""
    first = int(np.argmax(outside))
    x, y = states[first, :2].tolist()
    does = "starts outside it" if first == 0 else "leaves it"
    return (
        f"{does} at {times[first]:.1f} s, at ({x:.2f}, {y:.2f}): its solids reach from ({low[0]:.2f}, {low[1]:.2f}) to "
        f"({high[0]:.2f}, {high[1]:.2f})"
    )


def _crossing(times: Sequence[float], states: FloatArray, mover: Mover, world: World) -> str:
    outline = outline_of(mover.parts)
    middle = outline.mean(axis=0)
    checker = FootprintChecker.of(world.solids, Footprint(outline - middle), _FLOOR_TOP, top_of(mover.parts))
    cos, sin = np.cos(states[:, 2]), np.sin(states[:, 2])
    poses = np.column_stack(
        [
            states[:, 0] + cos * middle[0] - sin * middle[1],
            states[:, 1] + sin * middle[0] + cos * middle[1],
            states[:, 2],
        ]
    )
    for time, pose in zip(times, poses, strict=True):
        found = checker.find(pose[None])
        if found:
            does = "starts in" if time == 0.0 else "passes through"
            return f"{does} {found[0].other!r} at {time:.1f} s, at ({pose[0]:.2f}, {pose[1]:.2f})"
    return ""
