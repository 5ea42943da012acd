"""Stands in for omni.physx' scene queries: rays and overlaps, which PhysX answers while it has the stage."""

from __future__ import annotations

import types
import warnings
from collections.abc import Callable
from typing import Any

from ovphysx.types import SceneQueryGeometryType, SceneQueryMode  # pyright: ignore[reportMissingImports]
from pxr import Gf

from trundle.testing.isaac.physics import Engine

Report = Callable[[types.SimpleNamespace], bool]


class SceneQueries:
    """omni.physx.get_physx_scene_query_interface()."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    def raycast_closest(self, origin: Any, direction: Any, distance: float, bothSides: bool = False) -> dict[str, Any]:
        """Return the first hit of a ray as a dict; its `hit` is false where there is none."""
        hits = self._cast(origin, direction, distance, SceneQueryMode.CLOSEST, bothSides)
        return (
            {"hit": True, "rigidBody": hits[0].rigid_body, "faceIndex": hits[0].face_index, **vars(hits[0])}
            if hits
            else {"hit": False}
        )

    def raycast_any(self, origin: Any, direction: Any, distance: float, bothSides: bool = False) -> bool:
        """Whether a ray hits anything."""
        return bool(self._cast(origin, direction, distance, SceneQueryMode.ANY, bothSides))

    def raycast_all(
        self, origin: Any, direction: Any, distance: float, reportFn: Report, bothSides: bool = False
    ) -> bool:
        """Call a function with the hits of a ray, until it returns false; whether there was one."""
        return bool(_tell(self._cast(origin, direction, distance, SceneQueryMode.ALL, bothSides), reportFn))

    def overlap_box(self, halfExtent: Any, pos: Any, rot: Any, reportFn: Report, anyHit: bool = False) -> int:
        """Call a function with what is in a box, until it returns false; how many there are."""
        return self._overlap(reportFn, SceneQueryGeometryType.BOX, half_extent=halfExtent, position=pos, rotation=rot)

    def overlap_sphere(self, radius: float, pos: Any, reportFn: Report, anyHit: bool = False) -> int:
        """Call a function with what is in a sphere, until it returns false; how many there are."""
        return self._overlap(reportFn, SceneQueryGeometryType.SPHERE, radius=radius, position=pos)

    def overlap_box_any(self, halfExtent: Any, pos: Any, rot: Any) -> bool:
        """Whether there is anything in a box."""
        return self.overlap_box(halfExtent, pos, rot, lambda _: False) > 0

    def overlap_sphere_any(self, radius: float, pos: Any) -> bool:
        """Whether there is anything in a sphere."""
        return self.overlap_sphere(radius, pos, lambda _: False) > 0

    def _cast(self, origin: Any, direction: Any, distance: float, mode: Any, both: bool) -> list[types.SimpleNamespace]:
        long = (sum(float(number) ** 2 for number in direction)) ** 0.5
        ray = tuple(float(number) / long for number in direction)
        return self._ask(lambda physx: physx.raycast(tuple(origin), ray, float(distance), mode, both))

    def _overlap(self, report: Report, kind: Any, **geometry: Any) -> int:
        hits = self._ask(lambda physx: physx.overlap(kind, SceneQueryMode.ALL, **geometry))
        return _tell(hits, report)

    def _ask(self, question: Callable[[Any], list[dict[str, Any]]]) -> list[types.SimpleNamespace]:
        if not self._engine.loaded:
            return []  # as in Isaac Sim before it plays
        self._engine.flush()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            hits = question(self._engine.physx)
            ids = [hit[name] for hit in hits for name in ("collision", "rigid_body")]
            paths = self._engine.physx.get_scene_query_paths_from_ids(ids) if ids else []
        return [
            types.SimpleNamespace(
                collision=paths[2 * row], rigid_body=paths[2 * row + 1], distance=float(hit["distance"]),
                position=Gf.Vec3f(*map(float, hit["position"])), normal=Gf.Vec3f(*map(float, hit["normal"])),
                face_index=int(hit["face_index"]),
            )
            for row, hit in enumerate(hits)
        ]  # fmt: skip


def _tell(hits: list[types.SimpleNamespace], report: Report) -> int:
    for hit in hits:
        if not report(hit):
            break
    return len(hits)
