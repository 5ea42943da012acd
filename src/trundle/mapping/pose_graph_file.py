"""`.posegraph` files: a pose graph as a zip of NumPy arrays and one JSON header, which NumPy alone reads.

`np.load("site.posegraph")["poses"]` is all that another program needs. Each array has the name, the type and the shape
that `PoseGraph` says; `posegraph.json` holds the format's version, the robot and the lidars, whose directions are one
after the other in `angles`.
"""

from __future__ import annotations

import json
import math
import os
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, BinaryIO, cast

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError
from trundle.files.npz import MAX_BYTES
from trundle.files.opening import describe_unreadable, open_file, parser_reason
from trundle.files.writing import atomic_path
from trundle.geometry import Pose2D
from trundle.mapping.pose_graph import MOST_BEAMS, MOST_LIDARS, Lidar, PoseGraph, check_pose_graph
from trundle.values import as_path, check_kind

FORMAT = "trundle pose graph"
VERSION = 1
HEADER = "posegraph.json"

_ARRAYS: dict[str, type[np.generic]] = {
    "times": np.float64,
    "parts": np.int32,
    "poses": np.float64,
    "odometry": np.float64,
    "scan_nodes": np.int32,
    "scan_lidars": np.int32,
    "scan_poses": np.float64,
    "ranges": np.float32,
    "edges": np.int32,
    "transforms": np.float64,
    "covariances": np.float64,
}
_MOST_HEADER_BYTES = 1_000_000
_MOST_DIMENSIONS = 3
_EARLY = (1980, 1, 1, 0, 0, 0)  # the same graph gives the same bytes: members have no time of their own
_NUMBERS = ("height", "range_min", "range_max", "time_increment")


def save_pose_graph(graph: PoseGraph, path: str | os.PathLike[str]) -> None:
    """Write a pose graph to a `.posegraph` file, whole or not at all; the same graph gives the same bytes.

    Args:
        graph: The graph.
        path: The file.

    Raises:
        InputError: If the graph's arrays do not belong together.
        OutputError: If the file cannot be written.
    """
    check_kind(graph, PoseGraph, "a pose graph", "give Mapper.graph()")
    check_pose_graph(graph)
    with atomic_path(path, durable=True) as temporary, zipfile.ZipFile(temporary, "w") as archive:
        header = json.dumps(_describe(graph), indent=1, allow_nan=False)
        archive.writestr(_member(HEADER), header)
        angles = np.concatenate([lidar.angles for lidar in graph.lidars]) if graph.lidars else np.zeros(0)
        for name, values in {**{name: getattr(graph, name) for name in _ARRAYS}, "angles": angles}.items():
            with archive.open(_member(f"{name}.npy"), "w", force_zip64=True) as stream:
                np.lib.format.write_array(stream, np.ascontiguousarray(values), allow_pickle=False)


def load_pose_graph(path: str | os.PathLike[str]) -> PoseGraph:
    """Read a pose graph from a `.posegraph` file. Every array is checked before it is used.

    Raises:
        InputError: If the file cannot be read, is of another program or version, is cut off or damaged, or its arrays
            do not belong together.
    """
    name = as_path(path, "a .posegraph file")
    try:
        with open_file(name) as stream:
            _check_magic(name, stream)
            with zipfile.ZipFile(stream) as archive:
                graph = _read(name, archive)
        check_pose_graph(graph)
    except OSError as problem:
        raise InputError(describe_unreadable(name, problem, "a .posegraph file")) from problem
    except InputError as problem:
        raise InputError(str(problem) if str(problem).startswith(name) else f"{name}: {problem}") from problem
    except MemoryError as problem:
        raise InputError(f"{name}: it does not fit into memory") from problem
    except Exception as problem:  # zipfile and numpy raise any exception on a damaged file
        raise InputError(f"{name}: cut off or damaged: {parser_reason(problem)}; {_ADVICE}") from problem
    return graph


_ADVICE = "give a copy that is whole, or map the recording again"


def _member(name: str) -> zipfile.ZipInfo:
    member = zipfile.ZipInfo(name, _EARLY)
    member.compress_type = zipfile.ZIP_DEFLATED
    member.external_attr = 0o644 << 16
    return member


def _describe(graph: PoseGraph) -> dict[str, object]:
    lidars = [
        {
            "name": lidar.name,
            "mount": list(lidar.mount.as_tuple()),
            "beams": len(lidar.angles),
            **{name: float(getattr(lidar, name)) for name in _NUMBERS},
        }
        for lidar in graph.lidars
    ]
    return {"format": FORMAT, "version": VERSION, "robot": graph.robot, "lidars": lidars}


def _check_magic(name: str, stream: BinaryIO) -> None:
    """Refuse files of other programs, with what to do instead."""
    begin = stream.read(64)
    stream.seek(0)
    if b"serialization::archive" in begin:  # Boost writes this after its length, in text and in binary archives
        raise InputError(
            f"{name}: a .posegraph of slam_toolbox: its scans are in a second file (.data), and both are C++ "
            "objects that only the same slam_toolbox reads. Map the recording itself with trundle map from-bag, or "
            "save slam_toolbox's map with its map saver and use that"
        )
    if begin.startswith(b"\xdb\x01\xf5\x5b\x7b\x1f\x1d\x7b"):  # Cartographer's kMagic, io/proto_stream.cc
        raise InputError(f"{name}: a .pbstream of Cartographer: map the recording itself with trundle map from-bag")
    if not begin:
        raise InputError(f"{name}: the file is empty; {_ADVICE}")
    if not begin.startswith(b"PK"):
        raise InputError(f"{name}: not a pose graph of trundle: it does not begin like one; give a .posegraph file")


