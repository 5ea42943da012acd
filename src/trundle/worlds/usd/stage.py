"""Opening USD stages: clear errors for bad files, and the conversion to metres with z up."""

from __future__ import annotations

import logging
import math
import re
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import Any

import numpy as np
from pxr import Sdf, Tf, Usd, UsdGeom, UsdUtils

from trundle.errors import WorldError, WorldWarning
from trundle.files.opening import check_regular, describe_unreadable, parser_reason
from trundle.geometry import FloatArray

log = logging.getLogger(__name__)

SUFFIXES = (".usd", ".usda", ".usdc", ".usdz")

_SHOWN = 20  # missing references that are told one by one; a stage that was copied alone may miss thousands
_VARIANT = re.compile(r"(?P<prim>/[^{}]*)\{(?P<set>[^={}]+)=(?P<name>[^={}]*)\}")


@contextmanager
def opened(path: str) -> Iterator[Any]:
    """Open the stage of a file; USD errors while the block reads it become a `WorldError`.

    USD's warnings go to this module's log and not to the terminal.

    Raises:
        WorldError: If there is no such file, or USD cannot read it.
    """
    try:
        check_regular(path)
    except OSError as error:
        raise WorldError(describe_unreadable(path, error)) from error
    delegate = UsdUtils.CoalescingDiagnosticDelegate()
    try:
        yield Usd.Stage.Open(path)
    except Tf.ErrorException as error:
        raise WorldError(f"{path}: cannot be read as a USD file: {usd_reason(error)}") from None
    except (RuntimeError, UnicodeDecodeError) as error:
        raise WorldError(f"{path}: cannot be read as a USD file: {parser_reason(error)}") from error
    except (TypeError, OverflowError) as error:  # from attributes with an unexpected type
        raise WorldError(f"{path}: it has a value of the wrong type or out of range: {error}") from error
    finally:
        with suppress(UnicodeDecodeError):
            for item in delegate.TakeUncoalescedDiagnostics():
                log.debug("%s: %s", path, item.commentary)


def select_variants(path: str, stage: Any, variants: Sequence[str]) -> None:
    """Select variants, each given as `/prim{set=variant}`, overriding the file's selections; the file is not modified.

    Raises:
        WorldError: If a selection names an unknown prim, set or variant; the message lists the known ones.
    """
    with Usd.EditContext(stage, stage.GetSessionLayer()):
        for text in variants:
            match = _VARIANT.fullmatch(text)
            if match is None or not Sdf.Path.IsValidPathString(match["prim"])[0]:
                raise WorldError(f"a variant is selected as /prim/path{{set=variant}}, got {text!r}")
            prim = stage.GetPrimAtPath(match["prim"])
            if not prim:
                raise WorldError(f"{path}: there is no prim {match['prim']} to select a variant of ({text})")
            sets = prim.GetVariantSets()
            if match["set"] not in sets.GetNames():
                known = ", ".join(sets.GetNames()) or "none"
                raise WorldError(f"{path}: {match['prim']} has no variant set {match['set']!r}; it has: {known}")
            names = sets.GetVariantSet(match["set"]).GetVariantNames()
            if match["name"] not in names:
                raise WorldError(
                    f"{path}: variant set {match['set']!r} of {match['prim']} has no {match['name']!r}; "
                    f"it has: {', '.join(names)}"
                )
            sets.SetSelection(match["set"], match["name"])


def report_missing(path: str, stage: Any, *, refuse: bool, is_excluded: Callable[[str], bool]) -> None:
    """Report references, payloads and sublayers that could not be composed, except under excluded prims.

    Raises:
        WorldError: If there is one and `refuse` is set.
    """
    found: dict[str, None] = {}
    for error in stage.GetCompositionErrors():
        prim = str(error.rootSite.path)
        if not is_excluded(prim):
            found[f"{prim}: {_one_line(str(error))}"] = None
    if not found:
        return
    if refuse:
        more = f" (and {len(found) - _SHOWN} more)" if len(found) > _SHOWN else ""
        raise WorldError(f"{path}: {'; '.join(list(found)[:_SHOWN])}{more}")
    for text in list(found)[:_SHOWN]:
        warn(f"{path}: {text}. It is left out")
    if len(found) > _SHOWN:
        warn(f"{path}: {len(found) - _SHOWN} more references are missing and are left out")


def to_metres(path: str, stage: Any, meters_per_unit: float | None, up_axis: str | None) -> FloatArray:
    """Return the matrix, shape (4, 4), from the stage's units and axes to metres with z up; it acts on columns.

    Raises:
        WorldError: If the unit is not a positive number, or the axis neither Y nor Z.
    """
    if meters_per_unit is None:
        meters_per_unit = float(UsdGeom.GetStageMetersPerUnit(stage))
        if not UsdGeom.StageHasAuthoredMetersPerUnit(stage):
            warn(
                f"{path}: it does not set metersPerUnit, so USD's default of {meters_per_unit:g} m is used; "
                "give meters_per_unit=1 if the world comes out a hundredth of its size"
            )
    if not (math.isfinite(meters_per_unit) and meters_per_unit > 0.0):
        raise WorldError(f"{path}: metersPerUnit must be a positive number, got {meters_per_unit}")
    axis = up_axis or str(UsdGeom.GetStageUpAxis(stage))
    matrix = np.diag([meters_per_unit, meters_per_unit, meters_per_unit, 1.0])
    if axis == "Y":
        matrix = matrix @ np.array([[1.0, 0, 0, 0], [0, 0, -1.0, 0], [0, 1.0, 0, 0], [0, 0, 0, 1.0]])
    elif axis != "Z":
        raise WorldError(f"{path}: the up axis must be Y or Z, got {axis!r}")
    return matrix


def warn(message: str) -> None:
    """Issue a `WorldWarning`."""
    warnings.warn(message, WorldWarning, stacklevel=2)


def usd_reason(error: Exception) -> str:
    """Return USD's error message in one line, without source code locations."""
    try:
        text = str(error)
    except UnicodeDecodeError:  # its message quotes the file's bytes
        return parser_reason(error)
    said = re.findall(r"in file .*? : '(.*?)'\s*$", text, flags=re.MULTILINE | re.DOTALL)
    return _one_line(said[0] if said else text)


def _one_line(text: str) -> str:
    return " ".join(text.split()).rstrip(" .")
