from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from support import mppi_oracle as oracle
from support.mppi_requests import EMPTY, random_request, request_of
from trundle._core import Mppi

STRAIGHT = oracle.SPEEDS.index(1.0) * len(oracle.TURNS) + oracle.TURNS.index(0.0)  # at full speed
BEST = Mppi(128, 2, 1).level


def run(request, level=None):
    kernel = Mppi(request.samples, request.steps, request.knot_steps, level)
    arguments = request.arguments()
    answer = kernel.step(*arguments)
    return kernel, arguments[1], answer


def drives(request, ticks):
    """States of a robot that does what the kernel says, from tick to tick."""
    kernel = Mppi(request.samples, request.steps, request.knot_steps)
    x, y, yaw, v, w, *_ = request.state
    controls, dt = request.controls.copy(), request.model[0]
    for _ in range(ticks):
        state = np.array([x, y, yaw, v, w, 0.0, 0.0])
        arguments = list(dataclasses.replace(request, state=state).arguments())
        arguments[1] = controls
        v, w, *_ = kernel.step(*arguments)
        x, y, yaw = x + v * dt * math.cos(yaw + w * dt / 2), y + v * dt * math.sin(yaw + w * dt / 2), yaw + w * dt
        yield x, y, yaw, v, w


@pytest.mark.parametrize("seed", range(12))
def test_samples_costs_and_answer_are_those_of_the_oracle(seed):
    request = random_request(np.random.default_rng(seed))
    kernel, controls, (v, w, cost, best, free, blocked, contacts, dropped, _, heat, effective, taken) = run(request)
    expected = oracle.step(request)
    assert np.allclose(kernel.costs(), expected.costs, rtol=1e-5, atol=1e-5)
    assert (free, blocked, dropped) == (expected.free.sum(), (~expected.free).sum(), 0)
    assert contacts == expected.contacts.sum()
    assert taken == expected.best_taken
    assert best == pytest.approx(expected.costs.min(), rel=1e-5, abs=1e-5)
    assert cost == pytest.approx(expected.cost, rel=1e-4, abs=1e-4)
    assert heat == pytest.approx(expected.temperature, rel=1e-3)
    assert effective == pytest.approx(expected.effective, rel=1e-3)
    assert np.allclose(controls, expected.controls, atol=1e-4)
    assert (v, w) == tuple(controls[0])


@pytest.mark.parametrize("seed", range(12))
def test_wide_registers_give_the_same_bits(seed):
    request = random_request(np.random.default_rng(100 + seed))
    (wide, wide_controls, wide_answer), (base, controls, answer) = run(request, BEST), run(request, "base")
    assert wide_answer == answer
    assert wide.costs().tobytes() == base.costs().tobytes()
    assert wide_controls.tobytes() == controls.tobytes()
    assert all(a.tobytes() == b.tobytes() for a, b in zip(wide.rollouts(20), base.rollouts(20), strict=True))


def test_rollouts_are_the_cheapest_courses_in_order():
    request = random_request(np.random.default_rng(5))
    kernel, _, _ = run(request)
    poses, costs = kernel.rollouts(30)
    order = np.argsort(kernel.costs(), kind="stable")[:30]
    assert (costs == kernel.costs()[order]).all()
    courses = oracle.step(request).courses
    expected = np.stack([courses.x, courses.y], axis=2)[order] * request.resolution
    assert np.allclose(poses[:, 1:, :2], expected, atol=1e-4)
    assert np.allclose(np.cos(poses[:, 1:, 2]), courses.cos[order], atol=1e-5)
    x, y, yaw = request.state[:3]
    assert np.allclose(poses[:, 0], (x, y, math.remainder(yaw, math.tau)), atol=1e-5)
    assert [len(part) for part in kernel.rollouts(10**6)] == [request.samples] * 2
    assert [part.shape for part in Mppi(128, 5, 2).rollouts(3)] == [(0, 6, 3), (0,)]


def test_the_same_seed_gives_the_same_answer_and_another_one_another():
    request = random_request(np.random.default_rng(8))
    other = dataclasses.replace(request, noise=request.noise + np.eye(5)[3])
    answers = [run(each)[2] for each in (request, request, other)]
    assert answers[0] == answers[1] != answers[2]


def test_the_new_controls_keep_all_limits():
    for seed in range(10):
        request = random_request(np.random.default_rng(seed))
        dt, v_min, v_max, w_max, faster, slower, turn = request.model
        controls = run(request)[1].astype(float)
        v, w = np.append(request.state[3], controls[:, 0]), np.append(request.state[4], controls[:, 1])
        most = np.where(v[:-1] * np.sign(np.diff(v)) < 0, slower, faster) * dt
        assert (np.abs(np.diff(v)) <= most + 1e-5).all()
        assert (np.abs(np.diff(w)) <= turn * dt + 1e-5).all()
        beyond = np.maximum(v[1:] - v_max, v_min - v[1:])
        assert (beyond <= np.maximum(np.maximum(v[:-1] - v_max, v_min - v[:-1]), 0.0) + 1e-5).all()
        assert (np.abs(w[1:]) <= np.maximum(w_max, np.abs(w[:-1])) + 1e-5).all()


