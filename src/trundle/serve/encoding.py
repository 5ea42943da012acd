"""JSON as pages get it."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence


def encode(value: object) -> str:
    """JSON on one line; numbers that are not finite, which JSON does not have, become null."""
    try:
        return json.dumps(value, separators=(",", ":"), allow_nan=False)
    except ValueError:
        return json.dumps(_finite(value), separators=(",", ":"), allow_nan=False)


def encode_message(kind: str, **fields: object) -> str:
    """A message of this type."""
    return encode({"type": kind, **fields})


def encode_items(values: Sequence[object]) -> str:
    """The items of a JSON array, without its brackets."""
    return encode(list(values))[1:-1]


def _finite(value: object) -> object:
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    return value
