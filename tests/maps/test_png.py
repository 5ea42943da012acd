from __future__ import annotations

import io
import struct
import zlib

import numpy as np
import pytest
from PIL import Image

from support import png_samples as samples_of
from trundle.errors import MapError
from trundle.maps.images.png import decode_png, encode_png

KINDS = [(1, 0), (2, 0), (4, 0), (8, 0), (16, 0), (8, 2), (16, 2), (8, 4), (16, 4), (8, 6), (16, 6)]


def random_samples(depth: int, color_type: int, shape=(11, 13)) -> np.ndarray:
    generator = np.random.default_rng(depth * 10 + color_type)
    return generator.integers(0, 2**depth, (*shape, samples_of.CHANNELS[color_type]))


@pytest.mark.parametrize("interlace", [False, True])
@pytest.mark.parametrize(("depth", "color_type"), KINDS)
def test_every_depth_and_colour_type_is_read_to_its_full_depth(depth, color_type, interlace):
    samples = random_samples(depth, color_type)
    pixels = decode_png(samples_of.encode(samples, depth, color_type, interlace=interlace, parts=3), "a.png")
    colors = 3 if color_type in (2, 6) else 1
    scale = 255 // (2**depth - 1) if depth < 8 else 1
    expected = samples[..., :colors] * scale
    assert np.array_equal(pixels.colour, expected if colors == 3 else expected[..., 0])
    assert pixels.colour.dtype == (np.uint16 if depth == 16 else np.uint8)
    if color_type in (4, 6):
        assert np.array_equal(pixels.alpha, samples[..., colors])
    else:
        assert pixels.alpha is None


@pytest.mark.parametrize("color_type", [2, 4, 6])
def test_16_bit_colour_has_a_decoder_of_ours_because_pillow_reads_8_bits_of_it(color_type):
    content = samples_of.encode(random_samples(16, color_type), 16, color_type)
    assert np.asarray(Image.open(io.BytesIO(content))).dtype == np.uint8


@pytest.mark.parametrize("shape", [(1, 1), (1, 9), (9, 1), (3, 5), (8, 8), (17, 33)])
def test_interlaced_images_of_any_size_match_pillow(shape):
    samples = random_samples(8, 2, shape)
    content = samples_of.encode(samples, 8, 2, interlace=True)
    assert np.array_equal(decode_png(content, "a.png").colour, np.asarray(Image.open(io.BytesIO(content))))


@pytest.mark.parametrize("mode", ["1", "L", "LA", "RGB", "RGBA", "P"])
def test_what_pillow_writes_is_read(mode):
    noise = np.random.default_rng(1).integers(0, 256, (20, 30, 4), dtype=np.uint8)
    image = Image.fromarray(noise, "RGBA").convert(mode)
    stream = io.BytesIO()
    image.save(stream, "PNG")
    pixels = decode_png(stream.getvalue(), "a.png")
    if mode in ("1", "L"):
        assert np.array_equal(pixels.colour, np.asarray(image.convert("L")))
    elif mode == "LA":
        assert np.array_equal(np.dstack([pixels.colour, pixels.alpha]), np.asarray(image))
    else:
        assert np.array_equal(pixels.colour, np.asarray(image.convert("RGB")))
        if mode == "RGBA":
            assert np.array_equal(pixels.alpha, np.asarray(image)[..., 3])


def test_palette_with_transparency():
    palette = bytes([10, 20, 30, 40, 50, 60, 70, 80, 90])
    index = np.array([[[0], [1], [2]]])
    content = samples_of.encode(index, 2, 3, extra=[(b"PLTE", palette), (b"tRNS", bytes([0, 128]))])
    pixels = decode_png(content, "a.png")
    assert pixels.colour.tolist() == [[[10, 20, 30], [40, 50, 60], [70, 80, 90]]]
    assert pixels.alpha.tolist() == [[0, 128, 255]]


@pytest.mark.parametrize(("depth", "color_type", "key"), [(8, 0, [7]), (16, 0, [300]), (8, 2, [1, 2, 3]), (4, 0, [7])])
def test_a_transparent_colour_makes_its_pixels_transparent(depth, color_type, key):
    samples = np.stack([np.zeros_like(key), key]).reshape(1, 2, -1)
    extra = [(b"tRNS", np.array(key, dtype=">u2").tobytes())]
    pixels = decode_png(samples_of.encode(samples, depth, color_type, extra=extra), "a.png")
    full = 65535 if depth == 16 else 255
    assert pixels.alpha.tolist() == [[full, 0]]


@pytest.mark.parametrize("shape", [(1, 1), (7, 5), (7, 5, 4)])
def test_pillow_reads_what_is_written(shape):
    samples = np.random.default_rng(3).integers(0, 256, shape, dtype=np.uint8)
    image = Image.open(io.BytesIO(encode_png(samples)))
    assert image.mode == ("L" if len(shape) == 2 else "RGBA")
    assert np.array_equal(np.asarray(image), samples)


GOOD = samples_of.encode(random_samples(8, 0), 8, 0)


@pytest.mark.parametrize("size", range(8, len(GOOD)))
def test_a_file_cut_off_anywhere_is_refused(size):
    with pytest.raises(MapError, match=r"^a\.png: .*truncated"):
        decode_png(GOOD[:size], "a.png")


def header(width=13, height=11, depth=8, color_type=0, compression=0, filtering=0, interlace=0) -> bytes:
    data = struct.pack(">IIBBBBB", width, height, depth, color_type, compression, filtering, interlace)
    return samples_of.SIGNATURE + samples_of.chunk(b"IHDR", data)


