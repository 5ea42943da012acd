"""A state's contacts are all those of its control period, of every physics step in it, and not those of another."""

import pytest

from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.geometry.solids import Box, Solid
from trundle.sim import simulate
from trundle.worlds import World

TAIL, NOSE = -0.607, 0.14  # Nova Carter's footprint along x


def box(name: str, x0: float, x1: float, y: float = 0.0) -> Solid:
    return Solid(name, Box((x1 - x0, 0.2, 0.4)), Pose3D((0.5 * (x0 + x1), y, 0.2)))


def touched(backend: str, solids: list[Solid], speed: float, dt: float, periods: int = 1) -> list[list[str]]:
    """Names that are touched in each control period of a drive along x from the origin."""
    with simulate(World("room", tuple(solids)), "nova_carter", backend=backend) as simulator:
        simulator.reset(Pose2D(0.0, 0.0))
        return [[contact.other for contact in simulator.step(Twist2D(speed, 0.0), dt).contacts] for _ in range(periods)]


@pytest.mark.parametrize("backend", ["mujoco", "kinematic"])
def test_what_is_touched_at_once_is_all_reported(backend: str) -> None:
    pair = [box("left", 0.4, 0.6, 0.15), box("right", 0.4, 0.6, -0.15)]
    (names,) = touched(backend, pair, 0.5, 1.5)
    assert set(names) == {"left", "right"}


@pytest.mark.parametrize("backend", ["mujoco", "kinematic"])
def test_what_is_touched_in_the_first_steps_and_in_the_last_is_all_reported(backend: str) -> None:
    behind, ahead = box("behind", TAIL - 0.4, TAIL + 0.002), box("ahead", NOSE + 0.5, NOSE + 0.7)
    (both,) = touched(backend, [behind, ahead], 0.5, 2.0)
    assert both == ["behind", "ahead"]
    each = touched(backend, [behind, ahead], 0.5, 0.05, periods=40)
    assert each[0] == ["behind"]
    assert each[-1] == ["ahead"]
    assert [] in each
