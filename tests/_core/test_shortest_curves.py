import itertools
import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from support.driving import drive, off_by
from trundle import _core

POSES = st.tuples(
    st.floats(-6.0, 6.0, allow_subnormal=False), st.floats(-6.0, 6.0, allow_subnormal=False), st.floats(-3.1, 3.1)
)
STEERS = (-1.0, 0.0, 1.0)


def curves(starts, goals, radius=1.0, *, reverse):
    return _core.shortest_curves(
        np.atleast_2d(starts).astype(float), np.atleast_2d(goals).astype(float), radius, reverse
    )


def length(start, goal, radius=1.0, *, reverse):
    return float(np.abs(curves(start, goal, radius, reverse=reverse)[0, :, 0]).sum())


@pytest.mark.parametrize(
    ("goal", "forward", "both_ways"),
    [
        ((0, 0, 0), 0.0, 0.0),
        ((5, 0, 0), 5.0, 5.0),
        ((-5, 0, 0), 5 + 2 * math.pi, 5.0),
        ((0, 2, math.pi), math.pi, math.pi),
        ((1, 1, math.pi / 2), math.pi / 2, math.pi / 2),
        ((1, -1, -math.pi / 2), math.pi / 2, math.pi / 2),
        ((-1, 1, -math.pi / 2), None, math.pi / 2),
        ((0, 0, math.pi), 7 * math.pi / 3, math.pi),
        ((6, 2, 0), None, None),
    ],
)
def test_curves_of_known_length(goal, forward, both_ways):
    if forward is not None:
        assert length((0, 0, 0), goal, reverse=False) == pytest.approx(forward)
    if both_ways is not None:
        assert length((0, 0, 0), goal, reverse=True) == pytest.approx(both_ways)
    assert length((0, 0, 0), goal, reverse=True) <= length((0, 0, 0), goal, reverse=False) + 1e-9


@pytest.mark.parametrize("reverse", [False, True])
def test_thousands_of_curves_end_at_their_goals(reverse):
    rng = np.random.default_rng(0)
    starts, goals = (rng.uniform((-9, -9, -3.1), (9, 9, 3.1), (20_000, 3)) for _ in range(2))
    goals[:5000, :2] = starts[:5000, :2] + rng.uniform(-1, 1, (5000, 2))
    for radius in (0.3, 1.0, 4.0):
        pieces = curves(starts, goals, radius, reverse=reverse)
        reached = drive(starts.T, [(pieces[:, k, 0], pieces[:, k, 1]) for k in range(5)])
        assert off_by(reached, goals.T).max() < 1e-9
        assert np.isin(np.round(pieces[:, :, 1] * radius, 12), STEERS).all()
        if not reverse:
            assert pieces[:, :, 0].min() >= 0.0


@given(
    POSES,
    st.lists(st.tuples(st.floats(-4.0, 4.0), st.sampled_from(STEERS)), min_size=1, max_size=7),
    st.sampled_from([0.4, 1.0, 2.5]),
)
@example((0.0, 4.0, 0.5), [(1.7941785315068062e-12, 0.0)], 0.4)
@example((0.0, 2.0, 2.0), [(1.6448448070728896e-05, -1.0), (0.125, -1.0), (3.1499165279632416e-11, 0.0)], 0.4)
@settings(deadline=None, max_examples=150)
def test_no_drive_is_shorter_than_the_shortest_curve_to_where_it_ends(start, drive_pieces, radius):
    for reverse in (True, False):
        driven = [(piece if reverse else abs(piece), steer / radius) for piece, steer in drive_pieces]
        goal = drive(start, driven)
        driven_length = sum(abs(piece) for piece, _ in driven)
        # Where a drive ends on the edge between two words, rounding may put it a whole circle beyond it: look beside,
        # and where it ends if no piece is shorter than what rounding hides.
        longer = drive(start, [(piece + math.copysign(1e-7, piece), steer) for piece, steer in driven])
        beside = [
            np.add(end, shift) for end in (goal, longer) for shift in itertools.product((-1e-7, 0.0, 1e-7), repeat=3)
        ]
        found = min(length(start, end, radius, reverse=reverse) for end in beside)
        assert found <= driven_length + 1e-5


