"""`MoverRecording`: where the movers of a world are, recorded once for all robots of a batch; crowds may be live."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple, Self

import numpy as np

from trundle.errors import InputError
from trundle.geometry import FloatArray, Pose2D
from trundle.geometry.solids import Cylinder, Solid
from trundle.robots import Robot
from trundle.sim.movers import MoverField
from trundle.values import as_array, check_kind, check_number
from trundle.worlds import World
from trundle.worlds.movers.crowd import Crowd
from trundle.worlds.movers.mover import Mover, outline_of, radius_of
from trundle.worlds.movers.walk import PERIOD_S, CrowdWalk

_MOST_SAMPLES = 10_000_000
_FAR_AWAY = Pose2D(1e5, 1e5)
"""Where the robot is while a crowd is recorded: no walker sees it."""


class LiveCrowds(NamedTuple):
    """Crowds that are computed for each robot by itself, and see it.

    Attributes:
        walk: The crowds.
        movers: (x, y, vx, vy) of the other movers at each step of the crowds [m, m/s], shape (steps, M, 4). After the
            last one they stand.
    """

    walk: CrowdWalk
    movers: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class MoverRecording:
    """Where some movers are at evenly spaced times.

    Positions are interpolated between them; after the last one the movers stand.

    They do not react to robots, but for live crowds. Lidars and footprints meet the outline of a mover whatever their
    height.

    Attributes:
        outlines: The convex outline of each mover in its frame [m], counter-clockwise, shape (N, 2), or the radius [m]
            of a disc around its origin.
        tracks: (x, y, yaw) at each sample, map frame [m, rad], shape (movers, samples, 3), read-only. Yaws are
            continuous: a turn from π to −π is no jump.
        period: Time between two samples [s].
        crowds: Crowds whose members are the last of the movers; their tracks are of no use then. If None, there are
            none that react.

    Raises:
        InputError: If there are other numbers of outlines than of tracks or of movers with the members of crowds, no
            samples, or numbers that are not finite.
    """

    outlines: tuple[FloatArray | float, ...]
    tracks: FloatArray
    period: float = field(default=PERIOD_S)
    crowds: LiveCrowds | None = None

    def __post_init__(self) -> None:
        tracks = as_array(self.tracks, np.float64, "tracks of a recording")
        if tracks.ndim != 3 or tracks.shape[2] != 3 or tracks.shape[1] == 0 or len(tracks) != len(self.outlines):
            raise InputError(
                f"a recording of {len(self.outlines)} movers needs tracks of shape ({len(self.outlines)}, samples, 3), "
                f"got {tracks.shape}"
            )
        if not (np.abs(tracks) < 1e9).all():
            raise InputError("the tracks of a recording must be finite")
        if self.crowds is not None:
            _check_crowds(self.crowds, len(self.outlines))
        tracks.flags.writeable = False
        object.__setattr__(self, "tracks", tracks)
        object.__setattr__(self, "period", check_number("period", self.period, 1e-6, 1e6, "s"))

    def __repr__(self) -> str:
        count, samples, _ = self.tracks.shape
        return f"MoverRecording({count} movers, {(samples - 1) * self.period:g} s)"

    @classmethod
    def of_world(
        cls,
        world: World,
        robot: Robot,
        *,
        duration_s: float,
        seed: int = 0,
        period_s: float = PERIOD_S,
        live_crowds: bool = False,
    ) -> Self:
        """Record the movers of a world, crowds included, as if there were no robot.

        Args:
            world: The world.
            robot: The robot that will drive there.
            duration_s: How long [s]; for a motion that repeats, as long as the episodes are.
            seed: Seed of the crowds, where they are recorded.
            period_s: Time between two samples [s].
            live_crowds: Whether crowds are not recorded, but computed for each robot of a batch: with its seed, and
                members that see the robot give way to it.

        Raises:
            InputError: If the world has no movers, or a number is out of range.
            WorldError: If there is no room for a crowd.
        """
        check_kind(world, World, "world", "World.generate(name) makes one")
        period = check_number("period_s", period_s, 1e-3, 60.0, "s")
        duration = check_number("duration_s", duration_s, 0.0, 86_400.0, "s")
        if not world.movers:
            raise InputError(f"the world {world.name!r} has no movers to record")
        crowds = [mover for mover in world.movers if isinstance(mover, Crowd)]
        live = live_crowds and bool(crowds)
        scripted = [mover for mover in world.movers if isinstance(mover, Mover)]
        movers = MoverField(replace(world, movers=tuple(scripted)) if live else world, robot)
        samples = int(np.ceil(duration / period - 1e-9)) + 1
        count = len(movers.names) + (sum(crowd.count for crowd in crowds) if live else 0)
        if samples * count > _MOST_SAMPLES:
            raise InputError(
                f"{count} movers for {duration:g} s are {samples * count:,} samples, more than "
                f"{_MOST_SAMPLES:,}; use a longer period_s than {period:g} s, or less time"
            )
        movers.reset(seed, _FAR_AWAY)
        tracks = np.empty((len(movers.names), samples, 3))
        for sample in range(samples):
            tracks[:, sample] = movers.advance(sample * period, lambda: (_FAR_AWAY, 0.0))[:, :3]
        tracks[:, :, 2] = np.unwrap(tracks[:, :, 2], axis=1)
        shapes = [_shape_of(body) for body in movers.bodies]
        outlines = tuple(shapes[kind] for kind in movers.kinds)
        if not live:
            return cls(outlines, tracks, period)
        members = [_shape_of(crowd.body) for crowd in crowds for _ in range(crowd.count)]
        tracks = np.concatenate([tracks, np.zeros((len(members), samples, 3))])
        return cls((*outlines, *members), tracks, period, _live(crowds, scripted, world, duration))


def find_live(recordings: Sequence[MoverRecording]) -> dict[int, LiveCrowds]:
    """Return the live crowds of recordings by the recordings' numbers."""
    return {number: each.crowds for number, each in enumerate(recordings) if each.crowds is not None}


