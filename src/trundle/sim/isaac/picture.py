"""Pictures from Isaac Sim's renderer. Imported only once the application runs."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from omni.replicator.core import AnnotatorRegistry, create

from trundle.errors import SimulationError

if TYPE_CHECKING:
    import numpy.typing as npt

CAMERA = "/OmniverseKit_Persp"
"""The camera of Isaac Sim's viewport."""

_ROUNDS = 120
"""Limit on updates until a picture arrives; the first ones are slow: textures load and shaders compile."""

_SETTLE = 8
"""Updates after the first picture, until lighting and textures have converged."""


def take_picture(size: tuple[int, int], draw: Callable[[], None]) -> npt.NDArray[np.uint8]:
    """Take a picture with the camera of Isaac Sim's viewport.

    Args:
        size: Width and height [px].
        draw: Renders once.

    Returns:
        RGB, uint8, shape (height, width, 3).

    Raises:
        SimulationError: If there is no picture.
    """
    product = create.render_product(CAMERA, size)
    annotator = AnnotatorRegistry.get_annotator("rgb")
    annotator.attach([product.path])
    try:
        left = _SETTLE
        for _ in range(_ROUNDS):
            draw()
            pixels = np.asarray(annotator.get_data())
            left -= bool(pixels.any())
            if left < 0:
                return pixels.reshape(size[1], size[0], -1)[:, :, :3].astype(np.uint8, copy=True)
    finally:
        annotator.detach()
        product.destroy()
    raise SimulationError(
        f"Isaac Sim rendered nothing in {_ROUNDS} updates: usually the driver is too old for its renderer"
    )
