"""A map's two files, image and YAML, replaced as one: the rename of the YAML is the commit."""

from __future__ import annotations

import hashlib
import itertools
import json
import re
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

import yaml

from trundle.files.writing import write_new_bytes, write_text

_MOST_TEXT = 100_000
"""Characters of a YAML file that are searched for the name of its image."""


def save_pair(yaml_file: Path, suffix: str, content: bytes, compose: Callable[[str], str]) -> None:
    """Write a map's image, and then the YAML that names it.

    No image that a YAML names is ever written over. The new one gets a name of its own: that of the YAML where it is
    free, else one from its content. The image of the map that was replaced is deleted at the end, where it has one of
    these names and no other YAML in the folder names it. A kill at any moment leaves the old map or the new one.

    Args:
        yaml_file: The map's YAML.
        suffix: Of the image: .png or .pgm.
        content: Of the image.
        compose: Gives the YAML's text for the name of the image.

    Raises:
        OutputError: If they cannot be written; the old map is left as it was.
    """
    replaced = _image_of(yaml_file)
    image, is_new = _write_image(yaml_file, suffix, content)
    try:
        write_text(yaml_file, compose(image.name), durable=True)
    except BaseException:
        if is_new:
            image.unlink(missing_ok=True)
        raise
    if replaced is not None and replaced != image and not _is_named_elsewhere(replaced, yaml_file):
        with suppress(OSError):  # The new map is there; an image that is left does no harm.
            replaced.unlink()


def _write_image(yaml_file: Path, suffix: str, content: bytes) -> tuple[Path, bool]:
    """Write the image under the first name that is free or holds the same; and whether the file is new."""
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
    """The image beside a YAML that it names, where that is named after it."""
    name: object = None
    with suppress(yaml.YAMLError, RecursionError, ValueError):
        content: object = yaml.safe_load(_read_text(yaml_file))
        name = content.get("image") if isinstance(content, dict) else None
    ours = re.escape(yaml_file.stem) + r"(-[0-9a-f]{12}(-\d+)?)?\.(png|pgm)"
    return yaml_file.with_name(name) if isinstance(name, str) and re.fullmatch(ours, name) else None


def _is_named_elsewhere(image: Path, yaml_file: Path) -> bool:
    """Whether another YAML of the folder names an image, or might: its text is searched."""
    others = (path for path in image.parent.iterdir() if path.suffix.lower() in (".yaml", ".yml"))
    names = (image.name, json.dumps(image.name)[1:-1])
    return any(any(name in _read_text(path) for name in names) for path in others if path.name != yaml_file.name)


def _read_text(path: Path) -> str:
    with suppress(OSError):
        if path.is_file():
            with path.open(encoding="utf-8", errors="replace") as stream:
                return stream.read(_MOST_TEXT)
    return ""
