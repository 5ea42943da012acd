"""`Track`: a hypothesis of where the robot is, followed by odometry and scan matching."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from trundle._core import field_at, judge_beams, match_scan
from trundle.geometry import FloatArray, Pose2D, wrap_angle
from trundle.localization.amcl.amcl_settings import AmclSettings
from trundle.localization.amcl.beams import Beams
from trundle.localization.amcl.map_field import MapField
from trundle.localization.amcl.motion import Motion

MOST_INFORMATIVE = 30.0  # beams: errors of a scan repeat with the map, and more would be counted twice
_WIDTH_M = 0.1  # of the robust weights
_WIDE_M = 0.4  # at first, of a pose that may be some decimetres off
_ITERATIONS = 8
_TOLERANCE_M = 0.1  # within which a beam agrees with the map
_DEPTH_M = 0.2  # behind the map's surface, which is drawn round all of a band of heights
_JUDGED = 60  # beams that judge a pose
_SHORT_COUNTS = 0.5  # something that is not on the map is in front of it more often than the robot is lost
_BOTH_COUNT = 4.0
_FEWEST_TO_CONTRADICT = 0.25  # where boxes hide most of the map, a few beams through it say little
_FEWEST = 0.15  # of the beams: with fewer on the map there is little evidence for anything
_IN_BODY_M = 0.1  # nothing is so near to a lidar: that would be within the robot
_FITS_STILL = 0.7  # of the usual fit: else the robot may have been carried away
_LONG_S = 12.0
_USUAL_S = 6.0  # of the average of the fit that a slip of wheels is told by
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
    agreement: float = 0.0
    usual: float = 0.0
    usual_score: float = 0.0
    distance: float = 0.0
    independent: float = 0.0
    lead: float = 0.0
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
        excused: The same, where what is not on the map, or not seen, is excused; see `agreements`.
        pierced: Share of beams that go through what the map draws; see `agreements`.
        distance: Mean distance of the beams' ends from where they are expected [m].
        independent: How far a distance that all beams share can be told from a wrong pose, 0 to 1.
    """

    pose: Pose2D
    covariance: FloatArray
    fit: float
    agreement: float
    excused: float
    pierced: float
    distance: float
    independent: float


def match(
    field_: MapField,
    beams: Beams,
    starts: Sequence[Pose2D],
    covariances: Sequence[FloatArray],
    settings: AmclSettings,
    *,
    wide: bool,
    targets: FloatArray | None = None,
) -> list[Match]:
    """Match a scan from several starts, each of which is its own prior; `targets` (N,) are those of the first."""
    poses = np.array([start.as_tuple() for start in starts])
    numbers = np.array((_WIDE_M if wide else _WIDTH_M, _WIDTH_M, settings.match_noise, MOST_INFORMATIVE, _ITERATIONS))
    surfaces = np.zeros((len(poses), len(beams)))
    if targets is not None:
        surfaces[0] = targets
    found, spread, told = match_scan(
        *(field_.values, field_.resolution, field_.limit, beams.points, surfaces),
        *(poses, poses, np.array(covariances, dtype=np.float64), numbers),
    )
    shares = agreements(field_, beams, found)
    count = float(len(beams))
    return [
        Match(Pose2D(*pose), one, row[2] / count, *share, row[4], row[5])
        for pose, one, row, share in zip(found.tolist(), spread, told.tolist(), shares, strict=True)
    ]


def agreements(field_: MapField, beams: Beams, poses: FloatArray) -> list[tuple[float, float, float]]:
    """Return three shares of the beams from each pose (K, 3), 0 to 1.

    The first is that of the beams that agree with the map: a beam that ends before what is on the map counts half, as
    more often something stands there than the robot is lost. A place that is proposed has to agree like that.

    In the second, beams that end too soon, or that go through what is drawn, contradict the map only where there are
    both: boxes alone, or a kerb below the lidars' plane alone, explain what is seen from the right place. A place that
    is believed is judged like that. The third is the share that goes through, of those that do not end too soon.
    """
    tolerance = max(_TOLERANCE_M, 1.5 * field_.resolution)
    step = -(-len(beams) // _JUDGED)
    sensors, points = np.ascontiguousarray(beams.sensors[::step]), np.ascontiguousarray(beams.points[::step])
    verdicts = judge_beams(field_.values, field_.resolution, sensors, points, poses, tolerance, _DEPTH_M)
    counts = [[row.count(kind) for kind in range(3)] for row in map(bytes, verdicts)]
    agree, short, through = np.array(counts, dtype=np.float64).reshape(-1, 3).T
    fewest = _FEWEST * len(points)
    shares = agree / np.maximum(agree + through + _SHORT_COUNTS * short, fewest)
    excused = np.maximum(shares, agree / np.maximum(agree + _BOTH_COUNT * np.minimum(short, through), fewest))
    pierced = through / np.maximum(agree + through, _FEWEST_TO_CONTRADICT * len(points))
    return list(zip(shares.tolist(), excused.tolist(), pierced.tolist(), strict=True))


def stands_in_drawn(field_: MapField, beams: Beams, pose: Pose2D) -> bool:
    """Whether a lidar would be in something that the map draws, or nearly: that is not there, if the pose is right."""
    sensors = pose.transform_points(beams.sensors)
    return bool((field_at(field_.values, field_.resolution, field_.limit, sensors)[:, 0] < _IN_BODY_M).any())


def update_score(track: Track, found: Match, seconds: float, *, proposed: bool, from_drawn: bool = False) -> None:
    """Take what one scan has shown of a track; a place that is only proposed is judged strictly.

    With `from_drawn`, beams that go through what the map draws say nothing, as those of a lidar begin in it.
    """
    agreement = found.agreement if proposed else found.excused
    if from_drawn and found.fit > _FITS_STILL * track.usual:
        found = replace(found, pierced=track.pierced)
        agreement = max(agreement, track.score)
    gain = 1.0 if track.scans == 0 else 1.0 - math.exp(-seconds / _SCORE_S)
    track.pose, track.covariance = found.pose, found.covariance
    track.score += gain * (agreement - track.score)
    track.quality += gain * (0.5 * (agreement + found.fit) - track.quality)
    track.pierced += gain * (found.pierced - track.pierced)
    track.usual_score += (1.0 if track.scans == 0 else 1.0 - math.exp(-seconds / _LONG_S)) * (
        track.score - track.usual_score
    )
    track.usual += (1.0 if track.scans == 0 else 1.0 - math.exp(-seconds / _USUAL_S)) * (found.fit - track.usual)
    track.fit, track.agreement = found.fit, agreement
    track.distance, track.independent = found.distance, found.independent
    track.scans += 1