@dataclass(frozen=True, slots=True)
class _Header:
    """What posegraph.json says."""

    robot: str
    lidars: tuple[Mapping[str, Any], ...]


def _read(name: str, archive: zipfile.ZipFile) -> PoseGraph:
    members = {member.filename: member for member in archive.infolist()}
    if HEADER not in members:
        raise InputError(f"{name}: not a pose graph of trundle: it has no {HEADER}; give a .posegraph file")
    header = _read_header(name, archive, members[HEADER])
    missing = [array for array in (*_ARRAYS, "angles") if f"{array}.npy" not in members]
    if missing:
        raise InputError(f"{name}: it has no {', '.join(missing)}; {_ADVICE}")
    size = sum(member.file_size for member in members.values())
    if size > MAX_BYTES:
        raise InputError(f"{name}: it unpacks to {size} bytes; the limit is {MAX_BYTES}")
    found = {array: _read_array(archive, members[f"{array}.npy"], kind) for array, kind in _ARRAYS.items()}
    angles = _read_array(archive, members["angles.npy"], np.float64)
    return PoseGraph(**cast("dict[str, Any]", found), lidars=_make_lidars(header, angles), robot=header.robot)


def _read_header(name: str, archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> _Header:
    if member.file_size > _MOST_HEADER_BYTES:
        raise InputError(f"{HEADER}: {member.file_size} bytes; it has at most {_MOST_HEADER_BYTES}")
    try:
        header = json.loads(archive.read(member))
    except (ValueError, RecursionError) as problem:
        raise InputError(f"{HEADER}: not JSON: {problem}; {_ADVICE}") from problem
    if not isinstance(header, dict) or header.get("format") != FORMAT:
        raise InputError(f"{name}: not a pose graph of trundle: {HEADER} does not say {FORMAT!r}")
    version = header.get("version")
    if version != VERSION:
        raise InputError(
            f"{name}: a pose graph of version {version!r}, and this trundle reads version {VERSION}; use the trundle "
            "that wrote it, or map the recording again"
        )
    robot, lidars = header.get("robot", ""), header.get("lidars")
    if not isinstance(robot, str) or not isinstance(lidars, list) or len(lidars) > MOST_LIDARS:
        raise InputError(f"{HEADER}: robot must be text and lidars a list of at most {MOST_LIDARS}")
    if not all(isinstance(lidar, dict) for lidar in lidars):
        raise InputError(f"{HEADER}: each of lidars must be an object")
    return _Header(robot, tuple(lidars))


def _make_lidars(header: _Header, angles: npt.NDArray[np.generic]) -> tuple[Lidar, ...]:
    beams = [count for lidar in header.lidars if type(count := lidar.get("beams")) is int and 1 <= count <= MOST_BEAMS]
    if len(beams) != len(header.lidars):
        raise InputError(f"{HEADER}: beams of a lidar must be 1 to {MOST_BEAMS}")
    if angles.shape != (sum(beams),):
        raise InputError(f"angles: shape {angles.shape}, and the lidars have {sum(beams)} beams")
    ends = np.cumsum([0, *beams])
    lidars: list[Lidar] = []
    for number, lidar in enumerate(header.lidars):
        mount = lidar.get("mount")
        values = [*(mount if isinstance(mount, list) else ()), *(lidar.get(name) for name in _NUMBERS)]
        if len(values) != 3 + len(_NUMBERS) or not isinstance(lidar.get("name"), str):
            raise InputError(f"{HEADER}: lidar {number} needs name, mount (x, y, yaw), {', '.join(_NUMBERS)}")
        if not all(type(value) in (int, float) and math.isfinite(value) and abs(value) < 1e9 for value in values):
            raise InputError(f"{HEADER}: lidar {number} has a number that is none, or not finite")
        x, y, yaw, *numbers = map(float, values)
        own = cast("npt.NDArray[np.float64]", angles[ends[number] : ends[number + 1]])
        lidars.append(Lidar(lidar["name"], Pose2D(x, y, math.remainder(yaw, math.tau)), numbers[0], own, *numbers[1:]))
    return tuple(lidars)


def _read_array(archive: zipfile.ZipFile, member: zipfile.ZipInfo, kind: type[np.generic]) -> npt.NDArray[np.generic]:
    """Read an array; its size is known to be that of the member before memory is taken for it."""
    name, wanted = member.filename, np.dtype(kind)
    with archive.open(member) as stream:
        version = np.lib.format.read_magic(cast("Any", stream))
        read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
        shape, by_columns, found = read(cast("Any", stream))
        if found != wanted or by_columns:
            raise InputError(f"{name}: an array of {found}; it must be {wanted}, row by row")
        count = math.prod(shape)
        if len(shape) > _MOST_DIMENSIONS or min(shape, default=0) < 0 or count * wanted.itemsize > member.file_size:
            raise InputError(f"{name}: shape {shape} does not fit {member.file_size} bytes")
        values = np.frombuffer(_read_bytes(stream, count * wanted.itemsize), dtype=wanted)
    return values.reshape(shape)


def _read_bytes(stream: Any, size: int) -> bytes:
    content = stream.read(size)
    if len(content) != size or stream.read(1):  # to the end, where the checksum is tested
        raise InputError(f"{stream.name}: {len(content)} of {size} bytes")
    return content
