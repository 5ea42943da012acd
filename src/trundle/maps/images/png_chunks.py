"""The chunks of a PNG file (PNG specification, third edition, W3C 2025), checked before any pixel is decoded."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass

from trundle.errors import MapError

SIGNATURE = b"\x89PNG\r\n\x1a\n"
HEADER_BYTES = 33

GREY, RGB, PALETTE, GREY_ALPHA, RGBA = 0, 2, 3, 4, 6
_CHANNELS = {GREY: 1, RGB: 3, PALETTE: 1, GREY_ALPHA: 2, RGBA: 4}
_DEPTHS = {GREY: (1, 2, 4, 8, 16), RGB: (8, 16), PALETTE: (1, 2, 4, 8), GREY_ALPHA: (8, 16), RGBA: (8, 16)}
# Adam7: first column, first row, column step, row step of each pass (section 8.2).
_ADAM7 = ((0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2))
# Deflate never compresses better than 1032 to 1.
_MAX_RATIO = 1032


@dataclass(frozen=True, slots=True)
class PngPass:
    """One pass over the image: the whole of it, or one of Adam7's seven.

    Attributes:
        cols: Pixels per row.
        rows: Number of rows.
        x0: First column.
        y0: First row.
        dx: Columns from one pixel to the next.
        dy: Rows from one row to the next.
    """

    cols: int
    rows: int
    x0: int
    y0: int
    dx: int
    dy: int


@dataclass(frozen=True, slots=True)
class PngHeader:
    """The IHDR chunk of a PNG file."""

    width: int
    height: int
    depth: int
    color_type: int
    interlaced: bool

    @property
    def channels(self) -> int:
        """Samples per pixel."""
        return _CHANNELS[self.color_type]

    def row_bytes(self, width: int) -> int:
        """Bytes of a row of `width` pixels, without its filter byte."""
        return (width * self.channels * self.depth + 7) // 8

    @property
    def decoded_bytes(self) -> int:
        """Memory of the unpacked rows."""
        return self.row_bytes(self.width) * self.height

    @property
    def stream_bytes(self) -> int:
        """Length of the unpacked stream: every row of every pass with its filter byte."""
        return sum(part.rows * (1 + self.row_bytes(part.cols)) for part in self.passes())

    def passes(self) -> list[PngPass]:
        """The passes that hold pixels, in the order of the stream."""
        return [
            PngPass(-(-(self.width - x0) // dx), -(-(self.height - y0) // dy), x0, y0, dx, dy)
            for x0, y0, dx, dy in (_ADAM7 if self.interlaced else ((0, 0, 1, 1),))
            if x0 < self.width and y0 < self.height
        ]


@dataclass(frozen=True, slots=True)
class PngFile:
    """Contents of a PNG file, still compressed.

    Attributes:
        header: Its IHDR chunk.
        palette: Bytes of the PLTE chunk; None where there is none.
        transparency: Bytes of the tRNS chunk.
        packed: The deflate stream of all IDAT chunks.
    """

    header: PngHeader
    palette: bytes | None
    transparency: bytes
    packed: bytes


def parse_header(head: bytes, name: str) -> PngHeader:
    """Read the header from the first bytes of a PNG file; `name` stands for the file in messages.

    Raises:
        MapError: If the file is truncated there, or PNG does not allow this header.
    """
    if len(head) < HEADER_BYTES:
        raise truncated(name)
    length, kind = struct.unpack(">I4s", head[8:16])
    if length != 13 or kind != b"IHDR" or zlib.crc32(head[12:29]) != struct.unpack(">I", head[29:33])[0]:
        raise MapError(f"{name}: the PNG header is damaged; write the image again")
    width, height, depth, color_type, compression, filtering, interlace = struct.unpack(">IIBBBBB", head[16:29])
    if (
        not (0 < width < 2**31 and 0 < height < 2**31)
        or depth not in _DEPTHS.get(color_type, ())
        or compression != 0
        or filtering != 0
        or interlace not in (0, 1)
    ):
        raise MapError(
            f"{name}: PNG does not allow this header ({width} x {height}, depth {depth}, colour type "
            f"{color_type}, interlace {interlace}); write the image again"
        )
    return PngHeader(width, height, depth, color_type, interlace == 1)


def parse_chunks(content: bytes, name: str) -> PngFile:
    """Check the chunks of a whole PNG file, and that its stream is long enough for the pixels that the header claims.

    Raises:
        MapError: If the file is truncated or damaged, or needs a chunk that PNG does not define.
    """
    header = parse_header(content, name)
    palette: bytes | None = None
    transparency = b""
    packed: list[bytes] = []
    for kind, data in _read_chunks(content, name):
        if kind == b"PLTE":
            if len(data) % 3 or not 3 <= len(data) <= 768:
                raise MapError(f"{name}: the PNG palette is damaged ({len(data)} bytes); write the image again")
            palette = data
        elif kind == b"tRNS":
            transparency = data
        elif kind == b"IDAT":
            packed.append(data)
    stream = b"".join(packed)
    if header.stream_bytes > len(stream) * _MAX_RATIO:
        raise truncated(name)
    return PngFile(header, palette, transparency, stream)


def write_chunk(kind: bytes, data: bytes) -> bytes:
    """One chunk with its length and checksum."""
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(data, zlib.crc32(kind)))


def truncated(name: str) -> MapError:
    """The error for a file that ends too early."""
    return MapError(f"{name}: the PNG image is truncated; copy or write it again")


def _read_chunks(content: bytes, name: str) -> Iterator[tuple[bytes, bytes]]:
    position = HEADER_BYTES
    while True:
        if position + 12 > len(content):
            raise truncated(name)
        length, kind = struct.unpack_from(">I4s", content, position)
        end = position + 12 + length
        if end > len(content):
            raise truncated(name)
        data = content[position + 8 : end - 4]
        if zlib.crc32(data, zlib.crc32(kind)) != struct.unpack_from(">I", content, end - 4)[0]:
            raise MapError(f"{name}: the PNG image is damaged at byte {position} (checksum); copy or write it again")
        if kind == b"IEND":
            return
        # An upper-case first letter marks a critical chunk, which a reader must know.
        if kind[0] & 0x20 == 0 and kind not in (b"PLTE", b"IDAT"):
            raise MapError(f"{name}: the PNG image needs the unknown chunk {kind!r}; save it as plain PNG")
        yield kind, data
        position = end
