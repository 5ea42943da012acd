"""Maps that are too large are refused by their header, with the option that lifts the limit."""

from __future__ import annotations

import struct
import zlib

import numpy as np
import pytest

from trundle.cli.entry import run_command
from trundle.errors import InputError, MapError
from trundle.maps import KeepoutMask, OccupancyGrid, SpeedMask
from trundle.maps.check import check_map

YAML = "image: {}\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(data, zlib.crc32(kind)))


def png(cols, rows, depth=8, color=0):
    """Only its header: what is refused is never decoded."""
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", cols, rows, depth, color, 0, 0, 0))


def bmp(cols, rows, depth=8):
    return b"BM" + struct.pack("<IIIIiiHHIIIIII", 0, 0, 54, 40, cols, rows, 1, depth, 0, 0, 0, 0, 0, 0)


def of_image(folder, content, suffix="png"):
    (folder / f"map.{suffix}").write_bytes(content)
    file = folder / "map.yaml"
    file.write_text(YAML.format(f"map.{suffix}"))
    return file


def arena(folder, cols, rows):
    file = folder / "arena.map"
    file.write_text(f"type octile\nheight {rows}\nwidth {cols}\nmap\n" + ("." * cols + "\n") * min(rows, 4))
    return file


LARGE = [
    (png(20_000, 20_000), "png", 400_000_000),
    (png(4473, 4473), "png", 20_007_729),
    (png(5000, 5000, depth=16, color=6), "png", 50_000_000),
    (bmp(20_000, 20_000), "bmp", 400_000_000),
    (b"P5\n20000 20000\n255\n", "pgm", 400_000_000),
    (b"P2\n20000 20000\n255\n", "pgm", 400_000_000),
    (b"P3\n5000 5000\n255\n", "ppm", 75_000_000),
]


@pytest.mark.parametrize(("content", "suffix", "needed"), LARGE)
def test_a_larger_image_is_refused_by_its_header_with_the_option(content, suffix, needed, tmp_path):
    file = of_image(tmp_path, content, suffix)
    with pytest.raises(
        MapError, match=rf"pixels need max_cells={needed}, and the limit is 20000000.*--max-cells {needed}"
    ):
        OccupancyGrid.load(file)
    (finding,) = check_map(file).findings
    assert f"--max-cells {needed}" in finding.message
    with pytest.raises(MapError, match="truncated"):  # the limit is not what refuses it
        OccupancyGrid.load(file, max_cells=needed)


@pytest.mark.parametrize(
    "verb",
    [
        ["map", "check"],
        ["map", "convert", "-o", "out.yaml"],
        ["plan", "--start", "0,0", "--goal", "1,1"],
        ["run", "--backend", "kinematic"],
    ],
)
@pytest.mark.parametrize("is_arena", [False, True])
def test_every_verb_that_reads_a_map_has_the_limit_and_the_option(verb, is_arena, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    size = (7000, 7000)
    file = arena(tmp_path, *size) if is_arena else of_image(tmp_path, png(*size))
    code = run_command([*verb, str(file)])
    shown = capsys.readouterr()
    assert "--max-cells 49000000" in shown.out + shown.err
    assert code == (1 if verb[1] == "check" else 2)
    run_command([*verb, str(file), "--max-cells", "49000000"])
    shown = capsys.readouterr()
    assert "--max-cells" not in shown.out + shown.err
    assert "ends after 4 of 7000" in shown.out + shown.err if is_arena else "truncated" in shown.out + shown.err


@pytest.mark.parametrize("mask", [KeepoutMask, SpeedMask])
def test_masks_have_the_limit(mask, tmp_path):
    file = of_image(tmp_path, png(7000, 7000))
    with pytest.raises(MapError, match="max_cells=49000000"):
        mask.load(file)
    with pytest.raises(MapError, match="truncated"):
        mask.load(file, max_cells=49_000_000)


@pytest.mark.parametrize("limit", [0, -1, 1.5, True, "7", 10**400])
def test_a_limit_that_is_none_is_refused(limit, tmp_path):
    file = of_image(tmp_path, png(10, 10))
    with pytest.raises(InputError, match="max_cells must be an integer from 1"):
        OccupancyGrid.load(file, max_cells=limit)


def test_a_map_within_a_smaller_limit_is_read(tmp_path):
    OccupancyGrid(np.zeros((4, 5), dtype=np.int8), 0.05).save(tmp_path / "map.yaml")
    assert OccupancyGrid.load(tmp_path / "map.yaml", max_cells=20).shape == (4, 5)
    with pytest.raises(MapError, match="need max_cells=20, and the limit is 19"):
        OccupancyGrid.load(tmp_path / "map.yaml", max_cells=19)
