"""Worlds from USD files (OpenUSD; Isaac Sim's scenes), through usd-core."""

from __future__ import annotations

import importlib
import importlib.util
import os
from collections.abc import Sequence

from trundle.errors import MissingExtraError
from trundle.worlds.usd.interrupts import interrupts_deferred
from trundle.worlds.usd.words import Geometry, Missing, Purpose, UpAxis
from trundle.worlds.world import World

_MODULES = ("Usd", "Gf", "Sdf", "Tf", "UsdGeom", "UsdPhysics", "UsdShade", "UsdUtils", "Vt")
"""All that is used of USD, here and in the exporter."""


def need_usd(purpose: str) -> None:
    """Check that usd-core can be imported; everything that imports `pxr` is imported after this.

    Raises:
        MissingExtraError: If it is not installed; the message has the install line.
    """
    install = 'pip install "trundle[usd]"'
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
    (`/World/Racks[3]/Shelf` inside the fourth instance of a point instancer) and are of the kind that their semantic
    label says. A level plane prim that faces up is the ground at its height (`worlds.ground.find_ground` says which of
    several) and makes no solid, any other is a rectangle.

    Lists of words may also be one text with commas between them.

    Args:
        path: A .usd, .usda, .usdc or .usdz file.
        geometry: `"collision"` takes what has UsdPhysics' collision API, in the shape that its approximation says,
            seen or not; `"visual"` what is seen; `"auto"` the colliders of a stage that has any besides planes, with a
            warning where something is seen far from all of them.
        exclude: What to leave out with all that is below it: prim paths (`/World/Robot`, also with `*` and `?`),
            semantic labels, and the words `floor` (besides the label: what ends within 1 cm above z = 0) and `ceiling`
            (what starts above 2 m and is wider than high).
        missing: What to do where a reference, payload or sublayer cannot be had: "skip" it with a warning, or "error".
        purposes: Which visual geometry counts: `default`, `render`, `proxy`, `guide`.
        variants: Selections that replace the file's own, as `/World/Rack{size=large}`.
        meters_per_unit: Replaces what the stage says.
        up_axis: Replaces what the stage says.

    Raises:
        WorldError: If the file or a prim in it cannot be used; both are named.
        MissingExtraError: If usd-core is not installed.

    Warns:
        WorldWarning: About what is left out, and about what is probably not meant.
    """
    need_usd("reading USD")
    from trundle.worlds.usd.load import Options, load

    options = Options.of(
        geometry=geometry,
        exclude=exclude,
        missing=missing,
        purposes=purposes,
        variants=variants,
        meters_per_unit=meters_per_unit,
        up_axis=up_axis,
    )
    return load(os.fspath(path), options)


__all__ = ["load_usd", "need_usd"]
