"""PNG images, read at full depth and written; by Pillow except for 16-bit colour."""

from __future__ import annotations

import io
import struct
import zlib

import numpy as np
import numpy.typing as npt

from trundle.errors import MapError
from trundle.files.parser_errors import parser_reason
from trundle.maps.images.pixels import Pixels, SampleArray
from trundle.maps.images.png16 import unpack_samples
from trundle.maps.images.png_chunks import (
    GREY,
    GREY_ALPHA,
    PALETTE,
    RGB,
    RGBA,
    SIGNATURE,
    PngFile,
    PngHeader,
    parse_chunks,
    truncated,
    write_chunk,
)

_COUNTED_BYTES = 1 << 20


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
    """Samples, shape (rows, cols, channels), greys of less than 8 bits scaled to 8, palette entries as they are."""
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
    """The last pixels of the stream, for a check: Pillow leaves rows black that are missing in the stream."""
    last = header.passes()[-1]
    row = last.y0 + (last.rows - 1) * last.dy
    return slice(row, row + 1), slice(last.x0, None, last.dx)


def _unpacked_bytes(packed: bytes, name: str) -> int:
    """Length of a deflate stream, counted piece by piece."""
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
