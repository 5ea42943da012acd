from __future__ import annotations

import struct

import numpy as np
import pytest

from trundle.errors import MapError
from trundle.maps import OccupancyGrid
from trundle.maps.images.bmp import decode_bmp

GREYS = np.array([[0, 255, 205, 0, 255], [255, 254, 0, 205, 205], [0, 0, 255, 255, 254]], dtype=np.uint8)
"""Top row first; 5 pixels are no whole word in any depth."""


def encode(rows: np.ndarray, depth: int, *, top_down: bool = False, palette: list[tuple[int, int, int]] = ()) -> bytes:
    """Write a BMP: greys, or indices into a palette; as the format's definition says."""
    height, width = rows.shape
    lines = []
    for row in rows if top_down else rows[::-1]:
        if depth <= 8:
            bits = np.unpackbits(row.astype(np.uint8)[:, None], axis=1)[:, -depth:].ravel()
            line = np.packbits(bits).tobytes()
        else:
            line = b"".join(bytes([value] * 3 + [0] * (depth // 8 - 3)) for value in row.tolist())
        lines.append(line + bytes(-len(line) % 4))
    colors = b"".join(bytes([blue, green, red, 0]) for red, green, blue in palette)
    offset, data = 54 + len(colors), b"".join(lines)
    head = struct.pack("<2sIHHI", b"BM", offset + len(data), 0, 0, offset)
    signed = -height if top_down else height
    info = struct.pack("<IiiHHIIiiII", 40, width, signed, 1, depth, 0, len(data), 0, 0, len(palette), 0)
    return head + info + colors + data


def paletted(depth: int) -> tuple[np.ndarray, list[tuple[int, int, int]]]:
    """The greys as indices into a palette that is no ramp."""
    values = sorted({0, 255} if depth == 1 else set(GREYS.ravel().tolist()), reverse=True)
    greys = np.where(GREYS > 100, 255, 0) if depth == 1 else GREYS
    indices = np.array([[values.index(value) for value in row] for row in greys.tolist()])
    return indices, [(value, value, value) for value in values]


@pytest.mark.parametrize("top_down", [False, True])
@pytest.mark.parametrize("depth", [1, 4, 8])
def test_palettes_of_every_depth_are_read(depth, top_down):
    indices, palette = paletted(depth)
    pixels = decode_bmp(encode(indices, depth, top_down=top_down, palette=palette), "a.bmp")
    expected = np.array([[palette[index][0] for index in row] for row in indices.tolist()])
    colour = pixels.colour if pixels.colour.ndim == 2 else pixels.colour[..., 0]
    np.testing.assert_array_equal(colour, expected)
    assert pixels.alpha is None


@pytest.mark.parametrize("top_down", [False, True])
@pytest.mark.parametrize("depth", [24, 32])
def test_true_colour_is_read_and_the_fourth_byte_is_no_alpha(depth, top_down):
    pixels = decode_bmp(encode(GREYS, depth, top_down=top_down), "a.bmp")
    np.testing.assert_array_equal(pixels.colour, np.repeat(GREYS[..., None], 3, axis=2))
    assert pixels.alpha is None


@pytest.mark.parametrize("depth", [8, 24, 32])
def test_a_map_with_a_bmp_is_that_with_a_png(tmp_path, depth):
    grid = OccupancyGrid(np.array([[0, 100, -1], [100, 0, 0]], dtype=np.int8), 0.05)
    grid.save(tmp_path / "map.yaml")
    greys = np.array([[0, 254, 254], [254, 0, 205]], dtype=np.uint8)  # the top row first
    content = encode(greys, depth, palette=[(value,) * 3 for value in range(256)] if depth == 8 else [])
    (tmp_path / "map.bmp").write_bytes(content)
    text = "image: map.bmp\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    (tmp_path / "bmp.yaml").write_text(text)
    np.testing.assert_array_equal(OccupancyGrid.load(tmp_path / "bmp.yaml").data, grid.data)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda content: content[:20], "truncated in its header"),
        (lambda content: content[:-3], "is truncated after"),
        (lambda content: content[:18] + struct.pack("<i", -5) + content[22:], "is not supported"),
        (lambda content: content[:28] + struct.pack("<H", 7) + content[30:], "7 bits per pixel"),
        (lambda content: content[:30] + struct.pack("<I", 4) + content[34:], "compression 4"),
        (lambda content: content[:18] + struct.pack("<ii", 10**6, 10**6) + content[26:], "pixels need max_cells="),
        (lambda content: content + bytes(1 << 20), "far longer than its image needs"),
    ],
)
def test_broken_files_are_refused(tmp_path, change, message):
    (tmp_path / "map.bmp").write_bytes(change(encode(GREYS, 24)))
    (tmp_path / "map.yaml").write_text(
        "image: map.bmp\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    with pytest.raises(MapError, match=message):
        OccupancyGrid.load(tmp_path / "map.yaml")
