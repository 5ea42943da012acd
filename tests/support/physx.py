"""Whether PhysX can be run here, and stages for it."""

from __future__ import annotations

import pytest

from trundle.errors import TrundleError
from trundle.sim.physx.engine import check_installation


def _what_is_missing() -> str:
    try:
        check_installation()
    except TrundleError as error:
        return str(error)
    return ""


MISSING = _what_is_missing()

needs_physx = pytest.mark.skipif(bool(MISSING), reason=MISSING)


def prim(kind: str, name: str, body: str, *schemas: str) -> str:
    """A prim in USD's text, with applied schemas."""
    applied = ", ".join(f'"{schema}"' for schema in schemas)
    head = f" (\n        prepend apiSchemas = [{applied}]\n    )" if schemas else ""
    return f'    def {kind} "{name}"{head}\n    {{\n{body}    }}\n'


def cube(name: str, size: tuple[float, ...], at: tuple[float, ...], *schemas: str) -> str:
    """A box of a size [m] in the middle of a place [m]."""
    body = (
        "        double size = 1\n"
        f"        double3 xformOp:translate = {at}\n"
        f"        double3 xformOp:scale = {size}\n"
        '        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:scale"]\n'
    )
    return prim("Cube", name, body, *schemas)


COLLIDER, BODY = "PhysicsCollisionAPI", "PhysicsRigidBodyAPI"
FLOOR = cube("floor", (20.0, 20.0, 0.2), (0.0, 0.0, -0.1), COLLIDER)


def stage(*prims: str, meters: float = 1.0, up: str = "Z") -> str:
    """A stage in USD's text."""
    head = f'#usda 1.0\n(\n    defaultPrim = "W"\n    metersPerUnit = {meters}\n    upAxis = "{up}"\n)\n'
    return head + '\ndef Xform "W"\n{\n' + "".join(prims) + "}\n"
