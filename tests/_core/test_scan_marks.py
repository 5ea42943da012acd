"""Marking, clearing and painting: small cases by hand, and random ones against the same cell by cell."""

import math
import random

import numpy as np
import pytest

from fuzz.fuzz_layers import one_round
from fuzz.loop import play
from trundle._core import mark_scan, paint_marks, unmark_before, unmark_within

NO_OUTLINE = np.zeros((0, 2))
HIT, MISS = 5, 2  # two hits mark, five misses clear
NEUTRAL, TOP = 11, 21


class Cells:
    """Evidence of 10 x 10 cells of 1 m, and scans into it."""

    def __init__(self, side=10):
        self.evidence = np.zeros((side, side), np.uint8)
        self.points = np.zeros((side, side, 2), np.uint8)
        self.times = np.zeros((side, side))

    def scan(self, angles, ranges, pose=(0.5, 0.5, 0.0), limits=(0, 20, 0, 20, 0, 20), outline=NO_OUTLINE, free=True):
        poses = np.atleast_2d(np.array(pose, float))
        beams = np.array(angles, float), np.array(ranges, float)
        limits = np.array(limits, float)
        return mark_scan(
            self.evidence, self.points, self.times, 0, 0, 1.0, poses, *beams, outline, limits, free, HIT, MISS, 7.0
        )

    @property
    def marked(self):
        return np.argwhere(self.evidence & 128).tolist()

    @property
    def seen(self):
        return np.argwhere(self.evidence).tolist()


def test_a_beam_marks_where_it_ends_and_clears_what_it_passes():
    cells = Cells()
    assert cells.scan([0.0], [4.25]) == (0, 1, 0, 5)
    assert cells.seen == [[0, c] for c in range(5)]
    assert cells.marked == []
    assert cells.scan([0.0], [4.25]) == (0, 1, 4, 5)
    assert cells.marked == [[0, 4]]
    assert cells.points[0, 4].tolist() == [192, 128]
    assert cells.times[0, 4] == 7.0
    for _ in range(4):
        assert cells.scan([0.0], [math.inf])[1] <= 1
        assert cells.marked == [[0, 4]]
    cells.scan([0.0], [math.inf])
    assert cells.marked == []


def test_a_cell_that_a_scan_hits_is_not_cleared_by_its_other_beams():
    cells = Cells()
    cells.scan([0.0, 0.0, 0.0], [4.0, 9.0, math.inf])
    assert cells.evidence[0, 4] == NEUTRAL + HIT
    assert cells.evidence[0, 3] == NEUTRAL - MISS  # once, though three beams passed it


def test_hits_behind_others_are_forgotten_unless_they_are_confirmed():
    cells = Cells()
    for _ in range(6):
        cells.scan([0.0], [5.25])
        for _ in range(3):
            cells.scan([0.0], [4.25])
    assert cells.marked == [[0, 4]]
    for _ in range(2):
        cells.scan([0.0], [5.25])
    assert cells.marked == [[0, 4], [0, 5]]
    for _ in range(20):
        cells.scan([0.0], [4.25])
    assert cells.marked == [[0, 4], [0, 5]]  # a mark stays until a beam passes through


@pytest.mark.parametrize("reading", [math.nan, -math.inf, 0.2, 30.0])
def test_readings_that_are_no_ranges_change_nothing(reading):
    cells = Cells()
    assert cells.scan([0.0], [reading], limits=(0.5, 20, 0, 20, 0, 20)) == (0, 0, 0, 0)
    assert cells.seen == []


def test_infinity_clears_only_where_it_is_valid_and_up_to_the_range():
    cells = Cells()
    assert cells.scan([0.0], [math.inf], free=False) == (0, 0, 0, 0)
    cells.scan([0.0], [math.inf], limits=(0, 6, 0, 20, 0, 20))
    assert cells.seen == [[0, c] for c in range(6)]


def test_ranges_limit_where_beams_mark_and_where_they_clear():
    cells = Cells()
    cells.scan([0.0], [8.0], limits=(0, 20, 0, 5, 2, 4))
    assert cells.seen == [[0, 2], [0, 3]]
    cells = Cells()
    cells.scan([0.0], [3.0], limits=(0, 20, 5, 9, 0, 20))
    assert cells.seen == [[0, 0], [0, 1], [0, 2]]


def test_beams_that_end_within_the_outline_are_ignored():
    cells = Cells()
    outline = np.array([(3, 3), (-3, 3), (-3, -3), (3, -3)], float)
    assert cells.scan([0.0], [2.0], outline=outline) == (0, 0, 0, 0)
    assert cells.scan([0.0], [3.5], outline=outline) != (0, 0, 0, 0)


def test_each_beam_may_have_its_own_pose():
    cells = Cells()
    cells.scan([0.0, 0.0], [2.0, 2.0], pose=[(0.5, 0.5, 0.0), (0.5, 3.5, 0.0)])
    assert cells.seen == [[0, 0], [0, 1], [0, 2], [3, 0], [3, 1], [3, 2]]


