"""`.posegraph` files: written whole, read by NumPy alone, and refused with a reason where they are not right."""

from __future__ import annotations

import io
import json
import zipfile
from dataclasses import fields, replace

import numpy as np
import pytest

from support.pose_graphs import make_graph
from trundle.errors import InputError, OutputError
from trundle.geometry import Pose2D
from trundle.mapping import load_pose_graph, move_pose_graph, save_pose_graph


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "site.posegraph"
    save_pose_graph(make_graph(), path)
    return path


def rewrite(file, **members):
    """Replace members of the zip; None leaves one out."""
    with zipfile.ZipFile(file) as archive:
        content = {name: archive.read(name) for name in archive.namelist()}
    content |= {name.replace("_json", ".json").replace("__", "."): value for name, value in members.items()}
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, value in content.items():
            if value is not None:
                archive.writestr(name, value)


def npy(values):
    stream = io.BytesIO()
    np.save(stream, values)
    return stream.getvalue()


def test_a_graph_is_read_as_it_was_written(file):
    graph, found = make_graph(), load_pose_graph(file)
    for field in fields(graph):
        if field.name in ("robot", "lidars"):
            continue
        written, read = getattr(graph, field.name), getattr(found, field.name)
        assert read.dtype == written.dtype
        np.testing.assert_array_equal(read, written)
    assert found.robot == "nova_carter"
    for one, other in zip(graph.lidars, found.lidars, strict=True):
        np.testing.assert_array_equal(one.angles, other.angles)
        assert (one.name, one.mount, one.height, one.range_max, one.time_increment) == (
            other.name,
            other.mount,
            other.height,
            other.range_max,
            other.time_increment,
        )


def test_numpy_alone_reads_it(file):
    with np.load(file) as stored:
        np.testing.assert_array_equal(stored["poses"], make_graph().poses)
        assert json.loads(stored["posegraph.json"])["version"] == 1


def test_the_same_graph_gives_the_same_bytes(file, tmp_path):
    save_pose_graph(load_pose_graph(file), tmp_path / "again.posegraph")
    assert (tmp_path / "again.posegraph").read_bytes() == file.read_bytes()


def test_an_empty_graph_is_written_and_read(tmp_path):
    graph = make_graph()
    none = {name: getattr(graph, name)[:0] for name in ("times", "parts", "poses", "odometry", "ranges")}
    none |= {name: getattr(graph, name)[:0] for name in ("scan_nodes", "scan_lidars", "scan_poses")}
    none |= {name: getattr(graph, name)[:0] for name in ("edges", "transforms", "covariances")}
    save_pose_graph(replace(graph, **none, lidars=()), tmp_path / "empty.posegraph")
    assert len(load_pose_graph(tmp_path / "empty.posegraph").times) == 0


@pytest.mark.parametrize("share", [0.0, 0.1, 0.5, 0.99])
def test_a_file_that_is_cut_off_is_refused(file, share):
    content = file.read_bytes()
    file.write_bytes(content[: int(len(content) * share)])
    with pytest.raises(InputError, match=r"site\.posegraph: .*(cut off|empty).*map the recording again"):
        load_pose_graph(file)


def test_another_version_is_refused(file):
    rewrite(file, posegraph_json=json.dumps({"format": "trundle pose graph", "version": 2, "lidars": []}))
    with pytest.raises(InputError, match=r"of version 2, and this trundle reads version 1"):
        load_pose_graph(file)


@pytest.mark.parametrize(
    ("begin", "said"),
    [
        (b"\x16\0\0\0\0\0\0\0serialization::archive\x11\0", "of slam_toolbox: its scans are in a second file"),
        (b"22 serialization::archive 17 0 0", "of slam_toolbox"),
        (bytes.fromhex("db01f55b7b1f1d7b"), "of Cartographer"),
        (b"\x93NUMPY", "not a pose graph of trundle"),
    ],
)
def test_files_of_other_programs_are_refused_with_a_reason(tmp_path, begin, said):
    (tmp_path / "other.posegraph").write_bytes(begin + bytes(100))
    with pytest.raises(InputError, match=said):
        load_pose_graph(tmp_path / "other.posegraph")