@given(POSES, POSES)
@settings(deadline=None, max_examples=100)
def test_lengths_keep_their_symmetries(start, goal):
    def mirrored(pose):
        return (pose[0], -pose[1], -pose[2])

    def turned_round(pose):
        return (pose[0], pose[1], pose[2] + math.pi)

    there = length(start, goal, reverse=True)
    assert length(goal, start, reverse=True) == pytest.approx(there, abs=1e-6)
    assert length(mirrored(start), mirrored(goal), reverse=True) == pytest.approx(there, abs=1e-6)
    assert length(turned_round(start), turned_round(goal), reverse=True) == pytest.approx(there, abs=1e-6)
    assert there >= math.dist(start[:2], goal[:2]) - 1e-9
    forward = length(start, goal, reverse=False)
    # Near the edge between two words a rounding is a whole circle; those goals say nothing here.
    if all(
        abs(length(start, np.add(goal, shift), reverse=False) - forward) < 1e-3
        for shift in itertools.product((-1e-6, 1e-6), repeat=3)
    ):
        back = length(turned_round(goal), turned_round(start), reverse=False)
        assert back == pytest.approx(forward, abs=1e-6)


def solved_words(goal, words, generator, tries=100):
    """Shortest length of words of three unknowns, each solved numerically from many random guesses (Newton)."""
    best = math.inf
    for word in words:
        unknown = generator.uniform(-4.0, 4.0, (3, tries))
        for _ in range(30):
            error = residual(word, unknown, goal)
            jacobian = np.empty((tries, 3, 3))
            for k in range(3):
                moved = unknown.copy()
                moved[k] += 1e-6
                jacobian[:, :, k] = ((residual(word, moved, goal) - error) / 1e-6).T
            jacobian += 1e-9 * np.eye(3)
            step = np.linalg.solve(jacobian, error.T[:, :, np.newaxis])[:, :, 0].T
            unknown = unknown - np.clip(step, -1.0, 1.0)
        good = np.abs(residual(word, unknown, goal)).max(axis=0) < 1e-8
        if good.any():
            lengths = np.sum([np.abs(piece) * np.ones(tries) for piece, _ in word(*unknown)], axis=0)
            best = min(best, float(lengths[good].min()))
    return best


def residual(word, unknown, goal):
    x, y, yaw = drive((0.0, 0.0, 0.0), word(*unknown))
    return np.array([x - goal[0], y - goal[1], np.remainder(yaw - goal[2] + np.pi, 2 * np.pi) - np.pi])


def word_shapes():
    """Every order of pieces in Reeds and Shepp's list, with signs left open: (8.1) to (8.11) and their symmetries."""
    quarter = math.pi / 2
    for s in (1.0, -1.0):
        yield lambda t, u, v, s=s: [(t, s), (u, 0.0), (v, s)]
        yield lambda t, u, v, s=s: [(t, s), (u, 0.0), (v, -s)]
        yield lambda t, u, v, s=s: [(t, s), (u, -s), (v, s)]
        yield lambda t, u, v, s=s: [(t, s), (u, -s), (u, s), (v, -s)]
        yield lambda t, u, v, s=s: [(t, s), (u, -s), (-u, s), (v, -s)]
        for q in (quarter, -quarter):
            for last in (s, -s):
                yield lambda t, u, v, s=s, q=q, last=last: [(t, s), (q, -s), (u, 0.0), (v, last)]
                yield lambda t, u, v, s=s, q=q, last=last: [(v, last), (u, 0.0), (q, -s), (t, s)]
            yield lambda t, u, v, s=s, q=q: [(t, s), (q, -s), (u, 0.0), (q, s), (v, -s)]


@pytest.mark.slow
def test_no_word_solved_numerically_is_shorter():
    rng = np.random.default_rng(4)
    for goal in rng.uniform((-4, -4, -3.1), (4, 4, 3.1), (6, 3)):
        found = length((0, 0, 0), goal, reverse=True)
        assert solved_words(goal, word_shapes(), rng) == pytest.approx(found, abs=1e-5)


def test_wrong_shapes_and_numbers_are_refused():
    good = np.zeros((2, 3))
    for starts, goals, radius in (
        (np.zeros((2, 2)), np.zeros((2, 2)), 1.0),
        (good, np.zeros((3, 3)), 1.0),
        (good, good, 0.0),
        (good, good, math.nan),
        (good, np.full((2, 3), math.nan), 1.0),
    ):
        with pytest.raises(ValueError, match=r"shape|radius|finite"):
            _core.shortest_curves(starts, goals, radius, True)