def test_a_scan_reaches_beyond_the_grid():
    cells = Cells(side=3)
    cells.scan([0.0, math.pi / 2], [15.0, 1.0], pose=(-5.5, 1.5, 0.0))
    assert cells.seen == [[1, 0], [1, 1], [1, 2]]


def test_marks_grow_old():
    cells = Cells()
    cells.scan([0.0], [4.0])
    cells.scan([0.0], [4.0])
    assert unmark_before(cells.evidence, cells.times, 7.0, HIT, MISS) == (0, 0, 0, 0)
    assert unmark_before(cells.evidence, cells.times, 7.5, HIT, MISS) == (0, 1, 4, 5)
    assert cells.marked == []


def test_marks_are_cleared_by_where_they_were_hit():
    cells = Cells()
    for reading in (4.25, 4.25):
        cells.scan([0.0], [reading])
    left = np.array([(0, 0), (4.7, 0), (4.7, 1), (0, 1)], float)
    unmark_within(cells.evidence, cells.points, 0, 0, 1.0, left, HIT, MISS)
    assert cells.marked == [[0, 4]]
    unmark_within(cells.evidence, cells.points, 0, 0, 1.0, left + np.array([0.1, 0.0]), HIT, MISS)
    assert cells.marked == []


def test_painting_puts_marks_where_they_were_hit_and_frees_what_was_seen():
    cells = Cells()
    for _ in range(2):
        cells.scan([0.0], [4.25])
    part = np.full((2, 10), -1, np.int8)
    kept = np.zeros((2, 10), np.uint8)
    paint_marks(cells.evidence, cells.points, 0, 0, 1.0, part, kept, -0.25, 0.0, 0.0, 1.0, False)
    assert part[0].tolist() == [0, 0, 0, 0, 0, 100, -1, -1, -1, -1]
    assert (part[1] == -1).all()
    kept[0, 5] = 1
    part[0, 5] = -1
    paint_marks(cells.evidence, cells.points, 0, 0, 1.0, part, kept, -0.25, 0.0, 0.0, 1.0, False)
    assert part[0, 5] == -1


def test_obstacles_are_cleared_where_space_is_surely_free_if_asked_for():
    cells = Cells()
    part, kept = np.full((1, 4), 100, np.int8), np.zeros((1, 4), np.uint8)
    for count in range(1, 6):
        cells.scan([0.0], [math.inf])
        for clear in (False, True):
            paint_marks(cells.evidence, cells.points, 0, 0, 1.0, part, kept, 0.0, 0.0, 0.0, 1.0, clear)
        assert (part == (0 if count == 5 else 100)).all()


def test_a_grid_may_lie_far_from_the_origin():
    far = 10**9
    evidence, points = np.zeros((3, 9), np.uint8), np.zeros((3, 9, 2), np.uint8)
    pose = np.array([(far + 0.5, far + 1.5, 0.0)])
    box = mark_scan(
        *(evidence, points, np.zeros((0, 0)), far, far, 1.0, pose, np.zeros(1), np.array([4.0]), NO_OUTLINE),
        *(np.array([0, 20, 0, 20, 0, 20.0]), True, HIT, MISS, 0.0),
    )
    assert box == (1, 2, 0, 5)


@pytest.mark.parametrize(
    "change",
    [
        {"resolution": 0.0},
        {"resolution": math.nan},
        {"poses": np.zeros((2, 3))},
        {"poses": np.array([(math.nan, 0.0, 0.0)])},
        {"poses": np.array([(1e300, 0.0, 0.0)])},
        {"ranges": np.zeros(3)},
        {"limits": np.array([0, 1e300, 0, 1e300, 0, 1e300])},
        {"limits": np.array([0, math.nan, 0, 1, 0, 1])},
        {"limits": np.zeros(5)},
        {"hit": 0},
        {"hit": 10, "miss": 7},
        {"points": np.zeros((9, 10, 2), np.uint8)},
        {"times": np.zeros((9, 10))},
        {"outline": np.zeros((4, 3))},
    ],
)
def test_arguments_that_cannot_be_used_are_refused(change):
    arguments = {
        "evidence": np.zeros((10, 10), np.uint8),
        "points": np.zeros((10, 10, 2), np.uint8),
        "times": np.zeros((10, 10)),
        "row": 0,
        "col": 0,
        "resolution": 1.0,
        "poses": np.zeros((1, 3)),
        "angles": np.zeros(1),
        "ranges": np.ones(1),
        "outline": NO_OUTLINE,
        "limits": np.array([0, 20, 0, 20, 0, 20.0]),
        "infinite_is_free": True,
        "hit": HIT,
        "miss": MISS,
        "time": 0.0,
    }
    mark_scan(**arguments)
    with pytest.raises(ValueError, match=r".{10}"):
        mark_scan(**(arguments | change))


@pytest.mark.slow
def test_random_scans_mark_and_clear_what_the_plain_version_does():
    assert play(one_round, seed=random.randrange(10**6), count=60) == 60
