"""PNG samples of 16 bits in more than one channel.

Pillow reduces 16-bit colour to 8 bits, and the state of a cell may depend on the lower eight.
"""

from __future__ import annotations

import zlib

import numpy as np
import numpy.typing as npt

from trundle._core import png_unfilter
from trundle.errors import MapError
from trundle.maps.images.png_chunks import PngFile, truncated


def unpack_samples(file: PngFile, name: str) -> npt.NDArray[np.uint16]:
    """Samples of an image of depth 16, shape (rows, cols, channels).

    Raises:
        MapError: If the stream ends too early or is damaged.
    """
    header = file.header
    try:
        raw = zlib.decompressobj().decompress(file.packed, header.stream_bytes)
    except zlib.error as error:
        raise MapError(f"{name}: the PNG image is damaged ({error}); copy or write it again") from error
    if len(raw) < header.stream_bytes:
        raise truncated(name)
    samples = np.empty((header.height, header.width, header.channels), dtype=np.uint16)
    data = np.frombuffer(raw, dtype=np.uint8)
    start = 0
    for part in header.passes():
        line_bytes = 1 + header.row_bytes(part.cols)
        lines = data[start : start + part.rows * line_bytes].reshape(part.rows, line_bytes)
        start += lines.size
        try:
            rows = png_unfilter(lines, 2 * header.channels)
        except ValueError as error:
            raise MapError(f"{name}: the PNG image is damaged ({error}); copy or write it again") from error
        samples[part.y0 :: part.dy, part.x0 :: part.dx] = rows.view(">u2").reshape(part.rows, part.cols, -1)
    return samples
