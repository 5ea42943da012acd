"""Cyclone DDS: whether it is here, and the calls that its Python package lacks."""

# Cyclone DDS has no wheel for some Pythons and machines.
# pyright: reportMissingImports=false

from __future__ import annotations

import ctypes
import importlib
import importlib.metadata
import importlib.util
import platform
import sys
from typing import TYPE_CHECKING

from trundle.errors import MissingExtraError, TransportError
from trundle.extras import lacks_wheels, missing_extra

if TYPE_CHECKING:
    from cyclonedds.core import Entity

RETCODE_TIMEOUT = -10
"""A return code of DDS (section 2.3.3 of its specification): a writer that waited for its readers gave up."""


def why_not() -> str:
    """Return why Cyclone DDS cannot be used here, and what to do; "" where it can."""
    try:
        require()
    except (MissingExtraError, TransportError) as error:
        return str(error)
    return ""


def require() -> None:
    """Check that Cyclone DDS can be used.

    Raises:
        MissingExtraError: If it is not installed.
        TransportError: If it has no wheel for this Python and machine, or does not load.
    """
    if importlib.util.find_spec("cyclonedds") is None:
        if lacks_wheels():
            here = f"Python {platform.python_version()} on {sys.platform} {platform.machine()}"
            raise TransportError(
                f"Cyclone DDS has no wheel for {here}. --transport rclpy still works: start in a shell that has "
                "sourced ROS 2"
            )
        raise missing_extra("--transport dds", "cyclonedds", "ros2")
    try:
        importlib.import_module("cyclonedds.core")
    except Exception as error:  # of the loader of its library, or of what it lacks
        raise TransportError(f"Cyclone DDS is installed and does not load: {error}") from error


def version() -> str:
    """Return the installed version of Cyclone DDS."""
    return importlib.metadata.version("cyclonedds")


def every_sample() -> int:
    """Return the mask of Cyclone DDS with which a reader takes all of its samples."""
    from cyclonedds.core import InstanceState, SampleState, ViewState

    return SampleState.Any | ViewState.Any | InstanceState.Any


class _Container(ctypes.Structure):
    """What Cyclone's types for Python take for a sample: the bytes, header included."""

    _fields_ = (("data", ctypes.c_char_p), ("size", ctypes.c_size_t))


class Writing:
    """`dds_write`, called so that other threads of Python run meanwhile; `ddspy_write` would hold them up."""

    def __init__(self) -> None:
        from cyclonedds.internal import DDS

        self._write = DDS._dll_handle["dds_write"]
        self._write.argtypes = (ctypes.c_int32, ctypes.POINTER(_Container))
        self._write.restype = ctypes.c_int32

    def __call__(self, writer: int, data: bytes) -> int:
        """Write to a writer's handle; gives DDS's return code, negative where it failed."""
        return self._write(writer, _Container(data, len(data)))


def delete(entity: Entity) -> None:
    """Delete an entity and all that belongs to it, now and not when Python collects it."""
    from cyclonedds.internal import DDS

    remove = DDS._dll_handle["dds_delete"]
    remove.argtypes, remove.restype = (ctypes.c_int32,), ctypes.c_int32
    result = remove(entity._ref)
    if result < 0:
        raise TransportError(f"Cyclone DDS could not be closed: error {result}")
