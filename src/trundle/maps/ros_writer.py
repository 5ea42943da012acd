"""Writing a ROS map: its image and the YAML file that names it, as one: the rename of the YAML is the commit."""

from __future__ import annotations

import hashlib
import itertools
import json
import os
import re
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Literal

import numpy as np
import numpy.typing as npt
import yaml

from trundle.errors import MapError
from trundle.files.writing import output_path, write_new_bytes, write_text
from trundle.maps.cells import FREE, OCCUPIED, UNKNOWN, VALUES, CellGrid, Cells, count_values, round_trinary
from trundle.maps.occupancy import MODES, UNKNOWN_GREY, Mode, PixelRule, compute_table

# The greys of Nav2's map saver. Its free_thresh of 0.25 would load unknown cells (grey 205, darkness 0.196) as free.
OCCUPIED_THRESH = 0.65
FREE_THRESH = 0.196

_FREE_GREY = 254
_OCCUPIED_GREY = 0
_RAW_UNKNOWN = 255
_PLAIN_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]*")

_AS_WRITTEN = "# sha256 of these lines and the image, as trundle wrote them: "
"""How the last line of a YAML begins, by which a map that was edited since is told from one that was not."""

_MOST_TEXT = 100_000
"""Characters of a YAML file that are searched for the name of its image."""


def save_map(
    grid: CellGrid,
    path: str | os.PathLike[str],
    *,
    mode: Mode = "trinary",
    image_format: Literal["png", "pgm"] = "png",
    more: str = "",
) -> None:
    """Write a map; see `OccupancyGrid.save`. `more` are lines that its YAML has besides, such as those of a mask."""
    target = output_path(path)
    suffix = target.suffix.lower()
    if suffix == ".map":
        from trundle.maps.movingai_cells import write_cells

        if mode != "trinary":
            raise MapError(f"{target}: a MovingAI map has no mode {mode}, only free and blocked; save as .yaml")
        write_cells(grid.data, target)
        return
    if suffix not in (".yaml", ".yml"):
        raise MapError(
            f"a map is saved under the name of its YAML file, got {target}; end the name in .yaml, or .map for MovingAI"
        )
    if mode not in MODES:
        raise MapError(f"mode is {mode!r}; it must be one of {', '.join(MODES)}")
    if image_format not in ("png", "pgm"):
        raise MapError(f"image_format is {image_format!r}; it must be png or pgm")
    if mode == "scale" and image_format == "pgm":
        raise MapError("mode scale needs transparency for unknown cells, which PGM lacks; save as png")
    samples = compute_samples(grid, mode)
    if image_format == "pgm":
        from trundle.maps.images.pnm import encode_pgm

        content = encode_pgm(samples)
    else:
        from trundle.maps.images.png import encode_png

        content = encode_png(samples)
    save_pair(target, f".{image_format}", content, lambda image: _compose_yaml(grid, image, mode) + more)


def compute_samples(grid: CellGrid, mode: Mode) -> npt.NDArray[np.uint8]:
    """Return 8-bit samples of a map's image, top row first: greys (rows, cols), or (rows, cols, 4) in mode scale.

    As Nav2's map saver: trinary applies its thresholds; scale writes free as bright and unknown as transparent; raw
    writes the values, with unknown as 255.
    """
    index = np.ascontiguousarray(grid.data[::-1]) + 1
    greys = _compute_greys(mode)[index]
    if mode != "scale":
        return greys
    opacity = np.where(index == 0, 0, 255).astype(np.uint8)
    return np.stack([greys, greys, greys, opacity], axis=-1)


def choose_mode(grid: CellGrid) -> Mode:
    """Return the mode that keeps every cell of a map: trinary without values between free and occupied, else raw."""
    return "trinary" if count_values(grid.data)[~np.isin(VALUES, (UNKNOWN, FREE, OCCUPIED))].sum() == 0 else "raw"


def read_back(mode: Mode) -> Cells:
    """Return each of `VALUES` after it was written in a mode and read back, shape (102,)."""
    values = compute_table(PixelRule(mode, False, OCCUPIED_THRESH, FREE_THRESH))[_compute_greys(mode)]
    if mode == "scale":
        values[0] = UNKNOWN  # Transparent.
    return values


def _compute_greys(mode: Mode) -> npt.NDArray[np.uint8]:
    """Return the grey of each of `VALUES`, shape (102,)."""
    if mode == "trinary":
        trinary = round_trinary(VALUES)
        table = np.where(trinary == OCCUPIED, _OCCUPIED_GREY, np.where(trinary == FREE, _FREE_GREY, UNKNOWN_GREY))
    elif mode == "scale":
        table = np.floor((100.0 - VALUES) / 100.0 * 255.0 + 0.5)
        table[0] = 128
    else:
        table = np.where(VALUES == UNKNOWN, _RAW_UNKNOWN, VALUES.astype(np.int16))
    return table.astype(np.uint8)


