"""PNM images (PBM, PGM, PPM; plain and binary), read by their exact `maxval` rules, and PGM written."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from trundle.errors import MapError
from trundle.maps.images.pixels import FULL_SCALE, Pixels, SampleArray

PLAIN_MAGIC = (b"P1", b"P2", b"P3")
BINARY_MAGIC = (b"P4", b"P5", b"P6")
MAGIC = PLAIN_MAGIC + BINARY_MAGIC
PLAIN_BYTES_PER_SAMPLE = 24
"""Most bytes of text per sample that are accepted."""

_WHITESPACE = b" \t\n\v\f\r"
_NUMBER = re.compile(rb"[0-9]{1,10}")
_NO_SAMPLE = re.compile(rb"[^0-9 \t\n\v\f\r]|[0-9]{7,}")
_NO_BIT = re.compile(rb"[^01 \t\n\v\f\r]")
_COMMENT = re.compile(rb"#[^\r\n]*")


@dataclass(frozen=True, slots=True)
class PnmHeader:
    """The header of a PNM file.

    Attributes:
        magic: b"P1" to b"P6".
        width: Columns.
        height: Rows.
        maxval: The sample that means fully bright; 1 for bitmaps.
        offset: First byte of the raster.
    """

    magic: bytes
    width: int
    height: int
    maxval: int
    offset: int

    @property
    def plain(self) -> bool:
        """Whether the raster is text."""
        return self.magic in PLAIN_MAGIC

    @property
    def channels(self) -> int:
        """Samples per pixel."""
        return 3 if self.magic in (b"P3", b"P6") else 1

    @property
    def raster_bytes(self) -> int:
        """Bytes of the raster; for text, the most that is read."""
        if self.magic == b"P4":
            return (self.width + 7) // 8 * self.height
        samples = self.width * self.height * self.channels
        return samples * (PLAIN_BYTES_PER_SAMPLE if self.plain else 1 + (self.maxval > 255))

    @property
    def decoded_bytes(self) -> int:
        """Memory of the decoded samples."""
        return self.width * self.height * self.channels * (4 if self.plain else 1 + (self.maxval > 255))


def parse_header(head: bytes, name: str) -> PnmHeader:
    """Read the header from the first bytes of a PNM file; `name` stands for the file in messages.

    Raises:
        MapError: If it is truncated, not numeric, or a number is out of range.
    """
    magic = head[:2]
    position = 2
    numbers: list[int] = []
    for what in ("width", "height") if magic in (b"P1", b"P4") else ("width", "height", "maxval"):
        number, position = _read_number(head, position, what, name)
        if not 1 <= number <= (FULL_SCALE if what == "maxval" else 2**31 - 1):
            limit = f"1..{FULL_SCALE}" if what == "maxval" else "at least 1"
            raise MapError(f"{name}: the PNM header has {what} {number}; it must be {limit}. Write the image again")
        numbers.append(number)
    if position >= len(head):
        raise _truncated(name)
    width, height, maxval = numbers if len(numbers) == 3 else (*numbers, 1)
    return PnmHeader(magic, width, height, maxval, position + 1)


def decode_pnm(content: bytes, name: str) -> Pixels:
    """Decode a whole PNM file. The caller has checked the size that its header claims.

    Raises:
        MapError: If the file is truncated or a sample is above `maxval`.
    """
    header = parse_header(content, name)
    if header.plain:
        samples = _read_plain(header, content[header.offset - 1 :], name)
    else:
        samples = _read_binary(header, content, name)
    if samples.max() > header.maxval:
        raise MapError(
            f"{name}: a pixel has the value {samples.max()}, above the header's maxval {header.maxval}; "
            "correct the header or write the image again"
        )
    shape = (header.height, header.width) if header.channels == 1 else (header.height, header.width, 3)
    samples = samples.reshape(shape)
    if header.magic in (b"P1", b"P4"):
        return Pixels(((1 - samples) * 255).astype(np.uint8))
    if header.maxval == 255:
        return Pixels(samples.astype(np.uint8, copy=False))
    return Pixels(samples.astype(np.uint16) * np.uint16(FULL_SCALE // header.maxval))


def encode_pgm(greys: npt.NDArray[np.uint8]) -> bytes:
    """Write greys, shape (rows, cols), as binary PGM."""
    rows, cols = greys.shape
    return b"P5\n%d %d\n255\n" % (cols, rows) + greys.tobytes()


def _truncated(name: str) -> MapError:
    return MapError(f"{name}: the PNM image is truncated; copy or write it again")


def _read_number(head: bytes, position: int, what: str, name: str) -> tuple[int, int]:
    while position < len(head):
        if head[position] in _WHITESPACE:
            position += 1
        elif head[position] == ord("#"):
            comment = _COMMENT.match(head, position)
            position = comment.end() if comment else position + 1
        else:
            break
    match = _NUMBER.match(head, position)
    if match is None:
        if position >= len(head):
            raise _truncated(name)
        raise MapError(f"{name}: the PNM header has no {what} at byte {position}; write the image again")
    end = match.end()
    if end < len(head) and head[end] not in _WHITESPACE + b"#":
        raise MapError(f"{name}: the PNM header has a damaged {what} at byte {position}; write the image again")
    return int(match.group()), end


def _read_plain(header: PnmHeader, text: bytes, name: str) -> npt.NDArray[np.int32]:
    count = header.width * header.height * header.channels
    text = _COMMENT.sub(b" ", text)
    stray = (_NO_BIT if header.magic == b"P1" else _NO_SAMPLE).search(text)
    if stray is not None:
        raise MapError(f"{name}: {stray.group()[:20]!r} is not a PNM sample; write the image again")
    if header.magic == b"P1":
        samples = np.frombuffer(b"".join(text.split()), dtype=np.uint8).astype(np.int32) - ord("0")
    else:
        samples = np.fromstring(text, dtype=np.int32, sep=" ")
    if len(samples) < count:
        raise _truncated(name)
    return samples[:count]


def _read_binary(header: PnmHeader, content: bytes, name: str) -> SampleArray:
    if len(content) < header.offset + header.raster_bytes:
        raise _truncated(name)
    raster = np.frombuffer(content, dtype=np.uint8, count=header.raster_bytes, offset=header.offset)
    if header.magic == b"P4":
        rows = raster.reshape(header.height, -1)
        return np.unpackbits(rows, axis=1)[:, : header.width]
    return raster if header.maxval < 256 else raster.view(">u2")
