"""Colours of USD's prims: displayColor, else the plain colour of the material."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from pxr import UsdGeom, UsdShade

from trundle.geometry.solids import Color
from trundle.worlds.usd.walk import TIME

GREY: Color = (0.6, 0.6, 0.62, 1.0)

# Of UsdPreviewSurface and of Omniverse's materials.
_INPUTS = ("diffuseColor", "diffuse_color_constant", "diffuse_tint", "base_color", "baseColor")


@dataclass(slots=True)
class Colors:
    """Finds colours; caches those of materials."""

    _materials: dict[str, Color | None] = field(default_factory=dict)

    def of(self, prim: Any) -> Color:
        """A prim's colour; the mean if it has one per vertex."""
        primvars = UsdGeom.PrimvarsAPI(prim)
        values = primvars.FindPrimvarWithInheritance("displayColor").ComputeFlattened(TIME)
        if values and np.ndim(values) == 2:
            opacities = primvars.FindPrimvarWithInheritance("displayOpacity").ComputeFlattened(TIME)
            return _color(np.mean(values, axis=0), float(np.mean(opacities)) if np.ndim(opacities) == 1 else 1.0)
        material = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0]
        if not material:
            return GREY
        path = str(material.GetPath())
        if path not in self._materials:
            self._materials[path] = _material_color(material)
        return self._materials[path] or GREY


def _material_color(material: Any) -> Color | None:
    for context in (UsdShade.Tokens.universalRenderContext, "mdl"):
        shader = material.ComputeSurfaceSource(context)[0]
        for name in _INPUTS if shader else ():
            entry = shader.GetInput(name)
            value = entry.Get(TIME) if entry else None
            if value is not None and np.shape(value) == (3,):
                return _color(np.array(value), 1.0)
    return None


def _color(rgb: Any, opacity: float) -> Color:
    if not (np.isfinite(rgb).all() and np.isfinite(opacity)):
        return GREY
    red, green, blue, alpha = (float(value) for value in np.clip([*rgb, opacity], 0.0, 1.0))
    return red, green, blue, alpha
