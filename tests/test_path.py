import math

import numpy as np
import pytest

from trundle.errors import InputError
from trundle.path import Path


def test_a_path_knows_its_length_start_and_goal():
    path = Path(np.array([[0, 0, 0], [3, 4, 0.5], [3, 4, 1.0]]), cost=7.0)
    assert path.length == 5.0
    assert path.start.as_tuple() == (0.0, 0.0, 0.0)
    assert path.goal.as_tuple() == (3.0, 4.0, 1.0)
    assert len(path) == 3


def test_a_path_copies_its_poses_and_cannot_be_written_to():
    poses = np.zeros((2, 3))
    path = Path(poses)
    poses[0, 0] = 1.0
    assert path.poses[0, 0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        path.poses[0, 0] = 1.0


@pytest.mark.parametrize("poses", [np.zeros((0, 3)), np.zeros((2, 2)), np.array([[0.0, math.nan, 0.0]])])
def test_a_path_is_never_empty_and_always_finite(poses):
    with pytest.raises(InputError):
        Path(poses)


def test_a_path_is_driven_forward_unless_it_says_otherwise():
    poses = np.array([[0, 0, 0], [1, 0, 0], [0.5, 0, 0]])
    assert Path(poses).backward.tolist() == [False, False]
    back = np.array([False, True])
    path = Path(poses, backward=back)
    back[0] = True
    assert path.backward.tolist() == [False, True]
    with pytest.raises(ValueError, match="read-only"):
        path.backward[0] = True
    with pytest.raises(InputError, match="2 legs"):
        Path(poses, backward=np.array([True]))
