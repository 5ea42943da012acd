"""Files that an SDF world refers to, meshes and included models, and the built-in models that need none."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import unquote

from trundle.errors import WorldError
from trundle.files.mesh import MeshPart, read_mesh
from trundle.files.opening import is_file
from trundle.files.uris import describe_search, find_uri
from trundle.files.xml_elements import XmlElement, parse_xml, read_xml
from trundle.worlds.gazebo.elements import VERSIONS

_PLAIN_FLOOR = b"""
<sdf version='1.6'><model name='ground_plane'><static>true</static><link name='link'><collision name='collision'>
<geometry><plane><normal>0 0 1</normal><size>100 100</size></plane></geometry></collision></link></model></sdf>
"""
"""Definition of Gazebo's `Ground Plane`."""


class MissingFileError(WorldError):
    """A mesh or a model that a world refers to is missing."""


@dataclass(slots=True)
class Files:
    """Resolves URIs, and caches the meshes that were read.

    Attributes:
        folders: Folders to search for models and packages.
    """

    folders: tuple[Path, ...]
    _meshes: dict[Path, list[MeshPart]] = field(default_factory=dict[Path, list[MeshPart]])

    def find(self, uri: str, base: Path) -> Path | None:
        """Return the file or folder that a URI refers to, relative to the folder `base`; see `find_uri`."""
        return find_uri(uri, base, self.folders)

    def mesh(self, path: Path) -> list[MeshPart]:
        """Return the meshes of a file."""
        key = path.resolve()
        if key not in self._meshes:
            self._meshes[key] = read_mesh(path)
        return self._meshes[key]

    def advise(self) -> str:
        """Return the searched folders and what to do about a missing file, for messages."""
        return (
            f"searched: {describe_search(self.folders)}. Give its folder with --paths FOLDER (paths=…), or skip "
            "missing files with --set missing=skip"
        )


def find_model_file(path: Path | None) -> Path | None:
    """Return the SDF file of a model: the file itself, or the newest supported version that a model.config lists."""
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
    """Return whether a URI is that of Gazebo's `Ground Plane`, by model:// or on Fuel."""
    return _plain_name(uri) == "ground plane"


def is_sun(uri: str) -> bool:
    """Return whether a URI is that of Gazebo's `Sun`, a light."""
    return _plain_name(uri) == "sun"


def read_plain_floor(file: Path) -> XmlElement:
    """Return Gazebo's `Ground Plane`, as if it were read from a file."""
    return parse_xml(file, _PLAIN_FLOOR, error=WorldError)


def _plain_name(uri: str) -> str:
    """Return the name of the model in a URI, in lower case with spaces; empty if the URI is not a model's."""
    path = re.sub(r"/(\d+|tip)$", "", unquote(uri).strip().rstrip("/"))
    scheme, mark, rest = path.partition("://")
    words = rest.split("/")
    if not mark or (scheme == "model" and len(words) != 1) or (scheme != "model" and "models" not in words):
        return ""
    return words[-1].lower().replace("_", " ")
