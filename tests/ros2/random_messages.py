"""Messages of any type with random values in every field, for tests of what carries them."""

from __future__ import annotations

from typing import Any

import numpy as np

from trundle.messages import Codec

_LENGTH = 5
"""Elements of a sequence."""


def random_message(codec: Codec, type_name: str, rng: np.random.Generator) -> Any:
    """A message whose numbers have random bits, whose texts are not all ASCII, and whose sequences are not empty."""
    fields = codec.fields(type_name)
    return codec.make(type_name, **{name: _value(codec, field, rng) for name, field in fields.items()})


def _value(codec: Codec, field: Any, rng: np.random.Generator) -> Any:
    from rosbags.interfaces import Nodetype

    what, detail = field
    if what == Nodetype.NAME:
        return random_message(codec, detail, rng)
    if what == Nodetype.BASE:
        return _base(detail[0], rng)
    element, length = detail
    count = length if what == Nodetype.ARRAY else min(_LENGTH, length or _LENGTH)
    if element[0] == Nodetype.BASE and element[1][0] not in ("string", "wstring"):
        return _numbers(element[1][0], count, rng)
    return [_value(codec, element, rng) for _ in range(count)]


def _base(name: str, rng: np.random.Generator) -> Any:
    if name in ("string", "wstring"):
        return f"Straße_{rng.integers(1 << 30)}"
    return _numbers("int8" if name == "byte" else name, 1, rng)[0].item()  # rosbags writes single bytes so


def _numbers(name: str, count: int, rng: np.random.Generator) -> Any:
    name = {"byte": "uint8", "char": "uint8"}.get(name, name)
    if name == "bool":
        return rng.integers(0, 2, count).astype(bool)
    if name.startswith("float"):  # random bits would make some NaN, which differ from themselves
        return rng.normal(0.0, 1e6, count).astype(name)
    kind = np.iinfo(name)
    return rng.integers(kind.min, kind.max, count, dtype=name, endpoint=True)
