"""`Attachment`: a stage in PhysX, with the columns of numbers that are read from it and written to it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray, Pose3D
from trundle.sim.physx.engine import library

_ROOT = ("rootPosition", "rootOrientation", "rootLinearVelocity", "rootAngularVelocity")
_MOVER = ("position", "orientation")
_MOVER_TARGET = ("kinematicTargetPosition", "kinematicTargetOrientation")
_COLLIDER = "contactEventOtherCollider"
_EVENT = ("contactEventType", _COLLIDER, "contactEventPointCount")
_POINT, _IMPULSE = "contactEventPointPosition", "contactEventPointImpulse"
_LOST = 1

Contacting = tuple[str, int, FloatArray]
"""A pair in contact: path of the robot's body, handle of the other collider, and points [m], shape (N, 3)."""


class Attachment:
    """A robot and movers of a stage, in the simulation.

    PhysX has no way back to an earlier state that repeats a run to the last bit: whoever wants that attaches again.

    Args:
        engine: An `ovphysx.PhysX` that has no stage.
        stage: An `ovstage.Stage`.
        ordinal: Version of the stage to simulate.
        root: Path of the articulation's root prim.
        wheels: Paths of the joints that `set_speeds` drives. The first two are read.
        sensors: Pattern of paths of the bodies whose contacts are read.
        movers: Paths of the kinematic bodies.
    """

    def __init__(
        self,
        engine: Any,
        stage: Any,
        ordinal: int,
        *,
        root: str,
        wheels: Sequence[str],
        sensors: str,
        movers: Sequence[str] = (),
    ) -> None:
        self._engine = engine
        self._kinds = library("ovphysx.types").SimObjectType
        self._paths = library("ovstage").PathDictionary(stage)
        self._tokens: dict[str, int] = {}
        engine.wait_task(engine.attach_ovstage(stage, read_ordinal=ordinal))
        self._is_attached = True
        self._queries: list[Any] = []
        self._articulation = self._select(self._kinds.ARTICULATION, prim_paths=self._handles([root]))
        self._joints = self._select(self._kinds.ARTICULATION_JOINT)
        self._wheels = self._select(self._kinds.ARTICULATION_JOINT, prim_paths=self._handles(wheels[:2]))
        self._drives = self._select(self._kinds.ARTICULATION_JOINT, prim_paths=self._handles(wheels))
        self._contacts = self._select(self._kinds.CONTACT_SENSOR, pattern=sensors)
        self._movers = self._select(self._kinds.RIGID_BODY, prim_paths=self._handles(movers)) if movers else None
        self._wheel_paths, self._mover_paths = list(wheels), list(movers)
        self._yaws: FloatArray = np.full(len(movers), np.nan)

    def step(self, timestep: float) -> None:
        """Simulate one step [s]."""
        self._engine.step_sync(timestep)

    def root(self) -> tuple[Pose3D, FloatArray, FloatArray]:
        """Return the root body's pose, and the velocity [m/s] and rotation [rad/s] of its centre of mass, world frame.

        Raises:
            InputError: If a number is not finite.
        """
        found = self._read(self._articulation, _ROOT, most=len(_ROOT))
        (position, quaternion, linear, angular) = (found[name][1][0][0] for name in _ROOT)
        x, y, z, w = quaternion.tolist()
        return Pose3D(tuple(position.tolist()), (w, x, y, z)), linear, angular

    def centre_of_mass(self, root: str) -> FloatArray:
        """Return a body's centre of mass [m] in its own frame, shape (3,)."""
        query = self._select(self._kinds.ARTICULATION_LINK, prim_paths=self._handles([root]))
        return self._read(query, ["centerOfMassPosition"])["centerOfMassPosition"][1][0][0]

    def place_root(self, pose: Pose3D) -> None:
        """Put the root body somewhere, at rest. The joints stay as they are."""
        w, x, y, z = pose.quaternion
        values = (pose.position, (x, y, z, w), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))

        def fill(index: int, _: list[int], tensors: list[npt.NDArray[np.float32]]) -> None:
            tensors[0][0] = values[index]

        self._write(self._articulation, _ROOT, fill)

    def joint_names(self) -> list[str]:
        """Return the names of the articulation's joints that can move, in its order."""
        handles, _ = self._read(self._joints, ["jointPosition"])["jointPosition"]
        return [self.path(handle).rpartition("/")[2] for handle in handles]

    def stop_joints(self) -> None:
        """Set the velocity of every joint to 0."""

        def fill(_: int, __: list[int], tensors: list[npt.NDArray[np.float32]]) -> None:
            for tensor in tensors:
                tensor[...] = 0.0

        self._write(self._joints, ["jointVelocity"], fill)

    def wheels(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Return the angles [rad] and the speeds [rad/s] of the first two wheels."""
        found = self._read(self._wheels, ("jointPosition", "jointVelocity"), most=2)
        (angles, speeds) = (
            self._in_order(self._wheel_paths[:2], *found[name]) for name in ("jointPosition", "jointVelocity")
        )
        return (angles[0], angles[1]), (speeds[0], speeds[1])

    def _in_order(
        self, paths: Sequence[str], handles: list[int], tensors: list[npt.NDArray[np.float32]]
    ) -> list[float]:
        """Return values of joints in the order of their paths, from degrees to radians."""
        by_handle = dict(zip(handles, tensors, strict=True))
        return [math.radians(float(by_handle[handle][0])) for handle in self._handles(paths)]

    def set_speeds(self, speeds: Sequence[float]) -> None:
        """Set the target speeds of the drives of all wheels [rad/s]."""
        wanted = dict(zip(self._handles(self._wheel_paths), map(math.degrees, speeds), strict=True))

        def fill(_: int, handles: list[int], tensors: list[npt.NDArray[np.float32]]) -> None:
            for handle, tensor in zip(handles, tensors, strict=True):
                tensor[0] = wanted[handle]

        self._write(self._drives, ["jointVelocityTarget"], fill)

    def put_movers(self, states: FloatArray) -> None:
        """Put the movers where they are, without a motion: (x, y, yaw, …) [m, rad], shape (M, 3) or more columns."""
        self._write_movers(_MOVER, states)

    def aim_movers(self, states: FloatArray) -> None:
        """Move the movers there in the next step, so that what they push feels their speed."""
        turned = not np.array_equal(states[:, 2], self._yaws)
        self._write_movers(_MOVER_TARGET if turned else _MOVER_TARGET[:1], states)

    def _write_movers(self, names: Sequence[str], states: FloatArray) -> None:
        self._yaws = states[:, 2].copy()
        rows = {handle: row for row, handle in enumerate(self._handles(self._mover_paths))}

        def fill(index: int, handles: list[int], tensors: list[npt.NDArray[np.float32]]) -> None:
            order = [rows[handle] for handle in handles]
            values = tensors[0]
            values[...] = 0.0
            if index == 0:
                values[:, :2] = states[order, :2]
            else:
                half = states[order, 2] / 2.0
                values[:, 2], values[:, 3] = np.sin(half), np.cos(half)

        self._write(self._movers, names, fill)

    def touched_colliders(self) -> set[int]:
        """Return handles of the colliders in contact with the robot, or that ceased to be in the last step.

        It reads one column, which costs a third of what `contacts` does.
        """
        session = self._engine.read(self._contacts, [self._token(_COLLIDER, self._paths.intern_token)]).wait()
        found: set[int] = set()
        try:
            while (group := session.fetch_next().wait()) is not None:
                for tensor in group.tensors:
                    found.update(tensor.numpy().ravel().tolist())
        finally:
            session.close_sync()
        return found

    def contacts(self) -> Iterator[Contacting]:
        """Yield what the robot touches after the last step.

        PhysX also reports points where bodies are near each other, up to a contact offset of 2 cm. Where they touch,
        there is an impulse.
        """
        found = self._read(self._contacts, (*_EVENT, _POINT, _IMPULSE))
        columns: dict[int, dict[str, npt.NDArray[Any]]] = {}
        for name, (handles, tensors) in found.items():
            for handle, tensor in zip(handles, tensors, strict=True):
                columns.setdefault(handle, {})[name] = tensor
        for body, events in columns.items():
            if _POINT not in events:
                continue  # all of them are pairs that have parted
            points, impulses = (events[name].reshape(-1, 3).astype(float) for name in (_POINT, _IMPULSE))
            meets = np.isfinite(points).all(axis=1) & (np.abs(impulses).max(axis=1) > 0.0)
            kinds, colliders, counts = (events[name].ravel().tolist() for name in _EVENT)
            first = 0
            for kind, collider, count in zip(kinds, colliders, counts, strict=True):
                at = points[first : first + count][meets[first : first + count]]
                first += count
                if len(at) and kind != _LOST:
                    yield self.path(body), collider, at

    def path(self, handle: int) -> str:
        """Return the path of a prim."""
        return self._paths.path_to_string(handle)

    def detach(self) -> None:
        """Take the stage out of the engine; twice does nothing."""
        if not self._is_attached:
            return
        self._is_attached = False
        for query in self._queries:
            query.close_sync()
        self._engine.wait_task(self._engine.detach_ovstage())

    def _select(self, kind: Any, **selection: Any) -> Any:
        query = self._engine.query(kind, metadata=False, **selection).wait()
        self._queries.append(query)
        return query

    def _handles(self, paths: Sequence[str]) -> list[int]:
        return [self._token(path, self._paths.intern_path) for path in paths]

    def _token(self, text: str, intern: Callable[[str], int]) -> int:
        if text not in self._tokens:
            self._tokens[text] = intern(text)
        return self._tokens[text]

    def _read(
        self, query: Any, names: Sequence[str], *, most: int | None = None
    ) -> dict[str, tuple[list[int], list[npt.NDArray[Any]]]]:
        """Read columns: of each, the handles of its prims and what they have. Columns without any are left out.

        Args:
            query: The prims.
            names: The columns.
            most: Stop after so many columns; those of prims in one physics scene are one group each.
        """
        tokens = {self._token(name, self._paths.intern_token): name for name in names}
        found: dict[str, tuple[list[int], list[npt.NDArray[Any]]]] = {}
        session = self._engine.read(query, list(tokens)).wait()
        try:
            while (most is None or len(found) < most) and (group := session.fetch_next().wait()) is not None:
                handles, tensors = found.setdefault(tokens[group.attribute], ([], []))
                handles += self._prims(group)
                # Copied: the engine cannot be closed while an array of it is alive.
                tensors += [tensor.numpy().copy() for tensor in group.tensors]
        finally:
            session.close_sync()
        return found

    def _write(self, query: Any, names: Sequence[str], fill: Callable[[int, list[int], list[Any]], None]) -> None:
        """Write columns of prims in one physics scene, which are one group each.

        `fill` gets the index of each column, the handles of its prims, and the arrays to fill.
        """
        session = self._engine.write(query, [self._token(name, self._paths.intern_token) for name in names]).wait()
        try:
            for _ in names:
                group = session.fetch_next().wait()
                fill(group.attribute_index, self._prims(group), [tensor.numpy() for tensor in group.tensors])
                session.commit_sync(group)
        finally:
            session.close_sync()

    def _prims(self, group: Any) -> list[int]:
        first = group.prim_offset
        return [int(path) for path in self._paths.get_paths(group.prim_list)[first : first + group.prim_count]]
