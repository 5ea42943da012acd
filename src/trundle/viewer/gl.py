"""Finds an OpenGL driver that renders without a screen, and opens a context on it.

MuJoCo chooses a driver on its first import, by MUJOCO_GL. Here the choice is made when the first picture is drawn, so
that it also works if MuJoCo was imported earlier or the variable was never set.
"""

from __future__ import annotations

import ctypes
import functools
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Literal, Protocol

GlKind = Literal["egl", "osmesa"]

PACKAGES = "libegl1 libgl1-mesa-dri libopengl0"
"""Debian packages for EGL with a software driver; libosmesa6 alone works as well, more slowly."""

_EGL_PLATFORM_DEVICE = 0x313F  # EGL_EXT_platform_device
_MAX_DEVICES = 32


class GlContext(Protocol):
    """Has the methods that MuJoCo's EGL and OSMesa contexts share."""

    def make_current(self) -> None:
        """Direct this thread's OpenGL calls to it."""
        ...

    def free(self) -> None:
        """Release the context."""
        ...


@functools.cache
def find_gl() -> GlKind | None:
    """Find a driver that can render without a screen: EGL before OSMesa, or None.

    MUJOCO_GL narrows the choice: `egl` or `osmesa` allow that one, `disable` none; other values allow both.
    """
    wanted = os.environ.get("MUJOCO_GL", "").strip().lower()
    if wanted in ("disable", "disabled", "off", "false", "0") or not sys.platform.startswith("linux"):
        return None
    if wanted != "osmesa" and _egl_works():
        return "egl"
    if wanted != "egl" and _loads("libOSMesa.so.8", "libOSMesa.so.6"):
        return "osmesa"
    return None


def describe_missing_gl() -> str:
    """Return one sentence on what to install for a better picture; empty if a driver was found."""
    if find_gl() is not None:
        return ""
    return (
        "no OpenGL driver was found that renders without a screen, so the picture was drawn in plain software; "
        f"for a better one: apt install {PACKAGES} (or libosmesa6)"
    )


def open_context(kind: GlKind, width: int, height: int) -> GlContext:
    """Open a context for pictures of up to `width` x `height` pixels.

    Raises:
        Exception: Whatever the driver or its bindings raise; they share no base class.
    """
    with _environment({"PYOPENGL_PLATFORM": kind, "EGL_LOG_LEVEL": "fatal"}):
        if kind == "egl":
            from mujoco.egl import GLContext
        else:
            from mujoco.osmesa import GLContext
        context: GlContext = GLContext(width, height)
        context.make_current()
    return context


def _egl_works() -> bool:
    """Return whether EGL initialises one of its devices, queried without PyOpenGL, which can be set up only once."""
    if not _loads("libOpenGL.so.0", "libGL.so.1"):
        return False
    try:
        egl = ctypes.CDLL("libEGL.so.1")
        egl.eglGetProcAddress.restype = ctypes.c_void_p
        egl.eglGetProcAddress.argtypes = [ctypes.c_char_p]
        query_address = egl.eglGetProcAddress(b"eglQueryDevicesEXT")
        display_address = egl.eglGetProcAddress(b"eglGetPlatformDisplayEXT")
    except (OSError, AttributeError):
        return False
    if not query_address or not display_address:
        return False
    pointer, integer = ctypes.c_void_p, ctypes.c_int
    query = ctypes.CFUNCTYPE(integer, integer, ctypes.POINTER(pointer), ctypes.POINTER(integer))(query_address)
    get_display = ctypes.CFUNCTYPE(pointer, ctypes.c_uint, pointer, pointer)(display_address)
    egl.eglInitialize.argtypes = [pointer, pointer, pointer]
    devices, count = (pointer * _MAX_DEVICES)(), integer(0)
    with _environment({"EGL_LOG_LEVEL": "fatal"}):
        if not query(_MAX_DEVICES, devices, ctypes.byref(count)):
            return False
        # The displays stay initialised: another part of the program may hold the same ones.
        for device in devices[: count.value]:
            display = get_display(_EGL_PLATFORM_DEVICE, device, None)
            if display and egl.eglInitialize(display, None, None):
                return True
    return False


def _loads(*names: str) -> bool:
    for name in names:
        try:
            ctypes.CDLL(name)
        except OSError:
            continue
        return True
    return False


@contextmanager
def _environment(values: dict[str, str]) -> Iterator[None]:
    """Set environment variables while a library starts, and restore them."""
    before = {name: os.environ.get(name) for name in values}
    os.environ.update(values)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