def _compose_yaml(grid: CellGrid, image: str, mode: Mode) -> str:
    # Full precision: Nav2's saver rounds to three decimals, which moves a map of 0.0125 m cells by metres.
    name = image if _PLAIN_NAME.fullmatch(image) else json.dumps(image)
    x, y, yaw = grid.origin.as_tuple()
    return (
        f"image: {name}\n"
        f"mode: {mode}\n"
        f"resolution: {grid.resolution!r}\n"
        f"origin: [{x!r}, {y!r}, {yaw!r}]\n"
        "negate: 0\n"
        f"occupied_thresh: {OCCUPIED_THRESH}\n"
        f"free_thresh: {FREE_THRESH}\n"
    ) + ("" if grid.surface == "border" else f"surface: {grid.surface}\n")


def save_pair(yaml_file: Path, suffix: str, content: bytes, compose: Callable[[str], str]) -> None:
    """Write a map's image, and then the YAML that names it.

    An image that a YAML refers to is never overwritten. The new image gets a new name: that of the YAML if it is free,
    else a hash of its content. The image of the replaced map is deleted at the end, if it has one of these names and no
    other YAML in the folder refers to it. A kill at any moment leaves either the old map or the new one.

    Args:
        yaml_file: The map's YAML.
        suffix: Suffix of the image: .png or .pgm.
        content: Bytes of the image.
        compose: Returns the YAML's text for the name of the image.

    Raises:
        OutputError: If they cannot be written; the old map is left unchanged.
    """
    replaced = _image_of(yaml_file)
    image, is_new = _write_image(yaml_file, suffix, content)
    text = compose(image.name)
    try:
        write_text(yaml_file, f"{text}{_AS_WRITTEN}{_digest(text, content)}\n", durable=True)
    except BaseException:
        if is_new:
            image.unlink(missing_ok=True)
        raise
    if replaced is not None and replaced != image and not _is_named_elsewhere(replaced, yaml_file):
        with suppress(OSError):  # The new map is complete; a leftover image is harmless.
            replaced.unlink()


def is_as_written(yaml_file: Path) -> bool:
    """Return whether a map's YAML and its image are byte for byte what was written: the YAML's last line tells."""
    text, mark, digest = _read_text(yaml_file).rpartition(_AS_WRITTEN)
    image = _image_of(yaml_file)
    if not mark or image is None or not image.is_file():
        return False
    return digest == f"{_digest(text, image.read_bytes())}\n"


def find_map_of(image: Path) -> Path | None:
    """Return a YAML file in an image's folder that names the image as that of a map; None if there is none."""
    name = re.escape(image.name)
    line = re.compile(rf"^image:\s*([\"']?)(?:\./)?{name}\1\s*(?:#.*)?$", re.MULTILINE)
    others = (path for path in image.parent.iterdir() if path.suffix.lower() in (".yaml", ".yml"))
    return next((path for path in sorted(others) if line.search(_read_text(path))), None)


def _digest(text: str, content: bytes) -> str:
    """Hash of a YAML's own lines and its image's bytes."""
    return hashlib.sha256(text.encode() + b"\0" + content).hexdigest()


def _write_image(yaml_file: Path, suffix: str, content: bytes) -> tuple[Path, bool]:
    """Write the image under the first name that is free or has the same content; tell whether the file is new."""
    names = _image_names(yaml_file.stem, suffix, content)
    while True:
        image = yaml_file.with_name(next(names))
        if write_new_bytes(image, content):
            return image, True
        if image.is_file() and image.read_bytes() == content:
            return image, False


def _image_names(stem: str, suffix: str, content: bytes) -> Iterator[str]:
    digest = hashlib.sha256(content).hexdigest()[:12]
    yield f"{stem}{suffix}"
    yield f"{stem}-{digest}{suffix}"
    for number in itertools.count(2):
        yield f"{stem}-{digest}-{number}{suffix}"


def _image_of(yaml_file: Path) -> Path | None:
    """Return the image that a YAML refers to, if it lies beside the YAML and is named after it."""
    name: object = None
    with suppress(yaml.YAMLError, RecursionError, ValueError):
        content: object = yaml.safe_load(_read_text(yaml_file))
        name = content.get("image") if isinstance(content, dict) else None
    ours = re.escape(yaml_file.stem) + r"(-[0-9a-f]{12}(-\d+)?)?\.(png|pgm)"
    return yaml_file.with_name(name) if isinstance(name, str) and re.fullmatch(ours, name) else None


def _is_named_elsewhere(image: Path, yaml_file: Path) -> bool:
    """Return whether the text of another YAML in the folder contains the image's name."""
    others = (path for path in image.parent.iterdir() if path.suffix.lower() in (".yaml", ".yml"))
    names = (image.name, json.dumps(image.name)[1:-1])
    return any(any(name in _read_text(path) for name in names) for path in others if path.name != yaml_file.name)


def _read_text(path: Path) -> str:
    with suppress(OSError):
        if path.is_file():
            with path.open(encoding="utf-8", errors="replace") as stream:
                return stream.read(_MOST_TEXT)
    return ""
