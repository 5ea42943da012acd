"""`Followed`: what a tracker follows at present, and what is known about each."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from support.tracking_oracle.evidence import Evidence
from support.tracking_oracle.filters import Filters
from support.tracking_oracle.sweep import BoolArray, IndexArray, Sweep
from trundle.geometry import FloatArray
from trundle.observation import Track
from trundle.tracking.tracker import TrackerSettings

_GATE_M, _GATE_DEVIATIONS, _WIDEST_GATE_M = 0.15, 2.0, 0.6
_APPEARED_SHARE, _LEFT_SHARE, _STILL_SHARE = 0.3, 0.6, 0.7
_SAMPLES = np.array([0.1, 0.3, 0.5, 0.7, 0.9])
_LEFT_AFTER_S, _KEPT_S = 0.3, 0.6
_TENTATIVE_S, _EMPTY_S = 0.25, 0.3
_MOST_PROOFS, _FORGOTTEN_PROOF = 6.0, 0.25
_MOST_TENTATIVE = 64
_LEAST_RADIUS_M = 0.05
_RESIZE_SHARE = 0.15
_SIGNIFICANT = 2.5  # standard deviations
_STAYS_SHARE = 0.6
_FAST_MPS = 0.3
_MEAN_S, _STRAY_M = 0.3, 0.2
_LOST_M = 1.0
_JUST_S = 0.15
_FASTEST_MPS = 4.0

_FACTS = np.dtype(
    [
        ("id", np.int64),
        ("hits", np.int64),
        ("seen_at", np.float64),
        ("empty_s", np.float64),
        ("aside_s", np.float64),
        ("proofs", np.float64),
        ("confirmed", np.bool_),
        ("moving", np.bool_),
        ("mean_velocity", np.float64, (2,)),
    ]
)


class Followed:
    """Tracks: a filter for each, and what shows that it moves.

    Args:
        settings: Of the tracker.
    """

    def __init__(self, settings: TrackerSettings) -> None:
        self._settings = settings
        self._filters = Filters(settings.acceleration)
        self._facts: npt.NDArray[Any] = np.zeros(0, dtype=_FACTS)
        self._rims: deque[tuple[float, IndexArray, FloatArray]] = deque()
        self._time: float | None = None
        self._next_id = 1

    def tracks(self, now: float) -> tuple[Track, ...]:
        """All of them, predicted to a time [s]."""
        filters = self._filters
        if len(filters) == 0 or self._time is None:
            return ()
        ahead = filters.predicted(now - self._time)
        covariances = ahead.covariances
        covariances.flags.writeable = False
        facts = self._facts
        return tuple(
            Track(number, now, x, y, vx, vy, covariance, radius, confirmed, moving)
            for number, (x, y, vx, vy), covariance, radius, confirmed, moving in zip(
                facts["id"].tolist(),
                ahead.states.tolist(),
                covariances,
                ahead.radii.tolist(),
                facts["confirmed"].tolist(),
                facts["moving"].tolist(),
                strict=True,
            )
        )

    def see(self, sweep: Sweep, evidence: Evidence, others: Sequence[Sweep] = ()) -> None:
        """Take a scan, with the newest ones of the other lidars."""
        self._others = others
        starts = sweep.split()
        appeared, still = evidence.judge(sweep)
        seconds = 0.0 if self._time is None else max(0.0, sweep.time - self._time)
        self._time = sweep.time if self._time is None else max(self._time, sweep.time)
        self._filters.predict(seconds)
        sizes = _sizes(sweep.points, starts)
        things = np.repeat(np.arange(len(sizes)), np.diff(starts))
        small = sizes[things] <= self._settings.max_size
        owners = self._assign(sweep, small, still)
        self._correct(sweep, owners, appeared, still, seconds)
        self._begin(sweep, starts, owners, (sizes <= self._settings.max_size), still)
        self._end()

    # Points to tracks -----------------------------------------------------------------------------------------------

    def _assign(self, sweep: Sweep, small: BoolArray, still: BoolArray) -> IndexArray:
        """The track that each hit belongs to, −1 for none; shape (N,).

        What stands still belongs to no track that is fast. What is too large, such as a wall that somebody is close to,
        only belongs to confirmed tracks that have just been seen.
        """
        owners = np.full(len(sweep.points), -1, dtype=np.intp)
        candidates = np.flatnonzero(small | ~still)
        filters = self._filters
        if len(filters) == 0 or len(candidates) == 0:
            return owners
        deviations = np.sqrt(np.maximum(filters.covariances[:, 0, 0], filters.covariances[:, 1, 1]))
        gates = np.minimum(_GATE_M + _GATE_DEVIATIONS * deviations, _WIDEST_GATE_M)
        squares = _squares(sweep.points[candidates], filters.states[:, :2])
        # Few of all pairs are close; only these are looked at further.
        tracks, near = np.nonzero(squares <= ((filters.radii + gates) ** 2)[:, None])
        hits = candidates[near]
        confirmed = self._facts["confirmed"]
        fast = np.hypot(filters.states[:, 2], filters.states[:, 3]) > _FAST_MPS
        close = confirmed & (sweep.time - self._facts["seen_at"] <= _JUST_S)
        allowed = ~(fast[tracks] & still[hits]) & (close[tracks] | small[hits])
        tracks, near, hits = tracks[allowed], near[allowed], hits[allowed]
        beyond = np.sqrt(squares[tracks, near]) - filters.radii[tracks]
        beyond[~confirmed[tracks]] += _GATE_M  # of two, the confirmed one
        order = np.lexsort((-tracks, -beyond))  # the nearest last: it is the one that stays
        owners[hits[order]] = tracks[order]
        return owners

    def _correct(self, sweep: Sweep, owners: IndexArray, appeared: BoolArray, still: BoolArray, seconds: float) -> None:
        """Correct the filters of what was hit, and gather what shows that it moves."""
        filters, facts, settings = self._filters, self._facts, self._settings
        count = len(filters)
        if count == 0:
            return
        hits = np.flatnonzero(owners >= 0)
        hits = hits[np.argsort(owners[hits], kind="stable")]
        counts = np.bincount(owners[hits], minlength=count)
        seen = counts >= min(settings.min_points, 2)
        hits = hits[seen[owners[hits]]]
        counts = np.where(seen, counts, 0)
        filters.correct(sweep.points[hits], owners[hits])
        self._resize(sweep, hits, counts)
        shares = np.maximum(counts, 1)
        moved_in = np.bincount(owners[hits], appeared[hits], minlength=count) >= _APPEARED_SHARE * shares
        moved_in &= seen & (counts >= settings.min_points)
        stays = np.bincount(owners[hits], still[hits], minlength=count) >= _STILL_SHARE * shares
        shown = moved_in | self._has_left(sweep)
        self._keep_rims(sweep, hits, counts)
        facts["proofs"] = np.where(
            shown,
            np.minimum(facts["proofs"] + 1.0, _MOST_PROOFS),
            np.maximum(facts["proofs"] - _FORGOTTEN_PROOF, 0.0),
        )
        facts["hits"] += seen
        shares = seen * np.where(facts["hits"] <= 2, 1.0, -math.expm1(-seconds / _MEAN_S))
        facts["mean_velocity"] += shares[:, None] * (filters.states[:, 2:] - facts["mean_velocity"])
        centres = filters.states[:, :2]
        empty = ~seen & sweep.saw_through(centres, settings.same_surface)
        lost = np.flatnonzero(~seen)
        facts["empty_s"][lost[self._are_in_walls(sweep, still, lost)]] += _EMPTY_S  # once more, and it is gone
        facts["empty_s"] = np.where(seen, 0.0, facts["empty_s"] + seconds * empty)
        looked_at = np.logical_or.reduce([view.faces(centres) for view in (sweep, *self._others)])
        facts["aside_s"] = np.where(seen, 0.0, facts["aside_s"] + seconds * ~looked_at)
        facts["seen_at"][seen] = sweep.time
        facts["seen_at"][seen & stays & ~facts["confirmed"] & (facts["hits"] > 3)] = -np.inf
        self._decide()

    def _are_in_walls(self, sweep: Sweep, still: BoolArray, which: IndexArray) -> BoolArray:
        """Whether some tracks have come to where something stands still; shape of `which`."""
        if len(which) == 0:
            return np.zeros(0, dtype=bool)
        squares = _squares(sweep.points[still], self._filters.states[which, :2])
        inside = squares < ((self._filters.radii[which] + _GATE_M) ** 2)[:, None]
        return inside.sum(axis=1) >= self._settings.min_points

    def _decide(self) -> None:
        """Who is confirmed, and who moves."""
        facts, settings = self._facts, self._settings
        speeds = np.hypot(self._filters.states[:, 2], self._filters.states[:, 3])
        deviations = self._filters.speed_deviations()
        needed = np.maximum(settings.min_speed, _SIGNIFICANT * deviations)
        needed = np.where(facts["moving"], _STAYS_SHARE * settings.min_speed, needed)
        fast = speeds > needed
        facts["confirmed"] |= fast & (facts["proofs"] >= settings.confirm_scans) & (facts["hits"] >= 3)
        facts["moving"] = facts["confirmed"] & fast

    def _resize(self, sweep: Sweep, hits: IndexArray, counts: IndexArray) -> None:
        """Take the width that was seen; where something hides an end, that may only be too small."""
        which = np.flatnonzero(counts >= self._settings.min_points)
        if len(which) == 0:
            return
        rims = hits[_runs((np.cumsum(counts) - counts)[which], counts[which])]
        begins = np.concatenate([[0], np.cumsum(counts[which])[:-1]])
        widths, distances = _widths(sweep, rims, begins, counts[which], self._filters.states[which, :2])
        whole = sweep.sees_past(rims[begins], -1) & sweep.sees_past(rims[begins + counts[which] - 1], 1)
        radii = self._filters.radii[which]
        halves = 0.5 * widths / np.sqrt(1.0 - np.minimum(0.8, radii / np.maximum(distances, 1e-6)) ** 2)
        grown = radii + _RESIZE_SHARE * (halves - radii)
        grown = np.where(whole, grown, np.maximum(grown, radii))
        grown = np.clip(grown, _LEAST_RADIUS_M, 0.5 * self._settings.max_size)
        self._filters.resize(which, grown, sweep.sensor)

    # What shows that something moves --------------------------------------------------------------------------------

    def _has_left(self, sweep: Sweep) -> BoolArray:
        """Whether the scan sees through where the rim of each track was a little before; shape (K,)."""
        left = np.zeros(len(self._filters), dtype=bool)
        before = next((rim for rim in reversed(self._rims) if rim[0] <= sweep.time - _LEFT_AFTER_S + 1e-6), None)
        if before is None:
            return left
        _, ids, points = before
        index = np.minimum(np.searchsorted(ids, self._facts["id"]), max(len(ids) - 1, 0))
        known = np.flatnonzero(ids[index] == self._facts["id"]) if len(ids) else np.zeros(0, dtype=np.intp)
        if len(known):
            rims = points[index[known]]
            through = sweep.saw_through(rims.reshape(-1, 2), self._settings.same_surface).reshape(rims.shape[:2])
            left[known] = through.mean(axis=1) >= _LEFT_SHARE
        return left

    def _keep_rims(self, sweep: Sweep, hits: IndexArray, counts: IndexArray) -> None:
        which = np.flatnonzero(counts >= self._settings.min_points)
        starts = np.cumsum(counts)[which] - counts[which]
        picked = starts[:, None] + (counts[which][:, None] * _SAMPLES).astype(np.intp)
        self._rims.append((sweep.time, self._facts["id"][which], sweep.points[hits[picked]]))
        while self._rims[0][0] < sweep.time - _KEPT_S:
            self._rims.popleft()

    # Beginning and ending -------------------------------------------------------------------------------------------

    def _begin(self, sweep: Sweep, starts: IndexArray, owners: IndexArray, small: BoolArray, still: BoolArray) -> None:
        """Begin to follow things that belong to no track and have not stood there before."""
        sizes = np.diff(starts)
        if len(sizes) == 0 or len(sweep.points) == 0:
            return
        new = small & (sizes >= self._settings.min_points)
        new &= np.logical_or.reduceat(owners >= 0, starts[:-1]) == 0
        new &= np.add.reduceat(still, starts[:-1], dtype=np.intp) < 0.5 * sizes
        room = _MOST_TENTATIVE - int((~self._facts["confirmed"]).sum())
        chosen = np.flatnonzero(new)[: max(room, 0)]
        if len(chosen) == 0:
            return
        counts = sizes[chosen]
        rims = _runs(starts[chosen], counts)
        begins = np.concatenate([[0], np.cumsum(counts)[:-1]])
        middles = np.add.reduceat(sweep.points[rims], begins, axis=0) / counts[:, None]
        widths, distances = _widths(sweep, rims, begins, counts, middles)
        radii = np.clip(0.5 * widths, _LEAST_RADIUS_M, 0.5 * self._settings.max_size)
        away = (middles - sweep.sensor) / np.maximum(distances, 1e-6)[:, None]
        first = len(self._filters)
        self._filters.add(middles + 0.8 * radii[:, None] * away, radii)
        self._filters.correct(sweep.points[rims], first + np.repeat(np.arange(len(chosen)), counts))
        facts = np.zeros(len(chosen), dtype=_FACTS)
        facts["id"] = self._next_id + np.arange(len(chosen))
        facts["hits"], facts["seen_at"] = 1, sweep.time
        self._next_id += len(chosen)
        self._facts = np.concatenate([self._facts, facts])

    def _end(self) -> None:
        """Forget what is gone, and of two tracks at one place the less certain."""
        facts, filters = self._facts, self._filters
        if len(facts) == 0 or self._time is None:
            return
        silent = self._time - facts["seen_at"]
        hidden, aside = silent - facts["aside_s"], facts["aside_s"]
        kept = hidden <= np.where(facts["confirmed"], self._settings.hidden_s, _TENTATIVE_S)
        kept &= aside <= np.where(facts["confirmed"], self._settings.aside_s, _TENTATIVE_S)
        # What has just turned or sped up, or seems to as less and less of it is visible, may go on in any direction.
        strays = np.hypot(*(filters.states[:, 2:] - facts["mean_velocity"]).T)
        kept &= (hidden <= _JUST_S) | (hidden * strays <= _STRAY_M)
        kept &= facts["empty_s"] <= _EMPTY_S
        kept &= np.hypot(filters.states[:, 2], filters.states[:, 3]) <= _FASTEST_MPS
        kept &= filters.covariances[:, 0, 0] + filters.covariances[:, 1, 1] < _LOST_M**2
        offset = filters.states[:, None, :2] - filters.states[:, :2]
        apart = np.hypot(offset[..., 0], offset[..., 1])
        same = apart < 0.6 * np.maximum.outer(filters.radii, filters.radii)
        # Another part of something large that was followed as two.
        part = apart < np.add.outer(filters.radii, filters.radii) + _GATE_M
        part &= (facts["confirmed"] & (silent <= _JUST_S))[None, :]
        kept &= ~((silent > _EMPTY_S) & part.any(axis=1))
        # Rank: confirmed ones first, and of these the oldest.
        rank = facts["id"] - np.where(facts["confirmed"], self._next_id, 0)
        kept &= ~(same & kept & (rank[None, :] < rank[:, None])).any(axis=1)
        if not kept.all():
            self._filters.keep(kept)
            self._facts = facts[kept]


def _squares(points: FloatArray, centres: FloatArray) -> FloatArray:
    """Squares of the distances of N points from K centres [m²], shape (K, N)."""
    across = np.subtract.outer(centres[:, 0], points[:, 0])
    along = np.subtract.outer(centres[:, 1], points[:, 1])
    across *= across
    along *= along
    across += along
    return across


def _runs(starts: IndexArray, counts: IndexArray) -> IndexArray:
    """Indices of runs, one after the other."""
    begins = np.cumsum(counts) - counts
    return np.repeat(starts - begins, counts) + np.arange(int(counts.sum()))


def _sizes(points: FloatArray, starts: IndexArray) -> FloatArray:
    """Diagonal of the box around each thing [m], shape (T,)."""
    if len(points) == 0:
        return np.zeros(0)
    low, high = np.minimum.reduceat(points, starts[:-1]), np.maximum.reduceat(points, starts[:-1])
    return np.hypot(high[:, 0] - low[:, 0], high[:, 1] - low[:, 1])


def _widths(
    sweep: Sweep, rims: IndexArray, begins: IndexArray, counts: IndexArray, middles: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Width of each thing as seen from the sensor [m], and its distance; rims are its hits, run after run."""
    offset = middles - sweep.sensor
    distances = np.hypot(offset[:, 0], offset[:, 1])
    across = np.column_stack([-offset[:, 1], offset[:, 0]]) / np.maximum(distances, 1e-6)[:, None]
    owner = np.repeat(np.arange(len(counts)), counts)
    aside = (sweep.points[rims] * across[owner]).sum(axis=1)
    widths = np.maximum.reduceat(aside, begins) - np.minimum.reduceat(aside, begins)
    return widths + sweep.spacing * distances, distances
