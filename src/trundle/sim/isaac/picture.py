"""Pictures by Isaac Sim's renderer. Imported when the application runs, and not before."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from omni.replicator.core import AnnotatorRegistry, create

from trundle.errors import SimulationError

if TYPE_CHECKING:
    import numpy.typing as npt

CAMERA = "/OmniverseKit_Persp"
"""The camera of Isaac Sim's own view."""

_ROUNDS = 120
"""Of drawing, in which a picture must come; the first take long, as textures are loaded and shaders compiled."""

_SETTLE = 8
"""Rounds after the first picture, in which light and textures get sharp."""


def take_picture(size: tuple[int, int], draw: Callable[[], None]) -> npt.NDArray[np.uint8]:
    """Take a picture with the camera of Isaac Sim's own view.

    Args:
        size: Width and height [px].
        draw: Lets Isaac Sim draw once.

    Returns:
        RGB, uint8, shape (height, width, 3).

    Raises:
        SimulationError: If no picture comes.
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
        f"Isaac Sim drew nothing in {_ROUNDS} rounds: a black view is mostly a driver that is too old for its renderer"
    )
