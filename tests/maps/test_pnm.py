from __future__ import annotations

import io

import numpy as np
import pytest
from PIL import Image

from trundle.errors import MapError
from trundle.maps.images.pixels import compute_greys
from trundle.maps.images.pnm import decode_pnm, encode_pgm

NOISE = np.random.default_rng(0).integers(0, 256, (5, 7))


def plain(magic: str, samples: np.ndarray, maxval: int | None) -> bytes:
    rows, cols = samples.shape[:2]
    top = "" if maxval is None else f"{maxval}\n"
    return f"{magic}\n{cols} {rows}\n{top}{' '.join(str(value) for value in samples.ravel())}\n".encode()


def binary(magic: str, samples: np.ndarray, maxval: int) -> bytes:
    rows, cols = samples.shape[:2]
    return f"{magic} {cols} {rows} {maxval}\n".encode() + samples.astype(">u2" if maxval > 255 else ">u1").tobytes()


@pytest.mark.parametrize("maxval", [1, 3, 99, 100, 127, 254, 255, 256, 1000, 32768, 65534, 65535])
def test_plain_and_binary_agree_and_scale_by_their_maxval(maxval):
    samples = np.unique(np.linspace(0, maxval, 300).astype(int))[None, :]
    p2 = compute_greys(decode_pnm(plain("P2", samples, maxval), "a.pgm"))
    p5 = compute_greys(decode_pnm(binary("P5", samples, maxval), "a.pgm"))
    expected = [[v if maxval == 255 else (v * (65535 // maxval)) // 257 for v in samples[0].tolist()]]
    assert p2.tolist() == p5.tolist() == expected


def test_colour_in_both_forms():
    samples = np.random.default_rng(1).integers(0, 256, (3, 4, 3))
    for content in (plain("P3", samples, 255), binary("P6", samples, 255)):
        assert np.array_equal(decode_pnm(content, "a.ppm").colour, samples)


def test_bitmaps_are_black_where_a_bit_is_set():
    bits = np.random.default_rng(2).integers(0, 2, (5, 11))
    stream = io.BytesIO()
    Image.fromarray(bits == 0).save(stream, "PPM")
    assert stream.getvalue().startswith(b"P4")
    expected = np.where(bits, 0, 255)
    tight = b"P1 11 5\n" + "".join(map(str, bits.ravel())).encode()
    for content in (stream.getvalue(), plain("P1", bits, None), tight):
        assert np.array_equal(decode_pnm(content, "a.pbm").colour, expected)


def test_comments_and_any_white_space_are_skipped():
    content = b"P5#one\n# two\r\n\t3#three\n \v2\n#\n#255\n255 abcdef"
    assert decode_pnm(content, "a.pgm").colour.tobytes() == b"abcdef"
    content = b"P2 # CREATOR: a map saver 0.05 m/pix\n3 2 255\n1 2 #7 8\n3 4 5 6 # end"
    assert decode_pnm(content, "a.pgm").colour.tolist() == [[1, 2, 3], [4, 5, 6]]


def test_a_raster_that_begins_like_white_space_or_a_comment_is_kept():
    assert decode_pnm(b"P5 4 1 255\n\n #\r", "a.pgm").colour.tobytes() == b"\n #\r"


def test_what_is_written_is_read_back_and_has_the_plain_header():
    content = encode_pgm(NOISE.astype(np.uint8))
    assert content.startswith(b"P5\n7 5\n255\n")
    assert np.array_equal(decode_pnm(content, "a.pgm").colour, NOISE)
    assert np.array_equal(np.asarray(Image.open(io.BytesIO(content))), NOISE)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"P5", "truncated"),
        (b"P5 3", "truncated"),
        (b"P5 3 2 255", "truncated"),
        (b"P5 3 2 255\nabcde", "truncated"),
        (b"P5 3 2 256\nabcdefghijk", "truncated"),
        (b"P4 9 2\nabc", "truncated"),
        (b"P2 3 2 255\n1 2 3 4 5", "truncated"),
        (b"P1 3 2\n10101", "truncated"),
        (b"P5 0 2 255\n", "width 0"),
        (b"P5 2 0 255\n", "height 0"),
        (b"P5 2 2 0\n", "maxval 0"),
        (b"P5 2 2 65536\n", "maxval 65536"),
        (b"P5 -2 2 255\n", "no width"),
        (b"P5 2 2 2x5\n", "damaged maxval"),
        (b"P5 99999999999 2 255\n", "damaged width"),
        (b"P5 1 1 100\n\x65", "value 101, above the header's maxval 100"),
        (b"P2 1 1 100\n101", "value 101"),
        (b"P2 1 1 100\n-1", "not a PNM sample"),
        (b"P2 1 1 100\n1.5", "not a PNM sample"),
        (b"P2 1 1 255\n99999999999999999999", "not a PNM sample"),
        (b"P1 2 1\n12", "not a PNM sample"),
    ],
)
def test_damage_is_reported(content, message):
    with pytest.raises(MapError, match=r"^a\.pgm: .*" + message):
        decode_pnm(content, "a.pgm")