def test_it_drives_to_a_goal_ahead_and_stops_there():
    *_, (x, y, _, v, _) = drives(request_of(goal=(3.0, 2.0)), 120)
    assert math.hypot(x - 3.0, y - 2.0) < 0.05
    assert abs(v) < 0.05


def test_it_turns_round_in_place_where_the_goal_is_behind():
    poses = list(drives(request_of(goal=(0.5, 2.0)), 150))
    turned = next(i for i, pose in enumerate(poses) if abs(pose[2]) > 2.4)
    assert max(abs(x - 2.0) for x, *_ in poses[:turned]) < 0.25
    assert math.hypot(poses[-1][0] - 0.5, poses[-1][1] - 2.0) < 0.1


def test_it_reverses_to_a_goal_behind_where_that_is_the_direction():
    poses = list(drives(request_of(goal=(1.0, 2.0), direction=-1.0), 80))
    assert max(abs(yaw) for _, _, yaw, _, _ in poses) < 0.4
    assert abs(poses[-1][0] - 1.0) < 0.1


def test_it_turns_to_the_goals_yaw():
    *_, (x, y, yaw, _, _) = drives(request_of(goal=(2.6, 2.0), goal_yaw=1.5), 150)
    assert math.hypot(x - 2.6, y - 2.0) < 0.1
    assert abs(yaw - 1.5) < 0.2


@pytest.mark.parametrize("acceleration", [0.3, 2.5])
def test_it_arrives_with_high_and_low_accelerations(acceleration):
    model = np.array([0.05, -0.3, 0.6, 1.0, acceleration, acceleration, 3.0])
    *_, (x, _, _, v, _) = drives(dataclasses.replace(request_of(goal=(3.2, 2.0)), model=model), 200)
    assert abs(x - 3.2) < 0.08
    assert abs(v) < 0.08


def test_it_waits_for_a_mover_that_crosses_and_drives_on_where_there_is_none():
    crossing = np.array([[3.0, 0.5, 0.0, 0.7, 0.3, 1e-4, 1e-4]])
    request = request_of(goal=(3.8, 2.0))
    alone, beside = (run(dataclasses.replace(request, movers=movers)) for movers in (np.zeros((0, 7)), crossing))
    assert alone[2][6] == 0 < beside[2][6]
    # The mover is at (3, 2) after 2.1 s: the robot is further from there with it than without.
    poses = [kernel.rollouts(1)[0][0] for kernel, *_ in (alone, beside)]
    distances = [math.hypot(course[43, 0] - 3.0, course[43, 1] - 2.0) for course in poses]
    assert distances[1] > 0.5 > distances[0] - 0.5


def test_driving_into_an_uncertain_mover_costs_less_than_into_a_sure_one():
    request, row = request_of(goal=(3.8, 2.0)), [3.0, 2.0, 0.0, 0.0, 0.3]
    sure, unsure = (dataclasses.replace(request, movers=np.array([[*row, 1e-4, variance]])) for variance in (1e-4, 0.5))
    straight = [kernel.costs()[STRAIGHT] for kernel, *_ in (run(sure), run(unsure))]
    assert straight[0] > straight[1] + 10.0


def test_touching_a_mover_late_costs_less_than_soon():
    weights = EMPTY.weights.copy()
    weights[9] = 0.0  # of being near one
    request = dataclasses.replace(request_of(goal=(3.8, 2.0)), weights=weights)
    movers = (np.array([[x, 2.0, 0.0, 0.0, 0.3, 1e-4, 1e-4]]) for x in (2.6, 3.4))
    soon, late = (run(dataclasses.replace(request, movers=row))[0].costs()[STRAIGHT] for row in movers)
    assert soon > late + 5.0


def test_where_few_samples_touch_no_mover_only_these_take_effect():
    # It comes from ahead, and most samples do not get out of its way.
    mover, noise = np.array([[3.4, 2.0, -0.4, 0.0, 0.5, 1e-4, 1e-4]]), EMPTY.noise.copy()
    noise[2] = 0.3
    request = dataclasses.replace(request_of(goal=(3.8, 2.0)), movers=mover, noise=noise)
    _, _, answer = run(request)
    free, contacts, effective = answer[4], answer[6], answer[10]
    assert 4 <= free - contacts < 0.3 * request.samples
    assert effective == pytest.approx(0.5 * (free - contacts), rel=0.05)


