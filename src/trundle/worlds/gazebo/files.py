"""Models that an SDF world includes: finding their files, and the built-in models that need none."""

from __future__ import annotations

import re
from pathlib import Path
from urllib.parse import unquote

from trundle.errors import WorldError
from trundle.files.opening import is_file
from trundle.files.xml_elements import XmlElement, parse_xml, read_xml
from trundle.worlds.gazebo.elements import VERSIONS

_PLAIN_FLOOR = b"""
<sdf version='1.6'><model name='ground_plane'><static>true</static><link name='link'><collision name='collision'>
<geometry><plane><normal>0 0 1</normal><size>100 100</size></plane></geometry></collision></link></model></sdf>
"""
"""Definition of Gazebo's `Ground Plane`."""


def find_model_file(path: Path | None) -> Path | None:
    """The SDF file of a model: the file itself, or the newest supported version listed in the folder's model.config."""
    if path is None or is_file(path):
        return path
    config = path / "model.config"
    if is_file(config):
        named: list[tuple[int, Path]] = []
        for element in read_xml(config, error=WorldError).iter("sdf"):
            file, version = path / (element.text or "").strip(), element.get("version", "").strip()
            if is_file(file):
                named.append((VERSIONS.index(version) if version in VERSIONS else -1, file))
        if named:
            # The last of equally new ones, as in Gazebo.
            return max(reversed(named), key=lambda entry: entry[0])[1]
    return path / "model.sdf" if is_file(path / "model.sdf") else None


def is_plain_floor(uri: str) -> bool:
    """Whether a URI is that of Gazebo's `Ground Plane`, by model:// or on Fuel."""
    return _plain_name(uri) == "ground plane"


def is_sun(uri: str) -> bool:
    """Whether a URI is that of Gazebo's `Sun`, a light."""
    return _plain_name(uri) == "sun"


def read_plain_floor(file: Path) -> XmlElement:
    """Gazebo's `Ground Plane`, as if read from a file."""
    return parse_xml(file, _PLAIN_FLOOR, error=WorldError)


def _plain_name(uri: str) -> str:
    """The name of the model in a URI, in lower case with spaces; empty if the URI is not a model's."""
    path = re.sub(r"/(\d+|tip)$", "", unquote(uri).strip().rstrip("/"))
    scheme, mark, rest = path.partition("://")
    words = rest.split("/")
    if not mark or (scheme == "model" and len(words) != 1) or (scheme != "model" and "models" not in words):
        return ""
    return words[-1].lower().replace("_", " ")
