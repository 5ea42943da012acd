"""`Hypotheses`: the main track and its rivals, and which of them is believed.

One scan never decides. A rival near the main track takes over when it has fitted better over several scans: wheels
slipped, or the start was off. One that the search of the whole map found has to stay clearly better over some distance
driven or turned, without a rival. Until then the state is `lost` or `ambiguous`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from trundle.geometry import FloatArray, Pose2D
from trundle.localization.amcl.beams import Beams
from trundle.localization.amcl.map_field import MapField
from trundle.localization.amcl.motion import Motion
from trundle.localization.amcl.settings import AmclSettings
from trundle.localization.amcl.tracks import Match, Track, match, update_score
from trundle.observation import LocalizationState

_SAME_M, _SAME_RAD = 0.08, 0.05  # tracks this near are one
_LOCAL_SCANS, _LOCAL_LEAD = 3, 0.04
_LEAD_GAIN = 0.35
_GOOD = 0.8  # agreement of a place that is not given up for one that agrees alike
_LEAST_FIT, _FAR_FIT = 0.28, 0.4
"""Least fit of places nearby and elsewhere: boxes round the robot make as good a fit by chance."""

_PER_METRE = 0.2  # of quality, for a place nearer by a metre
_LESS_AGREEMENT = -0.03  # a place that fits better although it agrees less fits by chance
_START_SCANS = 30
_BEATEN, _LONG_LEAD, _SURE_M = 0.08, 0.03, 2.0
"""Agreement over some seconds by which places near a start that was wrong are told apart, and how far that takes."""

_CLEAR_LEAD = 0.25
_FAR_TRAVEL_M = 0.6  # the robot sees other things by then; turning by 1.2 rad counts as much
_FAR_LEAD, _FAR_CLEAR = 0.15, 0.3
"""By the second one a place elsewhere is better even if the main track agrees as it has agreed for some time."""

_FAR_SCORE = 0.6
_RIVAL, _RIVAL_LATER, _LATER_M = 0.12, 0.05, 3.0
"""A rival whose score is this near leaves the state ambiguous: less, the farther both have been followed."""

_RIVAL_M, _RIVAL_RAD = 0.5, 0.35
_HOPELESS = 0.4
_CERTAIN = 0.85
_DOUBT = 0.8  # of the usual agreement, below which the whole map is searched
_BETTER = 0.1  # by which a place elsewhere agrees better, so that the state is ambiguous
_CONTRADICTED = 0.1
"""Share of beams through what is drawn, below which unmapped things explain a poor agreement. At 0.2 a kidnapping was
said to be one in 85 % of its bad time on changed maps, at 0.1 in 92 %, as without it (8 drives)."""
_MOSTLY = 0.78  # of the beams go through the map: 50 to 75 % do in a lot with kerbs
_MOST = 12
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
        is_new: Whether `main` was found elsewhere, and what is near it has not been searched yet.
    """

    def __init__(self, field: MapField, settings: AmclSettings) -> None:
        self._field, self._settings = field, settings
        self.main = Track(Pose2D(0.0, 0.0), np.eye(3))
        self.others: list[Track] = []
        self.confirmed = True
        self._unsure = False  # whether a start that was wrong has left several places near it
        self._earned = False  # whether the main track has agreed with the map for long
        self.is_new = False

    def start(self, pose: Pose2D, covariance: FloatArray, *, confirmed: bool) -> None:
        """Start over with one track."""
        self.main, self.others, self.confirmed = Track(pose, covariance), [], confirmed
        self._unsure = self._earned = self.is_new = False

    @property
    def tracks(self) -> list[Track]:
        """All tracks, the main one first."""
        return [self.main, *self.others]

    def places(self) -> list[tuple[Track, float]]:
        """Tracks that lie apart, best first, with the share of each; those near another count as its own."""
        kept: list[tuple[Track, float]] = []
        total = sum(max(track.score, 1e-3) for track in self.tracks)
        for track in self.tracks:
            share = max(track.score, 1e-3) / total
            near = [index for index, (one, _) in enumerate(kept) if one.is_near(track.pose, _RIVAL_M, _RIVAL_RAD)]
            if near:
                kept[near[0]] = (kept[near[0]][0], kept[near[0]][1] + share)
            else:
                kept.append((track, share))
        return [kept[0], *sorted(kept[1:], key=lambda one: -one[1])]

    def follow(self, motion: Motion) -> None:
        """Move all tracks by the odometry."""
        for track in self.tracks:
            track.follow(motion, self._settings)

    def compare(
        self,
        beams: Beams,
        seconds: float,
        idea: Pose2D | None,
        targets: FloatArray | None,
        *,
        wide: bool,
        judged: Beams | None = None,
    ) -> None:
        """Match a scan from all tracks, and from one more pose, which becomes a track where it fits better."""
        tracks = self.tracks
        if idea is not None and self.main.is_near(idea, _SAME_M, _SAME_RAD):
            idea = None
        starts, covariances = [track.pose for track in tracks], [track.covariance for track in tracks]
        if idea is not None:
            starts, covariances = [*starts, idea], [*covariances, _NEW]
        found = match(
            self._field, beams, starts, covariances, self._settings, wide=wide, targets=targets, judged=judged
        )
        for track, one in zip(tracks, found, strict=False):
            update_score(track, one, seconds)
        for track in self.others:
            track.lead += _LEAD_GAIN * (track.merit - self.main.merit - track.lead)
            track.agrees_more += _LEAD_GAIN * (track.agreement - self.main.agreement - track.agrees_more)
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
        if not is_far and found.merit < self.main.merit + 0.5 * _LOCAL_LEAD:
            return
        if is_far and found.agreement < _HOPELESS:
            return
        track = Track(found.pose, found.covariance, is_far=is_far)
        update_score(track, found, 0.0)
        self.others.append(track)
        if len(self.others) > _MOST:
            self.others.remove(min(self.others, key=lambda one: one.quality))

    def decide(self) -> bool:
        """Drop tracks that are beaten, and let the best one take over where it may; return whether one has."""
        self._merge()
        main = self.main
        self._earned = self._earned or (main.scans > _START_SCANS and main.score > _FAR_SCORE)
        if self._unsure and main.scans > _START_SCANS and main.travel > _SURE_M:
            self._unsure = any(not one.is_far and self._is_elsewhere(one) for one in self.others)
        self.others = [track for track in self.others if not self._is_beaten(track)]
        for track in sorted(self.others, key=self._order):
            if self._may_take_over(track):
                was_far = track.is_far
                if not was_far:
                    self._unsure = self._unsure or self._has_broken
                    track.broken = self.main.broken
                    track.usual_score = max(track.usual_score, self.main.usual_score)
                self._take_over(track)
                if was_far:
                    self._earned, self._unsure, self.is_new = False, True, True
                    self.confirmed = not self._rivals(track)
                return True
        if not self.confirmed:
            best = max(self.tracks, key=lambda one: one.quality)
            if best is not main and best.quality > main.quality + 0.03:
                self._take_over(best)
                return True
            rivals = self._rivals(main)
            if main.scans > 3 and main.travel >= _FAR_TRAVEL_M and main.score >= _FAR_SCORE and not rivals:
                self.confirmed, self.others = True, []
                self._unsure = self.is_new = True
        return False

    def _order(self, track: Track) -> float:
        """What rivals are tried by: a slip is rather short than long."""
        return _PER_METRE * self.main.pose.distance_to(track.pose) * (not track.is_far) - track.quality

    def _is_beaten(self, track: Track) -> bool:
        if track.is_far:
            return track.score < _HOPELESS or (track.scans > 5 and track.score < self.main.score - 0.25)
        if self._unsure and self._is_elsewhere(track):
            return track.scans > 5 and track.usual_score < self.main.usual_score - _BEATEN
        return track.scans > 5 and track.lead < 0.02

    def _is_elsewhere(self, track: Track) -> bool:
        return not self.main.is_near(track.pose, _RIVAL_M, _RIVAL_RAD)

    def _may_take_over(self, track: Track) -> bool:
        if not track.is_far:
            if track.usual < _LEAST_FIT:
                return False
            if self._unsure and self._is_elsewhere(track):
                return track.travel > _FAR_TRAVEL_M and track.usual_score > self.main.usual_score + _LONG_LEAD
            if self._earned and self._is_elsewhere(track) and track.travel < _FAR_TRAVEL_M:
                return False  # no slip of wheels is that long
            # Where the main track fits as ever, another place only looks alike: its wheels have not slipped.
            agreed = self.main.score if self._is_elsewhere(track) else self.main.agreement
            dropped = self._has_broken and agreed < _GOOD
            return (
                track.scans >= _LOCAL_SCANS
                and track.lead > (_LOCAL_LEAD if dropped else _CLEAR_LEAD)
                and track.agrees_more > _LESS_AGREEMENT
            )
        return (
            self.confirmed
            and (self.is_doubtful or (self._has_broken and track.standing > self.main.standing + _FAR_CLEAR))
            and track.travel >= _FAR_TRAVEL_M
            and track.scans >= 5
            and track.usual >= _FAR_FIT
            and track.score >= _FAR_SCORE
            and track.standing > self.main.standing + _FAR_LEAD
            and not [one for one in self._rivals(track) if one is not self.main]
        )

    def _take_over(self, track: Track) -> None:
        self.others = [one for one in self.others if one is not track]
        if track.is_far and not self.confirmed:
            self.main.lead = self.main.merit - track.merit
            self.others.append(self.main)
        self.main = track
        for one in self.others:
            one.lead = one.merit - track.merit

    def _rivals(self, track: Track) -> list[Track]:
        """Tracks elsewhere that agree with the map nearly as well."""
        shares = [min(1.0, one.travel / _LATER_M) for one in self.tracks]
        margins = [_RIVAL + min(share, track.travel / _LATER_M) * (_RIVAL_LATER - _RIVAL) for share in shares]
        return [
            one
            for one, margin in zip(self.tracks, margins, strict=True)
            if one is not track
            and one.standing > track.standing - margin
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
        low = self._settings.lost_below
        if self._has_broken:
            low = max(low, _DOUBT * self.main.usual_score)
        return self._is_contradicted and self.main.score < low

    @property
    def is_certain(self) -> bool:
        """Whether the main track has agreed with the map for long, and nothing says that it may be elsewhere."""
        main = self.main
        return (
            self.confirmed
            and self._earned
            and not self._unsure
            and main.broken is None
            and min(main.score, main.usual_score) > _CERTAIN
            and main.usual > _LEAST_FIT
        )

    @property
    def _has_broken(self) -> bool:
        """Whether the robot may have been carried away, or was never where it was believed to be."""
        return self.main.broken is not None or not self._earned

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
        better = max(self.main.standing + _BETTER, _FAR_SCORE)
        if self._has_broken and any(one.is_far and one.scans > 2 and one.standing > better for one in self.others):
            return "ambiguous"
        if self._unsure and any(not one.is_far and self._is_elsewhere(one) for one in self.others):
            return "ambiguous"
        return "lost" if self.main.scans > 0 and low and self._is_contradicted else "localized"
