"""Directions of beams: sine and cosine of many angles at once."""

import math

import numpy as np
import pytest

from trundle._core import cast_outline_rays, place_scan

NOTHING, HERE = np.zeros(0), np.zeros(3)


def directions_of(angles, yaw):
    """Cosines and sines of angles + yaw, as a scan with ranges of 1 m is placed by them."""
    mount = np.array([0.0, 0.0, yaw])
    points, *_ = place_scan(
        *(np.ones(len(angles)), angles, mount, HERE, np.zeros((0, 3)), 0.1, 2.0, mount, NOTHING, NOTHING, mount)
    )
    return points


@pytest.mark.parametrize("size", [1e-9, 0.02, 1.0, 7.0, 1e3, 9e5, 2e6, 1e12])
def test_they_are_those_of_numpy(size):
    rng = np.random.default_rng(1)
    angles, yaw = rng.uniform(-size, size, 721), float(rng.uniform(-size, size))
    expected = np.column_stack([np.cos(angles + yaw), np.sin(angles + yaw)])
    assert np.abs(directions_of(angles, yaw) - expected).max() < 1e-15


def test_quarter_turns_and_their_halves_are_exact_to_the_last_place():
    angles = np.arange(-16, 17) * (math.pi / 4.0)
    expected = np.column_stack([np.cos(angles), np.sin(angles)])
    assert np.abs(directions_of(angles, 0.0) - expected).max() < 3e-16


@pytest.mark.parametrize("turns", [0, 3, -1000, 10**6, 10**9])
def test_rays_meet_a_wall_whatever_turns_they_have_made(turns):
    step = math.tau / 720
    first = turns * math.tau - 0.5
    wall = np.array([(2.0, -9.0, 2.0, 9.0)])
    found = cast_outline_rays(wall, np.zeros((0, 3)), 0.0, 0.0, first, step, 90, 20.0)
    angles = math.remainder(first, math.tau) + step * np.arange(90)
    assert found == pytest.approx(2.0 / np.cos(angles), rel=1e-12)