def _check_crowds(crowds: LiveCrowds, count: int) -> None:
    """Check live crowds of a recording with so many outlines."""
    check_kind(crowds, LiveCrowds, "crowds", "MoverRecording.of_world(…, live_crowds=True) makes them")
    members, others = len(crowds.walk.names), len(crowds.walk.movers_at(0))
    if members + others != count:
        raise InputError(
            f"a recording of {count} movers has crowds of {members} members beside {others} others: it needs one "
            "outline for each of them, members last"
        )
    movers = np.asarray(crowds.movers)
    if movers.ndim != 3 or len(movers) == 0 or movers.shape[1:] != (others, 4) or not (np.abs(movers) < 1e9).all():
        raise InputError(
            f"the movers beside crowds must be finite numbers of shape (steps, {others}, 4), got {movers.shape}"
        )


def _live(crowds: Sequence[Crowd], movers: Sequence[Mover], world: World, duration: float) -> LiveCrowds:
    walk = CrowdWalk(crowds, movers, world.solids)
    steps = np.array([walk.movers_at(step) for step in range(int(np.ceil(duration / PERIOD_S)) + 1 if movers else 1)])
    last = steps[-1:].copy()
    last[:, :, 2:] = 0.0
    return LiveCrowds(walk, np.concatenate([steps, last]))


def _shape_of(body: tuple[Solid, ...]) -> FloatArray | float:
    """The radius of an upright cylinder about the origin that contains the body, seen from above, else its outline."""
    reach = radius_of(body)
    for part in body:
        if isinstance(part.shape, Cylinder) and part.pose.is_upright() and part.shape.radius >= reach - 1e-9:
            return part.shape.radius  # then its axis is at the origin
    return outline_of(body)
