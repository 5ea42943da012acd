"""PNG images, read at full depth and written; by Pillow except for 16-bit colour."""

from __future__ import annotations

import io
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from trundle._core import png_unfilter
from trundle.errors import MapError
from trundle.files.opening import parser_reason
from trundle.maps.images.pixels import Pixels, SampleArray

_COUNTED_BYTES = 1 << 20

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
        """Return bytes of a row of `width` pixels, without its filter byte."""
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
        """Return the passes that hold pixels, in the order of the stream."""
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
    """Return one chunk with its length and checksum."""
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(data, zlib.crc32(kind)))


def truncated(name: str) -> MapError:
    """Return the error for a file that ends too early."""
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


def decode_png(content: bytes, name: str) -> Pixels:
    """Decode a whole PNG file. The caller has checked the size that its header claims.

    Raises:
        MapError: If the file is truncated or damaged.
    """
    file = parse_chunks(content, name)
    header = file.header
    if header.depth == 16 and header.color_type != GREY:
        return _split_channels(file, unpack_samples(file, name), name)
    if header.color_type == PALETTE and file.palette is None:
        raise MapError(f"{name}: the PNG image needs a palette and has none; write it again")
    samples = _decode_by_pillow(file, name)
    if not samples[_last_row(header)].any() and _unpacked_bytes(file.packed, name) < header.stream_bytes:
        raise truncated(name)
    if header.color_type == PALETTE:
        return _apply_palette(file, samples[..., 0], name)
    return _split_channels(file, samples, name)


def encode_png(samples: npt.NDArray[np.uint8]) -> bytes:
    """Write 8-bit greys, shape (rows, cols), or red, green, blue, alpha, shape (rows, cols, 4), as PNG."""
    from PIL import Image

    stream = io.BytesIO()
    # Maps are walls and blank space: run-length matching compresses them as well as deflate's full search, and faster.
    Image.fromarray(samples).save(stream, "PNG", compress_type=zlib.Z_RLE)
    return stream.getvalue()


def _decode_by_pillow(file: PngFile, name: str) -> SampleArray:
    """Return samples, shape (rows, cols, channels): greys of fewer than 8 bits scaled to 8, palette entries plain."""
    from PIL import PngImagePlugin

    # Only the needed chunks are passed on: Pillow refuses long texts and reads animations.
    header = file.header
    ihdr = (header.width, header.height, header.depth, header.color_type, 0, 0, header.interlaced)
    content = SIGNATURE + write_chunk(b"IHDR", struct.pack(">IIBBBBB", *ihdr))
    if file.palette is not None:
        content += write_chunk(b"PLTE", file.palette)
    content += write_chunk(b"IDAT", file.packed) + write_chunk(b"IEND", b"")
    try:
        # Not Image.open: it warns about large images, and the size has been checked already.
        with PngImagePlugin.PngImageFile(io.BytesIO(content)) as image:
            samples = np.asarray(image)
    except Exception as error:  # Pillow's reader may raise anything on damaged bytes
        if "truncated" in str(error):
            raise truncated(name) from error
        raise MapError(f"{name}: the PNG image is damaged ({parser_reason(error)}); copy or write it again") from error
    if samples.dtype == np.bool_:
        samples = samples * np.uint8(255)
    return samples.reshape(header.height, header.width, header.channels)


def _last_row(header: PngHeader) -> tuple[slice, slice]:
    """Return where the last pixels of the stream are; Pillow leaves rows black that are missing in the stream."""
    last = header.passes()[-1]
    row = last.y0 + (last.rows - 1) * last.dy
    return slice(row, row + 1), slice(last.x0, None, last.dx)


def _unpacked_bytes(packed: bytes, name: str) -> int:
    """Return the length of a deflate stream, counted piece by piece."""
    unpacker = zlib.decompressobj()
    count = 0
    try:
        # The decompressor may still hold bytes that did not fit into a piece after it consumed all of its input.
        while piece := unpacker.decompress(packed, _COUNTED_BYTES):
            count += len(piece)
            packed = unpacker.unconsumed_tail
    except zlib.error as error:
        raise MapError(f"{name}: the PNG image is damaged ({error}); copy or write it again") from error
    return count


def _apply_palette(file: PngFile, index: SampleArray, name: str) -> Pixels:
    palette = np.frombuffer(file.palette or b"", dtype=np.uint8).reshape(-1, 3)
    if index.max() >= len(palette):
        raise MapError(f"{name}: a pixel uses palette entry {index.max()} of {len(palette)}; write the image again")
    if not file.transparency:
        return Pixels(palette[index])
    opacity = np.full(256, 255, dtype=np.uint8)
    opacity[: len(file.transparency)] = np.frombuffer(file.transparency[:256], dtype=np.uint8)
    return Pixels(palette[index], opacity[index])


def _split_channels(file: PngFile, samples: SampleArray, name: str) -> Pixels:
    header = file.header
    colors = 3 if header.color_type in (RGB, RGBA) else 1
    alpha: SampleArray | None = None
    if header.color_type in (GREY_ALPHA, RGBA):
        alpha = samples[..., colors]
    elif file.transparency:
        if len(file.transparency) != 2 * colors:
            raise MapError(f"{name}: the PNG transparency is damaged; write the image again")
        scale = 255 // (2**header.depth - 1) if header.depth < 8 else 1
        key = np.frombuffer(file.transparency, dtype=">u2").astype(np.int64) * scale
        alpha = np.where((samples == key).all(axis=-1), 0, np.iinfo(samples.dtype).max).astype(samples.dtype)
    return Pixels(samples[..., :3] if colors == 3 else samples[..., 0], alpha)


def unpack_samples(file: PngFile, name: str) -> npt.NDArray[np.uint16]:
    """Return samples of an image of depth 16, shape (rows, cols, channels).

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
