"""A PNG writer for tests, apart from the package's: every depth, colour type, row filter and Adam7."""

from __future__ import annotations

import struct
import zlib

import numpy as np

SIGNATURE = b"\x89PNG\r\n\x1a\n"
CHANNELS = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}
ADAM7 = [(0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2)]


def chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def pack_row(row: np.ndarray, depth: int) -> bytes:
    values = row.reshape(-1)
    if depth == 16:
        return values.astype(">u2").tobytes()
    if depth == 8:
        return values.astype(np.uint8).tobytes()
    bits = "".join(format(int(value), f"0{depth}b") for value in values)
    bits += "0" * (-len(bits) % 8)
    return bytes(int(bits[i : i + 8], 2) for i in range(0, len(bits), 8))


def filter_row(kind: int, row: bytes, above: bytes, step: int) -> bytes:
    out = bytearray([kind])
    for i, value in enumerate(row):
        a = row[i - step] if i >= step else 0
        b = above[i]
        c = above[i - step] if i >= step else 0
        p = a + b - c
        nearest = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
        out.append((value - (0, a, b, (a + b) // 2, nearest)[kind]) & 0xFF)
    return bytes(out)


def encode(samples, depth, color_type, *, interlace=False, filters=(0, 1, 2, 3, 4), extra=(), parts=1) -> bytes:
    """`samples`: (rows, cols, channels), unscaled; `extra`: chunks before the image data."""
    rows, cols, channels = samples.shape
    assert channels == CHANNELS[color_type]
    step = max(1, channels * depth // 8)
    stream = b""
    for x0, y0, dx, dy in ADAM7 if interlace else [(0, 0, 1, 1)]:
        part = samples[y0::dy, x0::dx]
        if part.size == 0:
            continue
        above = bytes(len(pack_row(part[0], depth)))
        for number, row in enumerate(part):
            packed = pack_row(row, depth)
            stream += filter_row(filters[number % len(filters)], packed, above, step)
            above = packed
    packed = zlib.compress(stream)
    size = -(-len(packed) // parts)
    header = struct.pack(">IIBBBBB", cols, rows, depth, color_type, 0, 0, int(interlace))
    content = SIGNATURE + chunk(b"IHDR", header)
    content += b"".join(chunk(kind, data) for kind, data in extra)
    content += b"".join(chunk(b"IDAT", packed[i : i + size]) for i in range(0, len(packed), size))
    return content + chunk(b"IEND", b"")
