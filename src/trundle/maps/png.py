"""PNG images, read to their full depth and written, without an image library.

Map values hang on single grey levels, and Pillow reduces 16-bit colour to 8 bit by its own rule; the format is small
enough to read exactly (PNG specification, third edition, W3C 2025).
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from trundle._core import png_unfilter
from trundle.errors import MapError
from trundle.maps.pixels import Pixels, SampleArray

SIGNATURE = b"\x89PNG\r\n\x1a\n"
HEADER_BYTES = 33

_GREY, _RGB, _PALETTE, _GREY_ALPHA, _RGBA = 0, 2, 3, 4, 6
_CHANNELS = {_GREY: 1, _RGB: 3, _PALETTE: 1, _GREY_ALPHA: 2, _RGBA: 4}
_DEPTHS = {_GREY: (1, 2, 4, 8, 16), _RGB: (8, 16), _PALETTE: (1, 2, 4, 8), _GREY_ALPHA: (8, 16), _RGBA: (8, 16)}
# Adam7: first column, first row, column step, row step of each pass (section 8.2).
_ADAM7 = ((0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2))
# Deflate never packs tighter than 1032 to 1.
_MAX_RATIO = 1032


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
        """Samples a pixel."""
        return _CHANNELS[self.color_type]

    @property
    def filter_step(self) -> int:
        """Bytes from a sample to the one before it, as the row filters count."""
        return max(1, self.channels * self.depth // 8)

    def row_bytes(self, width: int) -> int:
        """Bytes of a row of `width` pixels, without its filter byte."""
        return (width * self.channels * self.depth + 7) // 8

    @property
    def decoded_bytes(self) -> int:
        """Memory of the unpacked rows."""
        return self.row_bytes(self.width) * self.height

    def passes(self) -> Iterator[tuple[int, int, int, int]]:
        """First column, first row, column step, row step of each pass that holds pixels."""
        for x0, y0, dx, dy in _ADAM7 if self.interlaced else ((0, 0, 1, 1),):
            if x0 < self.width and y0 < self.height:
                yield x0, y0, dx, dy


def parse_header(head: bytes, name: str) -> PngHeader:
    """Read the header from the first bytes of a PNG file; `name` stands for the file in messages.

    Raises:
        MapError: If the file is cut off there, or the header is none that PNG allows.
    """
    if len(head) < HEADER_BYTES:
        raise _truncated(name)
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
            f"{name}: the PNG header is none that PNG allows ({width} x {height}, depth {depth}, colour type "
            f"{color_type}, interlace {interlace}); write the image again"
        )
    return PngHeader(width, height, depth, color_type, interlace == 1)


def decode_png(content: bytes, name: str) -> Pixels:
    """Decode a whole PNG file. The caller has checked the size that its header claims.

    Raises:
        MapError: If the file is truncated or damaged.
    """
    header = parse_header(content, name)
    palette: npt.NDArray[np.uint8] | None = None
    transparency = b""
    packed: list[bytes] = []
    for kind, data in _read_chunks(content, name):
        if kind == b"PLTE":
            if len(data) % 3 or not 3 <= len(data) <= 768:
                raise MapError(f"{name}: the PNG palette is damaged ({len(data)} bytes); write the image again")
            palette = np.frombuffer(data, dtype=np.uint8).reshape(-1, 3)
        elif kind == b"tRNS":
            transparency = data
        elif kind == b"IDAT":
            packed.append(data)
    samples = _unpack_samples(header, b"".join(packed), name)
    if header.color_type == _PALETTE:
        return _apply_palette(samples[..., 0], palette, transparency, name)
    return _split_channels(header, samples, transparency, name)


def encode_png(samples: npt.NDArray[np.uint8]) -> bytes:
    """Write 8-bit greys, shape (rows, cols), or red, green, blue, alpha, shape (rows, cols, 4), as PNG."""
    rows, cols = samples.shape[:2]
    flat = np.ascontiguousarray(samples).reshape(rows, -1)
    lines = np.empty((rows, flat.shape[1] + 1), dtype=np.uint8)
    lines[:, 0] = 2  # Each row as its difference from the row above: maps are made of walls and blank space.
    lines[0, 1:] = flat[0]
    np.subtract(flat[1:], flat[:-1], out=lines[1:, 1:])
    color_type = _GREY if samples.ndim == 2 else _RGBA
    header = struct.pack(">IIBBBBB", cols, rows, 8, color_type, 0, 0, 0)
    chunks = ((b"IHDR", header), (b"IDAT", zlib.compress(lines.tobytes(), 6)), (b"IEND", b""))
    return SIGNATURE + b"".join(
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)) for kind, data in chunks
    )


def _truncated(name: str) -> MapError:
    return MapError(f"{name}: the PNG image is truncated; copy or write it again")


def _read_chunks(content: bytes, name: str) -> Iterator[tuple[bytes, bytes]]:
    position = HEADER_BYTES
    while True:
        if position + 12 > len(content):
            raise _truncated(name)
        length, kind = struct.unpack_from(">I4s", content, position)
        end = position + 12 + length
        if end > len(content):
            raise _truncated(name)
        data = content[position + 8 : end - 4]
        if zlib.crc32(data, zlib.crc32(kind)) != struct.unpack_from(">I", content, end - 4)[0]:
            raise MapError(f"{name}: the PNG image is damaged at byte {position} (checksum); copy or write it again")
        if kind == b"IEND":
            return
        # An upper-case first letter marks a chunk that a reader must know.
        if kind[0] & 0x20 == 0 and kind not in (b"PLTE", b"IDAT"):
            raise MapError(f"{name}: the PNG image needs the unknown chunk {kind!r}; save it as plain PNG")
        yield kind, data
        position = end


def _unpack_samples(header: PngHeader, packed: bytes, name: str) -> SampleArray:
    """Raw samples, shape (rows, cols, channels), not scaled to their full depth."""
    sizes = [
        (-(-(header.width - x0) // dx), -(-(header.height - y0) // dy), x0, y0, dx, dy)
        for x0, y0, dx, dy in header.passes()
    ]
    expected = sum(rows * (1 + header.row_bytes(cols)) for cols, rows, *_ in sizes)
    if expected > len(packed) * _MAX_RATIO:
        raise _truncated(name)
    try:
        raw = zlib.decompressobj().decompress(packed, expected)
    except zlib.error as error:
        raise MapError(f"{name}: the PNG image is damaged ({error}); copy or write it again") from error
    if len(raw) < expected:
        raise _truncated(name)
    samples = np.empty(
        (header.height, header.width, header.channels), dtype=np.uint16 if header.depth == 16 else np.uint8
    )
    data = np.frombuffer(raw, dtype=np.uint8)
    start = 0
    for cols, rows, x0, y0, dx, dy in sizes:
        row_bytes = header.row_bytes(cols)
        part = data[start : start + rows * (1 + row_bytes)].reshape(rows, 1 + row_bytes)
        start += part.size
        try:
            lines = png_unfilter(part, header.filter_step)
        except ValueError as error:
            raise MapError(f"{name}: the PNG image is damaged ({error}); copy or write it again") from error
        samples[y0::dy, x0::dx] = _widen(lines, header, cols)
    return samples


def _widen(lines: npt.NDArray[np.uint8], header: PngHeader, cols: int) -> SampleArray:
    """Rows of bytes as one sample an element, shape (rows, cols, channels)."""
    rows = len(lines)
    if header.depth == 16:
        return lines.view(">u2").reshape(rows, cols, header.channels)
    if header.depth < 8:
        per_byte = 8 // header.depth
        shifts = np.arange(per_byte - 1, -1, -1, dtype=np.uint8) * header.depth
        lines = (lines[:, :, None] >> shifts & (2**header.depth - 1)).reshape(rows, -1)[:, :cols]
    return lines.reshape(rows, cols, header.channels)


def _apply_palette(index: SampleArray, palette: npt.NDArray[np.uint8] | None, transparency: bytes, name: str) -> Pixels:
    if palette is None:
        raise MapError(f"{name}: the PNG image has no palette though it needs one; write it again")
    if index.max() >= len(palette):
        raise MapError(f"{name}: a pixel names palette entry {index.max()} of {len(palette)}; write the image again")
    if not transparency:
        return Pixels(palette[index])
    opacity = np.full(256, 255, dtype=np.uint8)
    opacity[: len(transparency)] = np.frombuffer(transparency[:256], dtype=np.uint8)
    return Pixels(palette[index], opacity[index])


def _split_channels(header: PngHeader, samples: SampleArray, transparency: bytes, name: str) -> Pixels:
    colors = 3 if header.color_type in (_RGB, _RGBA) else 1
    alpha: SampleArray | None = None
    if header.color_type in (_GREY_ALPHA, _RGBA):
        alpha = samples[..., colors]
    elif transparency:
        if len(transparency) != 2 * colors:
            raise MapError(f"{name}: the PNG transparency is damaged; write the image again")
        key = np.frombuffer(transparency, dtype=">u2")
        full = np.iinfo(samples.dtype).max
        alpha = np.where((samples == key).all(axis=-1), 0, full).astype(samples.dtype)
    colour = samples[..., :colors] if colors == 3 else samples[..., 0]
    if header.depth < 8:
        colour = colour * np.uint8(255 // (2**header.depth - 1))
    return Pixels(colour, alpha)
