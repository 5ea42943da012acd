"""`Track`: a hypothesis of where the robot is, followed by odometry and scan matching."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from trundle._core import judge_beams, match_scan
from trundle.geometry import FloatArray, Pose2D, wrap_angle
from trundle.localization.amcl.beams import Beams
from trundle.localization.amcl.map_field import MapField
from trundle.localization.amcl.motion import Motion
from trundle.localization.amcl.settings import AmclSettings

MOST_INFORMATIVE = 30.0  # beams: errors of a scan repeat with the map, and more would be counted twice
_WIDTH_M = 0.1  # of the robust weights
_WIDE_M = 0.4  # at first, of a pose that may be some decimetres off
_ITERATIONS = 8
_TOLERANCE_M = 0.1  # within which a beam agrees with the map
_DEPTH_M = 0.2  # behind the map's surface, which is drawn round all of a band of heights
_UNSEEN_COSTS = 0.3
_AGREEMENT = 0.8  # its part in what poses are compared by
_JUDGED = 60  # beams that judge a pose
_CONTRADICTION = 4.0
"""Weight of beams that contradict the map. Of 170 single scans in lots whose kerbs no lidar sees, it put the true pose
before the best other one in 90 %; agreeing beams alone did so in 20 %. In other worlds both were alike."""
_FEWEST = 0.15  # of the beams: with fewer on the map there is little evidence for anything
_LONG_S = 12.0
_USUAL_S = 6.0  # of the average of the fit that a slip of wheels is told by
_BREAK, _BREAK_S = 0.15, 0.3
"""A fit that falls this much below its usual value at once tells a robot that was carried away from a changed map."""

_SCORE_S = 0.7  # of the average of agreement: it falls from 0.9 to 0.4 in 0.7 s


@dataclass(slots=True, eq=False)
class Track:
    """A hypothesis.

    Attributes:
        pose: Where the robot is if it is right, in the grid's frame.
        covariance: Of that, shape (3, 3), without the map's own error.
        score: Agreement of the beams with the map, 0 to 1, on average over about a second.
        quality: Mean of agreement and fit, likewise: what tracks are compared by.
        fit: How near the beams' ends lie to surfaces, 0 to 1, at the last scan.
        lead: How much better it fits than the main track, on average over the last scans.
        agrees_more: The same of agreement alone.
        recent: The fit on average over some tenths of a second.
        broken: Fit that it had when it fell at once: the robot may have been carried away. None while all is well.
        pierced: Share of beams that go through what the map draws, of those that agree or go through, likewise.
        scans: How many scans it has been compared with.
        travel: How far it was followed [m]; see `Motion.travel`.
        is_far: Whether it comes from the search of the whole map, and needs more evidence to be believed.
    """

    pose: Pose2D
    covariance: FloatArray
    score: float = 0.0
    quality: float = 0.0
    fit: float = 0.0
    merit: float = 0.0
    agreement: float = 0.0
    usual: float = 0.0
    usual_score: float = 0.0
    distance: float = 0.0
    independent: float = 0.0
    lead: float = 0.0
    agrees_more: float = 0.0
    recent: float = 0.0
    broken: float | None = None
    pierced: float = 0.0
    scans: int = 0
    travel: float = 0.0
    is_far: bool = False

    def follow(self, motion: Motion, settings: AmclSettings) -> None:
        """Move by the odometry; the covariance grows."""
        before, delta = self.pose, motion.delta
        self.pose = after = before @ delta
        jacobian = np.array(
            ((1.0, 0.0, before.y - after.y), (0.0, 1.0, after.x - before.x), (0.0, 0.0, 1.0)),
        )
        along, across, yaw = motion.variances(settings)
        heading = before.yaw + motion.turn
        cos, sin = math.cos(heading), math.sin(heading)
        xy = (along - across) * cos * sin
        noise = np.array(
            (
                (along * cos * cos + across * sin * sin, xy, 0.0),
                (xy, along * sin * sin + across * cos * cos, 0.0),
                (0.0, 0.0, yaw),
            )
        )
        self.covariance = jacobian @ self.covariance @ jacobian.T + noise
        self.travel += motion.travel

    @property
    def standing(self) -> float:
        """What places are compared by: of one found by a search, much that it takes for unseen counts against it."""
        return self.quality - (_UNSEEN_COSTS * self.pierced if self.is_far else 0.0)

    def is_near(self, other: Pose2D, metres: float, radians: float) -> bool:
        """Return whether another pose is within these distances."""
        return self.pose.distance_to(other) <= metres and abs(wrap_angle(self.pose.yaw - other.yaw)) <= radians


@dataclass(frozen=True, slots=True, eq=False)
class Match:
    """Where scan matching puts one pose.

    Attributes:
        pose: In the grid's frame.
        covariance: Shape (3, 3).
        fit: Mean weight of the beams, 0 to 1.
        agreement: Share of the beams that agree with the map; see `agreements`.
        pierced: Share of beams that go through what the map draws; see `agreements`.
        distance: Mean distance of the beams' ends from where they are expected [m].
        independent: How far a distance that all beams share can be told from a wrong pose, 0 to 1.
    """

    pose: Pose2D
    covariance: FloatArray
    fit: float
    agreement: float
    pierced: float
    distance: float
    independent: float

    @property
    def merit(self) -> float:
        """What poses are compared by: agreement above all, as many beams may fit a wrong pose by chance."""
        return _AGREEMENT * self.agreement + (1.0 - _AGREEMENT) * self.fit


def match(
    field_: MapField,
    beams: Beams,
    starts: Sequence[Pose2D],
    covariances: Sequence[FloatArray],
    settings: AmclSettings,
    *,
    wide: bool,
    targets: FloatArray | None = None,
    judged: Beams | None = None,
) -> list[Match]:
    """Match a scan from several starts, each of which is its own prior; `targets` (N,) are those of the first.

    `judged` are the beams that judge the poses, if not the same.
    """
    poses = np.array([start.as_tuple() for start in starts])
    numbers = np.array((_WIDE_M if wide else _WIDTH_M, _WIDTH_M, settings.match_noise, MOST_INFORMATIVE, _ITERATIONS))
    surfaces = np.zeros((len(poses), len(beams)))
    if targets is not None:
        surfaces[0] = targets
    found, spread, told = match_scan(
        *(field_.values, field_.resolution, field_.limit, beams.points, surfaces),
        *(poses, poses, np.array(covariances, dtype=np.float64), numbers),
    )
    shares, pierced = agreements(field_, beams if judged is None else judged, found)
    count = float(len(beams))
    return [
        Match(Pose2D(*pose), one, row[2] / count, share, through, row[4], row[5])
        for pose, one, row, share, through in zip(
            found.tolist(), spread, told.tolist(), shares.tolist(), pierced.tolist(), strict=True
        )
    ]


def agreements(
    field_: MapField, beams: Beams, poses: FloatArray
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return which share of the beams agrees with the map from each pose (K, 3), and which goes through it, 0 to 1.

    A map lacks things, and beams end before what it draws; or it draws what no lidar sees, a kerb, and beams go through
    it. Either alone explains what is seen from the right pose, however many beams it is. From a wrong pose there are
    both, and the smaller share of the two contradicts the map.
    """
    tolerance = max(_TOLERANCE_M, 1.5 * field_.resolution)
    step = -(-len(beams) // _JUDGED)
    sensors, points = np.ascontiguousarray(beams.sensors[::step]), np.ascontiguousarray(beams.points[::step])
    verdicts = judge_beams(field_.values, field_.resolution, sensors, points, poses, tolerance, _DEPTH_M)
    counts = [[row.count(kind) for kind in range(3)] for row in map(bytes, verdicts)]
    agree, short, through = np.array(counts, dtype=np.float64).reshape(-1, 3).T
    fewest = _FEWEST * len(points)
    shares = agree / np.maximum(agree + _CONTRADICTION * np.minimum(short, through), fewest)
    return shares, through / np.maximum(agree + through, fewest)


def update_score(track: Track, found: Match, seconds: float) -> None:
    """Take what one scan has shown of a track."""
    gain = 1.0 if track.scans == 0 else 1.0 - math.exp(-seconds / _SCORE_S)
    track.pose, track.covariance = found.pose, found.covariance
    track.score += gain * (found.agreement - track.score)
    track.quality += gain * (found.merit - track.quality)
    track.pierced += gain * (found.pierced - track.pierced)
    track.usual_score += (1.0 if track.scans == 0 else 1.0 - math.exp(-seconds / _LONG_S)) * (
        track.score - track.usual_score
    )
    track.usual += (1.0 if track.scans == 0 else 1.0 - math.exp(-seconds / _USUAL_S)) * (found.fit - track.usual)
    track.fit, track.merit, track.agreement = found.fit, found.merit, found.agreement
    track.recent += (1.0 if track.scans == 0 else 1.0 - math.exp(-seconds / _BREAK_S)) * (found.fit - track.recent)
    if track.broken is None and track.recent < track.usual - _BREAK:
        track.broken = track.usual
    elif track.broken is not None and track.recent > track.broken - 0.5 * _BREAK:
        track.broken = None
    track.distance, track.independent = found.distance, found.independent
    track.scans += 1
