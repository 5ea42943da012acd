"""What the stand-in raises where Isaac Sim would not take a call."""

import numpy as np


class Refused(AssertionError):  # noqa: N818
    """Isaac Sim would not have taken this call."""


def check_shape(name, key, value, shape):
    """Refuse an array of another shape, as far as Isaac Sim would not broadcast it."""
    if value is None:
        return
    given = np.shape(value)
    if len(given) != len(shape) or any(want not in (-1, has) for want, has in zip(shape, given, strict=True)):
        raise Refused(f"{name}: {key} has the shape {given}, not {shape}")
