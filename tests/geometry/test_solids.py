import math

import pytest

from trundle.geometry import Pose3D
from trundle.geometry.solids import Box, Cylinder, Shape, Solid, Sphere


@pytest.mark.parametrize(
    ("shape", "reach"),
    [(Box((2.0, 0.6, 0.4)), (0.2, 0.3, 1.0)), (Cylinder(0.5, 2.0), (1.0, 0.5, 0.5)), (Sphere(0.7), (0.7, 0.7, 0.7))],
)
def test_the_bounds_of_a_solid_that_lies_on_its_side_touch_it(shape: Shape, reach: tuple[float, ...]) -> None:
    lying = Pose3D.from_rpy((1.0, 2.0, 3.0), (0.0, math.pi / 2.0, 0.0))
    low, high = Solid("it", shape, lying).bounds()
    assert (low + high) / 2.0 == pytest.approx((1.0, 2.0, 3.0))
    assert (high - low) / 2.0 == pytest.approx(reach)
