"""Fuzz the map readers: whatever the bytes are, a grid comes out or a MapError, nothing else.

PYTHONPATH=tests python -m fuzz.fuzz_map_reader [options]     guided by coverage, where atheris is installed
"""

from __future__ import annotations

import random
import struct
import sys
import tempfile
import time
import warnings
import zlib
from pathlib import Path

import numpy as np

from fuzz import mutation
from trundle.errors import MapError, MapWarning
from trundle.maps import OccupancyGrid
from trundle.maps.images.image import read_image
from trundle.maps.movingai import load_scenarios
from trundle.maps.occupancy import MODES, PixelRule, compute_cells

YAML = (
    b"image: map.pgm\nresolution: 0.05\norigin: [-11.975, -17.975, 0.0]\nnegate: 0\n"
    b"occupied_thresh: 0.65\nfree_thresh: 0.196\nmode: trinary\n"
)
TOKENS = [
    *(b"trinary scale raw 0 1 -1 0.05 5e-2 1e999 .nan .inf 0x10 ~ null true [] {} '' - : ? # & * ! | > % @ `".split()),
    *(b"&a *a !!float <<: --- ... %YAML \\x00 \\UFFFFFFFF \\uD800 ../ /dev/zero".split()),
    b'"\\UFFFFFFFF"',
    b"%YAML 1." + b"9" * 5000 + b"\n---\n",
    *(b"P1 P2 P3 P4 P5 P6 255 65535 65536 20000 2147483647 99999999999".split()),
    *(b"IHDR PLTE tRNS IDAT IEND octile height width map version".split()),
    b"\n",
    b" ",
    b"\t",
    b"\x00",
    b"\xff",
    b"\xff\xff\xff\xff",
    b"\xef\xbb\xbf",
    b"[" * 100,
    b"9" * 5000,
]


def _png(depth: int, color_type: int, interlace: int = 0, extra: bytes = b"") -> bytes:
    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", 3, 3, depth, color_type, 0, 0, interlace)
    channels = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}[color_type]
    size = (3 * channels * depth + 7) // 8
    rows = b"".join(bytes([kind]) + bytes((kind * 40 + i) % 4 for i in range(size)) for kind in range(3))
    rows += bytes(40) if interlace else b""
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + extra
        + chunk(b"IDAT", zlib.compress(rows))
        + chunk(b"IEND", b"")
    )


_PALETTE = struct.pack(">I", 768) + b"PLTE" + bytes(256) * 3
_PALETTE += struct.pack(">I", zlib.crc32(_PALETTE[4:]))
IMAGES = [
    b"P5 3 3 255\n\xfe\xcd\x00\x00\xcd\xfe\x01\x02\x03",
    b"P5\n# comment\n2 2\n65535\nabcdefgh",
    b"P2 2 2 100 1 2 # x\n3 100",
    b"P6 1 1 255\nabc",
    b"P3 1 1 255\n1 2 3",
    b"P4 9 2\nabcd",
    b"P1 2 2\n01 10",
    _png(8, 0),
    _png(16, 0),
    _png(1, 0),
    _png(8, 2),
    _png(8, 3, extra=_PALETTE),
    _png(16, 4),
    _png(8, 6, interlace=1),
]
MOVINGAI_MAP = b"type octile\nheight 2\nwidth 3\nmap\n.@T\nSWG\n"
MOVINGAI_SCENARIO = b"version 1\n0\ta.map\t3\t2\t0\t0\t2\t1\t3.41\n"
KINDS = ("yaml", "image", "map", "scen")


class Target:
    """Reads one input in a separate folder."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def read(self, kind: str, content: bytes) -> None:
        """Raise whatever a reader raises, except MapError."""
        source = self._folder / f"map.{kind}"
        source.write_bytes(content)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", MapWarning)
                for cells in self._cells(kind, source):
                    if cells.dtype != np.int8 or cells.min() < -1 or cells.max() > 100:
                        raise AssertionError("a cell outside -1..100")
        except MapError as error:
            if not str(error):
                raise AssertionError("a message without words") from error

    def _cells(self, kind: str, source: Path) -> list[np.ndarray]:
        if kind == "scen":
            load_scenarios(source)
            return []
        if kind == "image":  # Without the YAML file, which takes most of the time.
            pixels = read_image(source)
            return [compute_cells(pixels, PixelRule(mode), compat) for mode in MODES for compat in (None, "humble")]
        if kind == "yaml":
            (self._folder / "map.pgm").write_bytes(IMAGES[0])
        return [OccupancyGrid.load(source).data]


def _repair_checksums(content: bytes) -> bytes:
    """Right checksums after a mutation, so that damage goes deeper than the first check."""
    out, position = bytearray(content), 8
    while position + 12 <= len(out):
        end = position + 12 + int.from_bytes(out[position : position + 4], "big")
        if end > len(out):
            break
        out[end - 4 : end] = struct.pack(">I", zlib.crc32(out[position + 4 : end - 4]))
        position = end
    return bytes(out)


def mutate(content: bytes, generator: random.Random) -> bytes:
    """Change a few places, mostly with right checksums in a PNG."""
    out = mutation.mutate(content, generator, TOKENS)
    return _repair_checksums(out) if content.startswith(b"\x89PNG") and generator.random() < 0.8 else out


def make_input(generator: random.Random) -> tuple[str, bytes]:
    """A kind of file and damaged content."""
    kind = generator.choices(KINDS, (3, 10, 1, 1))[0]
    base = {"yaml": YAML, "map": MOVINGAI_MAP, "scen": MOVINGAI_SCENARIO}.get(kind) or generator.choice(IMAGES)
    if kind == "image" and b"IDAT" in base and generator.random() < 0.1:
        packed = generator.randbytes(generator.randrange(60))
        base = base.replace(base[base.find(b"IDAT") + 4 : base.find(b"IEND") - 8], packed)
    return kind, mutate(base, generator)


def one_round(generator: random.Random) -> None:
    """Twenty inputs, each read within seconds of processor time."""
    with tempfile.TemporaryDirectory() as folder:
        target = Target(Path(folder))
        for _ in range(20):
            kind, content = make_input(generator)
            begun = time.process_time()
            try:
                target.read(kind, content)
            except BaseException:
                print(f"kind {kind}: {content!r}", file=sys.stderr)
                raise
            took = time.process_time() - begun
            assert took < 10.0, f"kind {kind} took {took:.1f} s: {content!r}"


def main() -> None:
    import atheris  # pyright: ignore[reportMissingImports]

    with tempfile.TemporaryDirectory() as folder:
        target = Target(Path(folder))

        def one_input(data: bytes) -> None:
            if data:
                target.read(KINDS[data[0] % len(KINDS)], data[1:])

        atheris.instrument_all()
        atheris.Setup(sys.argv, one_input)
        atheris.Fuzz()


if __name__ == "__main__":
    main()
