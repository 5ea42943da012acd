"""BMP images: the header is read here, to check sizes before decoding; Pillow decodes the pixels."""

from __future__ import annotations

import io
import struct
from dataclasses import dataclass

import numpy as np

from trundle.errors import MapError
from trundle.files.opening import parser_reason
from trundle.maps.images.pixels import Pixels

SIGNATURE = b"BM"

_FILE_HEADER_BYTES = 14
_CORE_HEADER_BYTES = 12
_INFO_HEADER_BYTES = (40, 52, 56, 64, 108, 124)
_DEPTHS = (1, 4, 8, 16, 24, 32)
_PLAIN, _RLE8, _RLE4, _BITFIELDS = range(4)
_COMPRESSIONS = {_PLAIN: _DEPTHS, _RLE8: (8,), _RLE4: (4,), _BITFIELDS: (16, 32)}


@dataclass(frozen=True, slots=True)
class BmpHeader:
    """The headers of a BMP file.

    Attributes:
        width: Width [pixels].
        height: Height [pixels], whichever row is the first in the file.
        depth: Bits a pixel.
        compression: 0 for plain rows, 1 and 2 for run-length encoding, 3 for plain rows with bit masks.
        offset: Where the pixels start.
    """

    width: int
    height: int
    depth: int
    compression: int
    offset: int

    @property
    def decoded_bytes(self) -> int:
        """Memory of the pixels: greys, or red, green, blue and alpha."""
        return self.width * self.height * (1 if self.depth <= 8 else 4)

    @property
    def raster_bytes(self) -> int:
        """Length of the plain rows, each padded to a multiple of four bytes."""
        return (self.width * self.depth + 31) // 32 * 4 * self.height

    @property
    def is_packed(self) -> bool:
        """Whether the rows are run-length encoded, so their length is unknown."""
        return self.compression in (_RLE8, _RLE4)


def parse_header(head: bytes, name: str) -> BmpHeader:
    """Read the headers from the first bytes of a BMP file; `name` stands for the file in messages.

    Raises:
        MapError: If the file is truncated there, or BMP does not allow these headers.
    """
    try:
        offset, size = struct.unpack_from("<II", head, 10)
        if size == _CORE_HEADER_BYTES:
            width, height, planes, depth = struct.unpack_from("<HHHH", head, 18)
            compression = _PLAIN
        else:
            width, height, planes, depth, compression = struct.unpack_from("<iiHHI", head, 18)
    except struct.error as error:
        raise MapError(f"{name}: the BMP file is truncated in its header; write the image again") from error
    if (
        size not in (_CORE_HEADER_BYTES, *_INFO_HEADER_BYTES)
        or width <= 0
        or height == 0
        or planes != 1
        or depth not in _COMPRESSIONS.get(compression, ())
        or offset < _FILE_HEADER_BYTES + size
    ):
        raise MapError(
            f"{name}: the BMP header is not supported ({width} x {height}, {depth} bits per pixel, compression "
            f"{compression}); write the image again, as PNG or PGM"
        )
    return BmpHeader(width, abs(height), depth, compression, offset)


def decode_bmp(content: bytes, name: str) -> Pixels:
    """Decode a whole BMP file. The caller has checked the size that its header claims.

    Raises:
        MapError: If the file is truncated or damaged.
    """
    from PIL import BmpImagePlugin

    header = parse_header(content, name)
    if not header.is_packed and len(content) < header.offset + header.raster_bytes:
        raise MapError(
            f"{name}: the BMP file is truncated after {len(content)} of {header.offset + header.raster_bytes} bytes; "
            "copy or write it again"
        )
    try:
        # Not Image.open: it warns about large images, and the size has been checked already.
        with BmpImagePlugin.BmpImageFile(io.BytesIO(content)) as image:
            if image.mode in ("1", "L"):
                return Pixels(np.asarray(image.convert("L")))
            with_alpha = image.mode == "RGBA"
            samples = np.asarray(image.convert("RGBA" if with_alpha else "RGB"))
    except Exception as error:  # Pillow's reader may raise anything on damaged bytes
        raise MapError(f"{name}: the BMP file is damaged ({parser_reason(error)}); write the image again") from error
    return Pixels(samples[..., :3], samples[..., 3] if with_alpha else None)
