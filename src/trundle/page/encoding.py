"""Arrays and JSON values in the form that the page reads."""

from __future__ import annotations

import base64
import gzip
import io
import json
import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

_KINDS = {"f4": "<f4", "u4": "<u4", "i2": "<i2", "u1": "|u1"}


def pack_array(values: npt.ArrayLike, kind: str) -> dict[str, Any]:
    """An array as {"b64", "dtype", "shape"}, little-endian.

    Args:
        values: The array.
        kind: "f4", "u4", "i2" or "u1".
    """
    array = np.ascontiguousarray(values, dtype=_KINDS[kind])
    return {"b64": base64.b64encode(array.tobytes()).decode(), "dtype": kind, "shape": list(array.shape)}


def unpack_array(value: Mapping[str, Any]) -> npt.NDArray[Any]:
    """The array that `pack_array` packed."""
    content = base64.b64decode(value["b64"], validate=True)
    return np.frombuffer(content, dtype=_KINDS[value["dtype"]]).reshape(value["shape"])


def pack_json(value: object) -> dict[str, str]:
    """A JSON value as {"gzip": base64}; the same value gives the same text."""
    return {"gzip": base64.b64encode(gzip.compress(to_json(value).encode(), 9, mtime=0)).decode()}


def unpack_json(value: Mapping[str, Any], *, most_bytes: int) -> Any:
    """The value that `pack_json` packed.

    Raises:
        ValueError: If it is damaged, or larger than `most_bytes`.
    """
    try:
        packed = base64.b64decode(value["gzip"], validate=True)
        with gzip.GzipFile(fileobj=io.BytesIO(packed)) as stream:
            content = stream.read(most_bytes + 1)
    except (OSError, EOFError, TypeError, KeyError) as error:
        raise ValueError(f"a packed block is damaged: {error}") from error
    if len(content) > most_bytes:
        raise ValueError(f"a packed block is larger than {most_bytes} bytes")
    return json.loads(content)


def to_json(value: object) -> str:
    """JSON without spaces, in ASCII."""
    return json.dumps(value, allow_nan=False, separators=(",", ":"))


def rounded(values: Iterable[float], digits: int = 4) -> list[float]:
    """Numbers for JSON, with so many decimals."""
    return [round(float(value), digits) for value in values]


def finite(value: float | None, digits: int = 4) -> float | None:
    """A number for JSON; none where it is not finite."""
    return round(float(value), digits) if value is not None and math.isfinite(value) else None
