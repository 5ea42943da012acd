"""Worlds from USD files (OpenUSD; Isaac Sim's scenes), through usd-core."""

from __future__ import annotations

import importlib
import importlib.util
import os
import signal
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from types import FrameType

from trundle.errors import MissingExtraError
from trundle.extras import install_line
from trundle.worlds.leave_out import split_words
from trundle.worlds.usd.options import Geometry, Missing, Options, Purpose, UpAxis
from trundle.worlds.world import World

_MODULES = ("Usd", "Gf", "Sdf", "Tf", "UsdGeom", "UsdPhysics", "UsdShade", "UsdUtils", "Vt")
"""The USD modules that the readers and the exporters use."""


@contextmanager
def interrupts_deferred() -> Iterator[None]:
    """Defer Ctrl-C until the block has ended.

    While they are imported, USD's modules run Python from C++ and discard its exceptions, KeyboardInterrupt included:
    the program would continue with a partly loaded module.
    """
    before = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(before):
        yield  # handlers run only in the main thread
        return
    pending: list[tuple[int, FrameType | None]] = []
    signal.signal(signal.SIGINT, lambda number, frame: pending.append((number, frame)))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
        if pending:
            before(*pending[0])


def need_usd(purpose: str) -> None:
    """Check that usd-core can be imported; call it before importing any module that imports `pxr`.

    Raises:
        MissingExtraError: If it is not installed; the message has the install line.
    """
    install = install_line("usd")
    if importlib.util.find_spec("isaacsim") is not None:
        install += " in another Python than Isaac Sim's, which brings its own USD and does not start beside this one"
    try:
        with interrupts_deferred():
            for name in _MODULES:
                importlib.import_module(f"pxr.{name}")
    except ImportError as error:
        raise MissingExtraError(purpose, "usd-core", install) from error


def load_usd(
    path: str | os.PathLike[str],
    *,
    geometry: Geometry = "auto",
    exclude: str | Sequence[str] = (),
    missing: Missing = "skip",
    purposes: str | Sequence[Purpose] = ("default", "render"),
    variants: str | Sequence[str] = (),
    meters_per_unit: float | None = None,
    up_axis: UpAxis | None = None,
) -> World:
    """Load the geometry of a USD stage as a world; nothing in it moves.

    Stages in any unit and with either axis up come out in metres with z up. Solids are named by their prims' paths
    (`/World/Racks[3]/Shelf` inside the fourth instance of a point instancer) and take their kind from their
    semantic label. A level plane prim that faces up is the ground at its height (`worlds.ground.find_ground` chooses
    among several) and makes no solid, any other is a rectangle.

    Lists of words may also be one text with commas between them.

    Args:
        path: A .usd, .usda, .usdc or .usdz file.
        geometry: `"collision"` reads prims with UsdPhysics' collision API, in the shape of their approximation, visible
            or not; `"visual"` reads visible prims; `"auto"` reads colliders if the stage has any besides planes, with a
            warning about visible shapes far from all colliders.
        exclude: What to leave out, with everything below it: prim paths (`/World/Robot`, `*` and `?` as wildcards),
            semantic labels, and the words `floor` (besides the label: prims that end within 1 cm above z = 0) and
            `ceiling` (prims that start above 2 m and are wider than high).
        missing: What to do about a missing reference, payload or sublayer: "skip" it with a warning, or "error".
        purposes: Which visual geometry counts: `default`, `render`, `proxy`, `guide`.
        variants: Selections that replace the file's own, as `/World/Rack{size=large}`.
        meters_per_unit: Overrides the stage's value.
        up_axis: Overrides the stage's value.

    Raises:
        WorldError: If the file or a prim in it cannot be used; both are named.
        MissingExtraError: If usd-core is not installed.

    Warns:
        WorldWarning: About parts that are left out, and about probable mistakes.
    """
    need_usd("reading USD")
    from trundle.worlds.usd.load import load

    options = Options(
        geometry=geometry,
        exclude=split_words(exclude),
        missing=missing,
        purposes=split_words(purposes),
        variants=split_words(variants),
        meters_per_unit=meters_per_unit,
        up_axis=up_axis,
    )
    return load(os.fspath(path), options)


__all__ = ["load_usd", "need_usd"]