@pytest.mark.parametrize(
    "wrong",
    [
        {"width": 0},
        {"height": 2**31},
        {"depth": 3},
        {"depth": 16, "color_type": 3},
        {"color_type": 5},
        {"compression": 1},
        {"filtering": 1},
        {"interlace": 2},
    ],
)
def test_a_header_that_png_does_not_allow_is_refused(wrong):
    with pytest.raises(MapError, match="header"):
        decode_png(header(**wrong) + GOOD[33:], "a.png")


def idat(stream: bytes, *, checksum: bool = True) -> bytes:
    packed = zlib.compress(stream)
    if not checksum:
        packed = packed[:-1] + bytes([packed[-1] ^ 1])
    return samples_of.chunk(b"IDAT", packed) + samples_of.chunk(b"IEND", b"")


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (GOOD[:60] + bytes([GOOD[60] ^ 1]) + GOOD[61:], "checksum"),
        (GOOD[:20] + b"\xff" + GOOD[21:], "header is damaged"),
        (header(2, 1) + idat(b"\x05ab"), "damaged"),
        (header(1, 1, depth=16, color_type=2) + idat(b"\x05abcdef"), "row filter 5 in row 0"),
        (header(1, 1, depth=16, color_type=2) + idat(b"\x00abcde"), "truncated"),
        (header(2, 1) + idat(b"\x00a"), "truncated"),
        (header(2, 1) + idat(b"\x00\x00\x00", checksum=False), "damaged"),
        (header(2, 1) + samples_of.chunk(b"IDAT", b"no zlib") + samples_of.chunk(b"IEND", b""), "damaged"),
        (header(2, 1) + samples_of.chunk(b"IEND", b""), "truncated"),
        (header(2, 1) + samples_of.chunk(b"ABCD", b"") + idat(b"\x00ab"), "unknown chunk"),
        (header(2, 1, color_type=3) + idat(b"\x00\x00\x01"), "needs a palette"),
        (
            header(2, 1, color_type=3) + samples_of.chunk(b"PLTE", b"abc") + idat(b"\x00\x00\x01"),
            "palette entry 1 of 1",
        ),
        (header(2, 1, color_type=3) + samples_of.chunk(b"PLTE", b"ab") + idat(b"\x00\x00\x00"), "palette is damaged"),
        (header(2, 1) + samples_of.chunk(b"tRNS", b"a") + idat(b"\x00ab"), "transparency is damaged"),
        (header(20000, 20000) + idat(b"\x00ab"), "truncated"),
    ],
)
def test_damage_is_reported(content, message):
    with pytest.raises(MapError, match=message):
        decode_png(content, "a.png")


@pytest.mark.parametrize("interlace", [False, True])
@pytest.mark.parametrize(("depth", "color_type"), KINDS)
def test_a_stream_that_ends_before_the_last_row_is_refused(depth, color_type, interlace):
    # Pillow leaves such rows black, and black is an obstacle or free by a map's `negate`.
    samples = np.full((11, 13, samples_of.CHANNELS[color_type]), 2**depth - 1)
    whole = samples_of.encode(samples, depth, color_type, interlace=interlace)
    start = whole.index(b"IDAT") + 4
    stream = zlib.decompress(whole[start : start + struct.unpack_from(">I", whole, start - 8)[0]])
    line = 1 + (13 * samples.shape[2] * depth + 7) // 8
    for missing in (1, line, 2 * line, len(stream) - 1):
        with pytest.raises(MapError, match="truncated"):
            decode_png(whole[:33] + idat(stream[:-missing]), "a.png")


def test_chunks_that_do_not_matter_are_not_read():
    text = samples_of.chunk(b"zTXt", b"Comment\0\0" + zlib.compress(bytes(10_000_000)))
    animation = samples_of.chunk(b"acTL", struct.pack(">II", 2, 0))
    assert np.array_equal(
        decode_png(GOOD[:33] + text + animation + GOOD[33:], "a.png").colour, decode_png(GOOD, "a.png").colour
    )


def test_a_black_image_is_no_truncated_one():
    samples = np.zeros((7, 5, 1), dtype=int)
    for interlace in (False, True):
        assert not decode_png(samples_of.encode(samples, 8, 0, interlace=interlace), "a.png").colour.any()


@pytest.mark.parametrize("depth", [1, 2, 4])
def test_a_transparent_grey_that_no_pixel_can_have_makes_none_transparent(depth):
    samples = np.arange(2**depth).reshape(1, -1, 1)
    extra = [(b"tRNS", struct.pack(">H", 2**depth + 256))]
    assert decode_png(samples_of.encode(samples, depth, 0, extra=extra), "a.png").alpha.all()


def test_an_image_packed_as_tightly_as_deflate_can_is_read():
    rows = zlib.compress(bytes(3000 * 3001), 9)
    content = header(3000, 3000) + samples_of.chunk(b"IDAT", rows) + samples_of.chunk(b"IEND", b"")
    assert 1000 * len(rows) < 3000 * 3001
    assert not decode_png(content, "a.png").colour.any()


@pytest.mark.parametrize("packed_bytes", [2, 100, 5000])
def test_a_header_that_claims_more_than_the_data_can_hold_is_refused_before_anything_is_unpacked(packed_bytes):
    # Deflate packs 1032 to 1 at most. The size is checked first: these bytes are not a deflate stream.
    data = samples_of.chunk(b"IDAT", b"\xff" * packed_bytes) + samples_of.chunk(b"IEND", b"")
    fullest = 1032 * packed_bytes - 1  # a row has a byte more than pixels
    with pytest.raises(MapError, match="damaged"):
        decode_png(header(fullest, 1) + data, "a.png")
    with pytest.raises(MapError, match="truncated"):
        decode_png(header(fullest + 1, 1) + data, "a.png")