def test_a_zip_of_something_else_is_refused(file):
    rewrite(file, posegraph_json=None)
    with pytest.raises(InputError, match=r"it has no posegraph\.json"):
        load_pose_graph(file)


BAD = {
    "edges out of bounds": ("edges", lambda graph: graph.edges + np.int32([[0, 9, 0]]), r"edges\[0, 1\] is 10"),
    "an edge of one node": (
        "edges",
        lambda graph: graph.edges * np.int32([[1, 0, 1]]),
        "ties node 0 to itself",
    ),
    "a kind that is none": ("edges", lambda graph: graph.edges + np.int32([[0, 0, 2]]), r"edges\[0\] is of kind 2"),
    "a pose that is NaN": ("poses", lambda graph: graph.poses * np.nan, r"poses\[0, 0\] is nan"),
    "far away": ("odometry", lambda graph: graph.odometry + 1e9, r"odometry\[0, 0\] is 1e\+09|1000000000"),
    "times that are infinite": ("times", lambda graph: graph.times * np.inf, r"times\[0\] is inf"),
    "no covariance": ("covariances", lambda graph: -graph.covariances, r"covariances\[0\] is no covariance"),
    "fewer ranges": ("ranges", lambda graph: graph.ranges[:-1], r"59 of them, and the beams of all scans are 60"),
    "negative ranges": ("ranges", lambda graph: graph.ranges - np.float32(20.0), r"ranges\[\d+\] is negative"),
    "scans not in order": ("scan_nodes", lambda graph: graph.scan_nodes[::-1], "they must be ascending"),
    "a lidar that is none": ("scan_lidars", lambda graph: graph.scan_lidars + np.int32(1), r"scan_lidars\[1\] is 2"),
    "floats for integers": ("parts", lambda graph: graph.parts.astype(float), "float64.*; it must be int32"),
    "another shape": ("transforms", lambda graph: graph.transforms[:, :2], r"shape \(5, 2\); it must be"),
}


@pytest.mark.parametrize("case", BAD)
def test_arrays_that_do_not_belong_together_are_refused(file, case):
    name, change, said = BAD[case]
    values = change(make_graph())
    with pytest.raises(InputError, match=said):
        save_pose_graph(replace(make_graph(), **{name: values}), file)
    rewrite(file, **{f"{name}__npy": npy(values)})
    with pytest.raises(InputError, match=rf"site\.posegraph: .*({said})"):
        load_pose_graph(file)


def test_a_size_that_the_file_does_not_have_takes_no_memory(file):
    header = b"{'descr': '<f8', 'fortran_order': False, 'shape': (100000000000, 3), }\n"
    rewrite(file, poses__npy=b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header)
    with pytest.raises(InputError, match=r"poses\.npy: shape \(100000000000, 3\) does not fit"):
        load_pose_graph(file)


def test_objects_are_never_unpickled(file):
    rewrite(file, parts__npy=npy(np.zeros(5, dtype=np.int32)).replace(b"<i4'", b"|O' "))
    with pytest.raises(InputError, match=r"parts\.npy: an array of object"):
        load_pose_graph(file)


def test_a_missing_file_and_a_folder_that_is_none_are_told(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        load_pose_graph(tmp_path / "none.posegraph")
    with pytest.raises(OutputError):
        save_pose_graph(make_graph(), tmp_path / "none" / "site.posegraph")


def test_nothing_half_written_is_left(tmp_path):
    graph = replace(make_graph(), robot="\0")
    with pytest.raises(InputError, match="printable"):
        save_pose_graph(graph, tmp_path / "site.posegraph")
    assert list(tmp_path.iterdir()) == []


def test_a_moved_graph_lies_where_its_origin_was_put():
    graph = make_graph()
    moved = move_pose_graph(graph, Pose2D(10.0, 5.0, np.pi / 2))
    np.testing.assert_allclose(moved.poses[:, 0], 10.0 - graph.poses[:, 1])
    np.testing.assert_allclose(moved.poses[:, 1], 5.0 + graph.poses[:, 0])
    assert moved.odometry is graph.odometry
