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
    try:
        write_text(yaml_file, compose(image.name), durable=True)
    except BaseException:
        if is_new:
            image.unlink(missing_ok=True)
        raise
    if replaced is not None and replaced != image and not _is_named_elsewhere(replaced, yaml_file):
        with suppress(OSError):  # The new map is complete; a leftover image is harmless.
            replaced.unlink()


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
    """The image that a YAML refers to, if it lies beside the YAML and is named after it."""
    name: object = None
    with suppress(yaml.YAMLError, RecursionError, ValueError):
        content: object = yaml.safe_load(_read_text(yaml_file))
        name = content.get("image") if isinstance(content, dict) else None
    ours = re.escape(yaml_file.stem) + r"(-[0-9a-f]{12}(-\d+)?)?\.(png|pgm)"
    return yaml_file.with_name(name) if isinstance(name, str) and re.fullmatch(ours, name) else None


def _is_named_elsewhere(image: Path, yaml_file: Path) -> bool:
    """Whether the text of another YAML in the folder contains the image's name."""
    others = (path for path in image.parent.iterdir() if path.suffix.lower() in (".yaml", ".yml"))
    names = (image.name, json.dumps(image.name)[1:-1])
    return any(any(name in _read_text(path) for name in names) for path in others if path.name != yaml_file.name)


def _read_text(path: Path) -> str:
    with suppress(OSError):
        if path.is_file():
            with path.open(encoding="utf-8", errors="replace") as stream:
                return stream.read(_MOST_TEXT)
    return ""
