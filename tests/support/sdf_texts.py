"""Texts of SDF worlds."""

from __future__ import annotations

from pathlib import Path

from trundle.worlds import World

CUBE = "<geometry><box><size>1 2 3</size></box></geometry>"


def model(inner: str, name: str = "m", static: str = "<static>1</static>") -> str:
    return f"<model name='{name}'>{static}{inner}</model>"


def link(geometry: str = CUBE, name: str = "l", pose: str = "", extra: str = "") -> str:
    return f"<link name='{name}'>{pose}<collision name='c'>{geometry}{extra}</collision></link>"


def write(folder: Path, body: str, version: str = "1.9", name: str = "w.sdf") -> Path:
    file = folder / name
    file.write_text(f"<?xml version='1.0'?>\n<sdf version='{version}'>\n<world name='hall'>\n{body}\n</world></sdf>")
    return file


def load(folder: Path, body: str, version: str = "1.9", **options) -> World:
    return World.load(write(folder, body, version), **options)


def only(world: World):
    assert len(world.solids) == 1
    return world.solids[0]


TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"


def mesh(uri: str, scale: str = "") -> str:
    return f"<geometry><mesh><uri>{uri}</uri>{scale}</mesh></geometry>"
