"""The batch on a GPU, by NVIDIA Warp; needs the extra `gpu`."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from trundle.errors import InputError

if TYPE_CHECKING:
    from trundle.sim.batch.arrays import BatchModel
    from trundle.sim.batch.recording import MoverRecording
    from trundle.sim.batch.warp.engine import WarpEngine


def make_engine(name: str) -> Callable[[BatchModel, Sequence[MoverRecording], int], WarpEngine]:
    """Return what makes the state of a batch on a device, `cuda` or `cuda:1`.

    Raises:
        InputError: If this machine has no such device.
    """
    device = find_device(name)

    from trundle.sim.batch.warp.engine import WarpEngine

    return functools.partial(WarpEngine, device=device)


def find_device(name: str) -> Any:
    """Return a device of Warp's.

    Raises:
        InputError: If this machine has no such device.
    """
    import warp as wp

    level, wp.config.log_level = wp.config.log_level, wp.LOG_WARNING  # else it prints what it is
    try:
        wp.init()
    finally:
        wp.config.log_level = level
    found = [device.alias for device in wp.get_cuda_devices()]
    if name != "cpu" and (not found or name not in ("cuda", *found)):
        has = f"it has {', '.join(found)}" if found else "it has none, or no driver for it (nvidia-smi shows both)"
        raise InputError(f'device="{name}": this machine has no such GPU of NVIDIA\'s: {has}; use device="cpu"')
    return wp.get_device(name)