def test_nothing_free_is_counted_and_a_start_in_contact_may_be_left():
    request = request_of(goal=(3.0, 2.0))
    blocked = dataclasses.replace(request, nearness=np.full_like(request.nearness, 255))
    _, controls, answer = run(blocked)
    assert answer[8] == 1
    # No nearer than at the start is as free as at the start.
    assert answer[4] == request.samples
    assert np.isfinite(controls).all()
    wall = np.full_like(request.nearness, 254)
    wall[30:50, 30:50] = 0  # the robot stands in a box, and every motion of it within
    narrow = dataclasses.replace(request, nearness=wall, discs=np.array([(0.0, 0.1)]))
    free = run(narrow)[2][4]
    assert 0 < free < request.samples


def test_unreachable_cells_and_numbers_that_are_none_do_not_spread():
    request = request_of(goal=(3.0, 2.0))
    for value in (math.inf, math.nan, -math.inf, 1e38, -1e38):
        to_go = request.to_go.copy()
        to_go[::3, ::2] = value
        kernel, controls, answer = run(dataclasses.replace(request, to_go=to_go))
        assert np.isfinite(kernel.costs()).all()
        assert np.isfinite(controls).all()
        assert answer[7] == 0
    everywhere = dataclasses.replace(request, to_go=np.full_like(request.to_go, math.inf))
    assert np.isfinite(run(everywhere)[1]).all()


def test_samples_whose_cost_is_no_number_are_dropped_and_counted():
    request = request_of(goal=(3.0, 2.0))
    nearness = np.full_like(request.nearness, 255)
    nearness[:41, :41] = 0  # costs of those that leave this corner exceed what a number holds
    wild = dataclasses.replace(
        request,
        nearness=nearness,
        state=np.array([2.0, 2.0, 0.0, 1e6, 0.0, 0.0, 0.0]),
        model=np.array([1.0, -0.4, 1e6, 1.0, 1e6, 1e6, 3.0]),
        discs=np.array([(0.0, 1e5)]),
        unit=1e3,
        weights=np.full(15, 1e6),
        bounds=np.zeros(5),
    )
    kernel, controls, answer = run(wild)
    costs = kernel.costs()
    assert answer[7] == (~np.isfinite(costs)).sum() > 0
    assert answer[4] + answer[5] + answer[7] == request.samples
    assert np.isfinite(controls).all()
    assert np.isfinite(answer[:3]).all()


def test_last_controls_that_are_no_numbers_count_as_zero():
    request = request_of(goal=(3.0, 2.0))
    spoiled = dataclasses.replace(request, controls=np.full_like(request.controls, math.nan))
    assert run(spoiled)[2] == run(request)[2]


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("state", np.full(7, math.nan), "state must be finite"),
        ("controls", np.zeros((4, 2), np.float32), "controls need shape"),
        ("model", np.array([0.0, 0, 1, 1, 1, 1, 1]), "dt must be"),
        ("model", np.array([0.05, 0, 1, 1, 0, 1, 1]), "accelerations must be"),
        ("model", np.array([0.05, 0.1, 1, 1, 1, 1, 1]), "v_min must be at most 0"),
        ("model", np.array([0.05, 0, 1, 30, 1, 1, 1]), "turn by at most 1 rad"),
        ("noise", np.array([0.1, 0.1, 0.0, 1, 1]), "share must be above 0"),
        ("noise", np.array([-0.1, 0.1, 0.1, 1, 1]), "deviations"),
        ("noise", np.array([0.1, 0.1, 0.1, -1, 1]), "seed and the shift"),
        ("discs", np.zeros((0, 2)), "discs need shape"),
        ("discs", np.array([(0.0, -0.1)]), "radii must be at least 0"),
        ("nearness", np.zeros((1, 9), np.uint8), "window needs"),
        ("to_go", np.zeros((9, 9), np.float32), "same shape"),
        ("resolution", 0.0, "resolution must be"),
        ("unit", math.nan, "unit must be"),
        ("goal", np.full(7, math.inf), "aim must be finite"),
        ("movers", np.full((1, 7), math.nan), "movers must be finite"),
        ("movers", np.array([(0.0, 0, 0, 0, 1, -1, 0)]), "variances must be at least 0"),
        ("weights", np.full(15, -1.0), "weights must be within"),
        ("bounds", np.full(5, math.nan), "bounds must be within"),
    ],
)
def test_bad_arguments_are_refused(name, value, message):
    request = dataclasses.replace(request_of(goal=(3.0, 2.0)), **{name: value})
    kernel = Mppi(request.samples, request.steps, request.knot_steps)
    with pytest.raises(ValueError, match=message):
        kernel.step(*request.arguments())


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((100, 20, 5), "multiple of 16"),
        ((2008, 20, 5), "multiple of 16"),
        ((128, 1, 1), "steps must be from 2"),
        ((128, 20, 0), "from knot to knot"),
        ((128, 20, 21), "from knot to knot"),
        ((128, 20, 5, "sse"), "base or avx2"),
    ],
)
def test_sizes_out_of_range_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        Mppi(*arguments)


def test_a_window_without_anything_in_it_is_open():
    assert run(request_of(goal=(3.0, 2.0)))[2][4:6] == (EMPTY.samples, 0)
