"""Damaged .npz files, as they were found: one typed error."""

from __future__ import annotations

import random
import zipfile

import numpy as np
import pytest

from trundle.errors import MapError, TrundleError
from trundle.files.npz import read_arrays
from trundle.maps import HeightField
from trundle.mission import Trajectory


@pytest.fixture
def archive(tmp_path):
    np.savez_compressed(tmp_path / "a.npz", heights=np.arange(400.0).reshape(20, 20), resolution=0.1)
    return tmp_path / "a.npz"


def spoil(archive, at: int, value: int):
    content = bytearray(archive.read_bytes())
    content[at] = value
    archive.write_bytes(content)


def test_arrays_come_back_with_the_names_that_there_are(archive):
    found, there = read_arrays(archive, ("resolution", "none"), error=MapError)
    assert there == ["heights", "resolution"]
    assert {name: float(value) for name, value in found.items()} == {"resolution": 0.1}


def test_a_broken_stream_is_refused(archive):
    """zlib.error, which is no ValueError."""
    spoil(archive, 200, 0xFF)
    with pytest.raises(MapError, match=r"a\.npz: not a \.npz file of numbers"):
        HeightField.load(archive)


def test_other_compression_methods_are_refused(archive):
    """NotImplementedError: the number of the method in the directory."""
    content = archive.read_bytes()
    spoil(archive, content.index(b"PK\x01\x02") + 10, 99)
    with pytest.raises(MapError, match="compression method"):
        HeightField.load(archive)


def test_more_than_is_read_is_refused(archive, monkeypatch):
    monkeypatch.setattr("trundle.files.npz.MAX_BYTES", 1000)
    with pytest.raises(MapError, match=r"unpacks to \d+ bytes"):
        HeightField.load(archive)


def test_encrypted_members_are_refused(archive):
    with zipfile.ZipFile(archive) as found:
        at = found.infolist()[0].header_offset + 6
    spoil(archive, at, 1)
    spoil(archive, archive.read_bytes().index(b"PK\x01\x02") + 8, 1)
    with pytest.raises(MapError, match=r"not a \.npz file"):
        HeightField.load(archive)


def test_a_member_that_is_no_array_is_refused(archive):
    """Where the format's mark is missing, NumPy gives the bytes."""
    with zipfile.ZipFile(archive) as found:
        members = {name: found.read(name) for name in found.namelist()}
    members["resolution.npy"] = b"0" + members["resolution.npy"]
    with zipfile.ZipFile(archive, "w") as changed:
        for name, content in members.items():
            changed.writestr(name, content)
    with pytest.raises(MapError, match=r"a\.npz: not a \.npz file of numbers: resolution is no array"):
        HeightField.load(archive)


@pytest.mark.parametrize("load", [HeightField.load, Trajectory.load])
def test_whatever_is_damaged_the_error_is_typed(tmp_path, load):
    rows = {name: np.arange(50) for name in Trajectory.columns()}
    Trajectory(**{**rows, "localization": np.arange(50) % 3}).save(tmp_path / "t.npz")
    HeightField(np.random.default_rng(0).random((9, 9)), 0.1).save(tmp_path / "h.npz")
    whole = (tmp_path / ("t.npz" if load == Trajectory.load else "h.npz")).read_bytes()
    refused = 0
    for seed in range(300):
        generator, content = random.Random(seed), bytearray(whole)
        for _ in range(generator.choice((1, 1, 3))):
            content[generator.randrange(len(content))] = generator.randrange(256)
        (tmp_path / "x.npz").write_bytes(content)
        try:
            load(tmp_path / "x.npz")
        except TrundleError:
            refused += 1
    assert refused > 100
