"""`Hypotheses`: the main track and its rivals, and which of them is believed.

One scan never decides. A rival near the main track takes over when it has fitted better over several scans: wheels
slipped, or the start was off. One that the search of the whole map found has to stay clearly better over some distance
driven or turned, without a rival. Until then the state is `lost` or `ambiguous`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from trundle.geometry import FloatArray, Pose2D
from trundle.localization.amcl.amcl_settings import AmclSettings
from trundle.localization.amcl.beams import Beams
from trundle.localization.amcl.map_field import MapField
from trundle.localization.amcl.motion import Motion
from trundle.localization.amcl.tracks import Match, Track, match, stands_in_drawn, update_score
from trundle.observation import LocalizationState

_SAME_M, _SAME_RAD = 0.08, 0.05  # tracks this near are one
_LOCAL_SCANS, _LOCAL_LEAD = 3, 0.04
_LEAD_GAIN = 0.35
_START_SCANS, _START_LEAD = 30, 0.3
_DROP, _CLEAR_LEAD = 0.08, 0.25
_SLIP_M, _SLIP_LEAD = 0.25, 0.05
_LEAST_FIT = 0.5  # of the usual one: a place that fits less is not the right one either, the robot may be elsewhere
_FAR_TRAVEL_M = 0.6  # the robot sees other things by then; turning by 1.2 rad counts as much
_FAR_LEAD, _FAR_CLEAR = 0.15, 0.3
"""By the second one a place elsewhere is better even if the main track agrees as it has agreed for some time."""

_FAR_SCORE = 0.6
_RIVAL, _RIVAL_LATER, _LATER_M = 0.12, 0.05, 3.0
"""A rival whose quality is this near leaves the state ambiguous: less, the farther both have been followed."""
_RIVAL_OF_BEST, _UNEXPLAINED = 0.025, 0.8
"""The margin may be that small for a place that explains all beams, and grows with the share that it does not: where
the map has changed, a place that looks alike may fit better by 0.02."""

_CLEAR_M = 0.3
"""So far the robot must have moved without a rival: several scans that show different things."""
_RIVAL_M, _RIVAL_RAD = 0.5, 0.35
_HOPELESS = 0.4
_DOUBT = 0.8  # of the usual agreement, below which the whole map is searched
_BETTER = 0.1  # by which a place elsewhere agrees better, so that the state is ambiguous
_CONTRADICTED = 0.1
"""Share of beams through what is drawn, below which unmapped things explain a poor agreement. At 0.2 a kidnapping was
said to be one in 85 % of its bad time on changed maps, at 0.1 in 92 %, as without it (8 drives)."""
_MOSTLY = 0.78
"""Share of beams through what is drawn that no kerb explains: 50 to 75 % go through in a lot with kerbs."""

_MOST, _LEAST = 12, 1e-3
_SHOWN_M, _SHOWN_RAD = 0.5, 0.35  # places this near are shown as one
_RESIGNS_SEARCHES, _RESIGNS_M = 4, 3.0
"""After so many searches of the whole map and so far driven without a better place, the map has changed: of 48 missions
among boxes on changed maps, 4 stood for a minute or more where they believed to be."""

_NEW = np.diag((0.1**2, 0.1**2, 0.06**2))


class Hypotheses:
    """The tracks of a robot.

    Args:
        field: The map.
        settings: Of the localizer.

    Attributes:
        main: The track that is believed, or the best of those that are not confirmed.
        others: Its rivals.
        confirmed: Whether `main` has been told apart from all others, or was given.
        is_carried: Whether it is not confirmed since the lidars suddenly saw another place.
    """

    def __init__(self, field: MapField, settings: AmclSettings) -> None:
        self._field, self._settings = field, settings
        self.main = Track(Pose2D(0.0, 0.0), np.eye(3))
        self.others: list[Track] = []
        self.confirmed, self.is_carried = True, False
        self._searches, self._low_since, self._rivals_until = 0, 0.0, 0.0

    def start(self, pose: Pose2D, covariance: FloatArray, *, confirmed: bool) -> None:
        """Start over with one track."""
        self.main, self.others = Track(pose, covariance), []
        self.confirmed, self.is_carried = confirmed, False
        self._searches, self._low_since, self._rivals_until = 0, 0.0, 0.0

    @property
    def tracks(self) -> list[Track]:
        """All tracks, the main one first."""
        return [self.main, *self.others]

    def places(self) -> list[tuple[Track, float]]:
        """Return the tracks, without those near a better one, and the share of the belief in each place."""
        shares: list[tuple[Track, float]] = []
        total = sum(max(track.score, _LEAST) for track in self.tracks)
        for track in self.tracks:
            share = max(track.score, _LEAST) / total
            for index, (one, other) in enumerate(shares):
                if track.is_near(one.pose, _SHOWN_M, _SHOWN_RAD):
                    shares[index] = one, other + share
                    break
            else:
                shares.append((track, share))
        return shares

    def doubt(self) -> None:
        """Believe in none of the places any more: the robot was carried away. They become rivals like any other."""
        self.confirmed, self.is_carried = False, True
        for track in self.tracks:
            track.is_far, track.travel, self._rivals_until = True, 0.0, 0.0
            track.score, track.quality = track.agreement, 0.5 * (track.agreement + track.fit)

    @property
    def is_surprised(self) -> bool:
        """Whether the last scan fits the main track worse than is usual."""
        return self.main.fit < self.main.usual - _DROP

    def note_search(self) -> None:
        """Take that the whole map was searched, and what was found was proposed."""
        self._searches += 1

    def follow(self, motion: Motion) -> None:
        """Move all tracks by the odometry."""
        for track in self.tracks:
            track.follow(motion, self._settings)

    def compare(
        self, beams: Beams, seconds: float, idea: Pose2D | None, targets: FloatArray | None, *, wide: bool
    ) -> None:
        """Match a scan from all tracks, and from one more pose, which becomes a track where it fits better."""
        tracks = self.tracks
        if idea is not None and self.main.is_near(idea, _SAME_M, _SAME_RAD):
            idea = None
        starts, covariances = [track.pose for track in tracks], [track.covariance for track in tracks]
        if idea is not None:
            starts, covariances = [*starts, idea], [*covariances, _NEW]
        found = match(self._field, beams, starts, covariances, self._settings, wide=wide, targets=targets)
        for track, one in zip(tracks, found, strict=False):
            from_drawn = track is self.main and self.confirmed and stands_in_drawn(self._field, beams, one.pose)
            update_score(track, one, seconds, proposed=track.is_far or not self.confirmed, from_drawn=from_drawn)
        for track in self.others:
            track.lead += _LEAD_GAIN * (track.fit - self.main.fit - track.lead)
        if idea is not None:
            self._consider(found[-1], is_far=False)

    def propose(self, beams: Beams, poses: Sequence[Pose2D], *, is_far: bool) -> None:
        """Make tracks of poses that a search has found, where the scan agrees with the map."""
        if poses:
            covariances = [_NEW] * len(poses)
            for one in match(self._field, beams, poses, covariances, self._settings, wide=True):
                self._consider(one, is_far=is_far)

    def _consider(self, found: Match, *, is_far: bool) -> None:
        if any(track.is_near(found.pose, _SAME_M, _SAME_RAD) for track in self.tracks):
            return
        if not is_far and found.fit < self.main.fit + 0.5 * _LOCAL_LEAD:
            return
        if is_far and found.agreement < _HOPELESS:
            return
        track = Track(found.pose, found.covariance, is_far=is_far)
        update_score(track, found, 0.0, proposed=is_far or not self.confirmed)
        self.others.append(track)
        if len(self.others) > _MOST:
            self.others.remove(min(self.others, key=lambda one: one.quality))

    def decide(self) -> bool:
        """Drop tracks that are beaten, and let the best one take over; return whether one has, or is confirmed."""
        self._merge()
        main = self.main
        if main.scans == 0 or not self.is_doubtful:
            self._searches, self._low_since = 0, main.travel
        self.others = [track for track in self.others if not self._is_beaten(track)]
        for track in sorted(self.others, key=lambda one: -one.quality):
            if self._may_take_over(track):
                was_far = track.is_far
                if not was_far:
                    track.usual_score = max(track.usual_score, self.main.usual_score)
                self._take_over(track)
                if was_far:
                    self.confirmed = not self._rivals(track)
                    self.is_carried = False
                    track.is_far = not self.confirmed
                return True
        if not self.confirmed:
            best = max(self.tracks, key=lambda one: one.quality)
            if best is not main and best.quality > main.quality + 0.03:
                self._take_over(best)
                return True
            if main.scans <= 3 or self._rivals(main):
                self._rivals_until = main.travel
            if main.travel >= max(_FAR_TRAVEL_M, self._rivals_until + _CLEAR_M) and main.score >= _FAR_SCORE:
                self.confirmed, self.is_carried, self.others = True, False, []
                main.is_far = False
                return True
        return False

    def _is_beaten(self, track: Track) -> bool:
        if track.is_far:
            return track.score < _HOPELESS or (track.scans > 5 and track.score < self.main.score - 0.25)
        return track.scans > 5 and track.lead < 0.02

    def _may_take_over(self, track: Track) -> bool:
        if not track.is_far:
            # Where the main track fits as ever, another place only looks alike: its wheels have not slipped.
            # A start that was off agrees with little: boxes all round fit a map by chance somewhat better than it.
            was_off = self.main.scans < _START_SCANS and track.score > self.main.score + _START_LEAD
            dropped = was_off or self.main.fit < self.main.usual - _DROP
            # Hedges behind a kerb fit the kerb better than the kerb does, but the pose contradicts more of the map.
            moves_far = not track.is_near(self.main.pose, _SLIP_M, _RIVAL_RAD)
            return (
                track.scans >= _LOCAL_SCANS
                and track.fit > _LEAST_FIT * self.main.usual
                and track.lead > (_LOCAL_LEAD if dropped else _CLEAR_LEAD)
                and (not moves_far or track.score > self.main.score + _SLIP_LEAD)
            )
        return (
            self.confirmed
            and (self.is_doubtful or track.quality > self.main.quality + _FAR_CLEAR)
            and track.travel >= _FAR_TRAVEL_M
            and track.scans >= 5
            and track.score >= _FAR_SCORE
            and track.quality > self.main.quality + _FAR_LEAD
            and not [one for one in self._rivals(track) if one is not self.main]
        )

    def _take_over(self, track: Track) -> None:
        self.others = [one for one in self.others if one is not track]
        if track.is_far and not self.confirmed:
            self.main.lead = self.main.fit - track.fit
            self.others.append(self.main)
        self.main = track
        self._searches, self._low_since, self._rivals_until = 0, track.travel, track.travel
        for one in self.others:
            one.lead = one.fit - track.fit

    def _rivals(self, track: Track) -> list[Track]:
        """Tracks elsewhere that agree with the map nearly as well."""
        first = min(_RIVAL, _RIVAL_OF_BEST + _UNEXPLAINED * (1.0 - track.score))
        later = min(_RIVAL_LATER, first)
        shares = [min(1.0, one.travel / _LATER_M, track.travel / _LATER_M) for one in self.tracks]
        margins = [first + share * (later - first) for share in shares]
        return [
            one
            for one, margin in zip(self.tracks, margins, strict=True)
            if one is not track
            and one.quality > track.quality - margin
            and not one.is_near(track.pose, _RIVAL_M, _RIVAL_RAD)
        ]

    def _merge(self) -> None:
        kept: list[Track] = []
        for track in self.others:
            if not any(one.is_near(track.pose, _SAME_M, _SAME_RAD) for one in (self.main, *kept)):
                kept.append(track)
        self.others = kept

    @property
    def is_doubtful(self) -> bool:
        """Whether the main track agrees with the map so badly that it may be elsewhere."""
        return self._is_contradicted and self.main.score < max(
            self._settings.lost_below, _DOUBT * self.main.usual_score
        )

    @property
    def _is_contradicted(self) -> bool:
        """Whether beams go through what the map draws: those that end too soon met something that is not on it."""
        return self.main.pierced > _CONTRADICTED

    @property
    def state(self) -> LocalizationState:
        """What the tracks say about the robot's place."""
        low = self.main.score < self._settings.lost_below or self.main.pierced > _MOSTLY
        if not self.confirmed:
            return "lost" if low else "ambiguous"
        main, better = self.main, max(self.main.score + _BETTER, _FAR_SCORE)
        if any(
            one.is_far and one.scans > 2 and one.score > better and one.quality > main.quality + _BETTER
            for one in self.others
        ):
            return "ambiguous"
        is_lost = self.main.scans > 0 and low and self._is_contradicted
        return "lost" if is_lost and not self._is_best_of_all else "localized"

    @property
    def _is_best_of_all(self) -> bool:
        """Whether no place on the whole map has agreed better for long, so that it is the map that has changed."""
        return (
            self._searches >= _RESIGNS_SEARCHES
            and self.main.travel > self._low_since + _RESIGNS_M
            and all(one.quality < self.main.quality for one in self.others if one.is_far)
        )
