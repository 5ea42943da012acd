"""All tests of this folder need the extra `gym`."""

import pytest

from support.warp_device import device  # noqa: F401 - a fixture

collect_ignore_glob: list[str] = []
try:
    import gymnasium  # noqa: F401
except ImportError:
    collect_ignore_glob = ["test_env.py", "test_vector_env.py", "test_observations.py", "test_public_worlds.py"]


@pytest.fixture(scope="session")
def quick_options():
    """A small environment: two small mazes, a robot with one lidar."""
    return {
        "world": "maze",
        "worlds": 2,
        "world_options": {"rows": 3, "columns": 3},
        "robot": "turtlebot3_burger",
        "beams": 36,
        "min_distance": 2.0,
    }
