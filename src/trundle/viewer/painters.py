"""Renderers of a model: OpenGL if there is a driver, else trundle's software renderer."""

from __future__ import annotations

import logging
import math
import weakref
from collections.abc import Sequence
from typing import Literal, Protocol

import mujoco
import numpy as np
import numpy.typing as npt

from trundle.viewer.cameras import Camera
from trundle.viewer.gl import GlKind, find_gl, open_context
from trundle.viewer.route import FloorLine, draw_line
from trundle.viewer.scene_model import SHOWN_GROUPS
from trundle.viewer.software import SoftwarePainter

RendererKind = Literal["egl", "osmesa", "software"]
Pixels = npt.NDArray[np.uint8]

_SUN_ASIDE = 0.8
"""How far to the left of the camera's line of sight the sun shines [rad]."""

_MOST_PIECES = 1200
"""How many pieces the lines of a picture may have together."""

_logger = logging.getLogger(__name__)


class Painter(Protocol):
    """Draws pictures of one model."""

    @property
    def kind(self) -> RendererKind:
        """The kind of renderer."""
        ...

    def paint(self, data: mujoco.MjData, camera: Camera, lines: Sequence[FloorLine] = ()) -> Pixels:
        """Draw one picture, shape (height, width, 3), with lines on the floor where OpenGL draws it."""
        ...

    def close(self) -> None:
        """Release its resources; closing twice does nothing."""
        ...


def open_painter(model: mujoco.MjModel, size: tuple[int, int]) -> Painter:
    """Open the best renderer available: EGL, then OSMesa, then software. `size` is (width, height) in pixels."""
    kind = find_gl()
    if kind is not None:
        try:
            return GlPainter(model, size, kind)
        except Exception as error:  # noqa: BLE001 - drivers share no exception class; software always works
            _logger.warning("OpenGL by %s failed (%s); drawing without it", kind, error)
    quality = model.vis.quality
    return SoftwarePainter(
        model, size, SHOWN_GROUPS, samples=int(quality.offsamples), shadow_size=int(quality.shadowsize)
    )


class GlPainter:
    """Draws with OpenGL.

    Args:
        model: The model to draw.
        size: Width and height of the pictures, in pixels.
        kind: The driver, as returned by `find_gl`.

    Raises:
        Exception: Whatever the driver or its bindings raise.
    """

    def __init__(self, model: mujoco.MjModel, size: tuple[int, int], kind: GlKind) -> None:
        self._kind: GlKind = kind
        self._model = model
        self._size = size
        self._context = open_context(kind, *size)
        # An open context at the end of the program makes OSMesa's bindings print an error.
        self._release = weakref.finalize(self, self._context.free)
        self._mjr = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100.value)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self._mjr)
        self._scene = mujoco.MjvScene(model, maxgeom=model.ngeom + 200 + _MOST_PIECES)
        self._option = mujoco.MjvOption()
        self._option.geomgroup[:] = SHOWN_GROUPS

    @property
    def kind(self) -> RendererKind:
        """The driver."""
        return self._kind

    def paint(self, data: mujoco.MjData, camera: Camera, lines: Sequence[FloorLine] = ()) -> Pixels:
        """Draw one picture, shape (height, width, 3), with lines on the floor."""
        azimuth, elevation = camera.angles()
        view = mujoco.MjvCamera()
        view.type = mujoco.mjtCamera.mjCAMERA_FREE.value
        view.lookat[:] = camera.target
        view.distance = camera.distance
        view.azimuth, view.elevation = math.degrees(azimuth), math.degrees(elevation)
        self._model.vis.global_.fovy = camera.fovy_deg
        self._aim_shadows(data, camera)
        everything = mujoco.mjtCatBit.mjCAT_ALL.value
        mujoco.mjv_updateScene(self._model, data, self._option, None, view, everything, self._scene)
        for line in lines:
            draw_line(self._scene, line)
        width, height = self._size
        rect = mujoco.MjrRect(0, 0, width, height)
        pixels = np.empty((height, width, 3), dtype=np.uint8)
        self._context.make_current()
        mujoco.mjr_render(rect, self._scene, self._mjr)
        mujoco.mjr_readPixels(pixels, None, rect, self._mjr)
        return np.ascontiguousarray(pixels[::-1])

    def _aim_shadows(self, data: mujoco.MjData, camera: Camera) -> None:
        """Spread the shadow map over what the camera looks at, and align the sun with the line of sight.

        Beyond the shadow map the floor is speckled, but only towards the sun, so the sun is kept behind the camera.
        """
        reach = 3.0 * camera.distance + 2.0  # half the width of the shadow map [m]
        self._mjr.shadowClip = reach
        azimuth, _ = camera.angles()
        for light in range(self._model.nlight):
            slant = math.hypot(*data.light_xdir[light][:2])
            towards = azimuth + _SUN_ASIDE
            data.light_xdir[light][:2] = slant * math.cos(towards), slant * math.sin(towards)
            data.light_xpos[light] = np.asarray(camera.target) - reach * data.light_xdir[light]

    def close(self) -> None:
        """Free the context."""
        if self._release.alive:
            self._context.make_current()
            self._mjr.free()
            self._release()
