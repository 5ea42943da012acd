"""`MoverBodies`: the movers of a world as MuJoCo's mocap bodies."""

from __future__ import annotations

import math

import mujoco
import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray, Pose2D
from trundle.sim.movers import MoverField
from trundle.sim.mujoco.world_parts import MOVER
from trundle.sim.state import Contact

_DEPTH_M, _DEPTH_S = 0.03, 0.035
"""A push needs an overlap of some cm, more the faster it is: [m], and [m] per m/s."""


class MoverBodies:
    """Moves mocap bodies, and tells contacts how fast their surfaces are.

    A mocap body is at rest for MuJoCo's contacts, however it is moved. Its geoms therefore get a surface velocity,
    which is what friction sees; along the normal, a body pushes by how far it overlaps. Nothing stops it: where it
    presses the robot against something, it passes through the robot instead of throwing it into the air. While it does,
    contacts are found from the robot's footprint.

    Args:
        model: The compiled world and robot.
        data: Its state.
        field: The movers.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, field: MoverField) -> None:
        self.field = field
        self._model, self._data = model, data
        bodies = [model.body(f"{MOVER}{name}").id for name in field.names]
        self._slots = model.body_mocapid[bodies]
        owner = {body: index for index, body in enumerate(bodies)}
        geoms = [geom for geom in range(model.ngeom) if int(model.geom_bodyid[geom]) in owner]
        self.names = {geom: field.names[owner[int(model.geom_bodyid[geom])]] for geom in geoms}
        """The mover of each geom."""
        self._owner_of = {geom: owner[int(model.geom_bodyid[geom])] for geom in geoms}
        self._geoms = np.array(geoms)
        self._owners = np.array([owner[int(model.geom_bodyid[geom])] for geom in geoms])
        self._offsets = model.geom_pos[self._geoms].copy()
        self._turns = np.zeros((len(geoms), 9))
        for row, geom in enumerate(geoms):
            mujoco.mju_quat2Mat(self._turns[row], model.geom_quat[geom])
        self._turns = self._turns.reshape(-1, 3, 3)
        self._affinity = model.geom_conaffinity[self._geoms].copy()
        self._passing: dict[int, None] = {}
        model.flg_surfacevel = 1

    def reset(self, seed: int, pose: Pose2D) -> None:
        """Start from a seed, with the robot at a pose."""
        self.field.reset(seed, pose)
        self._model.geom_conaffinity[self._geoms] = self._affinity
        self._passing.clear()
        self._place(self.field.state)
        self.set_speeds()

    def resume(self, before: MoverBodies) -> None:
        """Continue from where the bodies of another model of the same movers were."""
        for index in before._passing:
            self._passing[index] = None
            self._model.geom_conaffinity[self._geoms[self._owners == index]] = 0
        self._place(self.field.state)
        self.set_speeds()

    def advance(self, time: float) -> None:
        """Move them to a time since the reset [s]."""
        self._place(self.field.advance(time, self._robot))

    def set_speeds(self) -> None:
        """Give the surfaces the movers' velocities."""
        state = self.field.state
        cos, sin = np.cos(state[:, 2]), np.sin(state[:, 2])
        ahead, left = cos * state[:, 3] + sin * state[:, 4], cos * state[:, 4] - sin * state[:, 3]
        owners, w = self._owners, state[self._owners, 5]
        speeds = np.column_stack(
            [ahead[owners] - w * self._offsets[:, 1], left[owners] + w * self._offsets[:, 0], np.zeros(len(owners))]
        )
        rates = np.column_stack([np.zeros((len(owners), 2)), w])
        # The columns of `turns` are the axes of a geom.
        self._model.geom_surfacevel[self._geoms, :3] = np.einsum("gi,gij->gj", speeds, self._turns)
        self._model.geom_surfacevel[self._geoms, 3:] = np.einsum("gi,gij->gj", rates, self._turns)

    def let_pass(self) -> None:
        """Let those pass through the robot that overlap it by more than a push needs."""
        contact = self._data.contact
        deep = np.flatnonzero(contact.dist < -_DEPTH_M)
        for pair, depth in zip(contact.geom[deep].tolist(), (-contact.dist[deep]).tolist(), strict=True):
            for geom in pair:
                index = self._owner_of.get(geom)
                if index is not None and depth > _DEPTH_M + _DEPTH_S * math.hypot(*self.field.state[index, 3:5]):
                    self._passing[index] = None
                    self._model.geom_conaffinity[self._geoms[self._owners == index]] = 0

    def passing_contacts(self) -> list[Contact]:
        """Return contacts of the robot with those that pass through it; who has left it collides again."""
        if not self._passing:
            return []
        found = self.field.touching(self._robot()[0])
        touched = {contact.other for contact in found}
        for index in [index for index in self._passing if self.field.names[index] not in touched]:
            del self._passing[index]
            mine = self._owners == index
            self._model.geom_conaffinity[self._geoms[mine]] = self._affinity[mine]
        return [contact for contact in found if self.field.names.index(contact.other) in self._passing]

    def _place(self, state: FloatArray) -> None:
        place_movers(self._data, self._slots, state)

    def _robot(self) -> tuple[Pose2D, float]:
        x, y, _, qw, qx, qy, qz = self._data.qpos[:7].tolist()
        yaw = math.atan2(2.0 * (qw * qz + qx * qy), 1.0 - 2.0 * (qy * qy + qz * qz))
        vx, vy = self._data.qvel[:2].tolist()
        return Pose2D(x, y, yaw), vx * math.cos(yaw) + vy * math.sin(yaw)


def place_movers(data: mujoco.MjData, slots: npt.NDArray[np.integer], poses: FloatArray) -> None:
    """Put mocap bodies at poses (x, y, yaw, …) on the floor, shape (M, 3) or more columns."""
    data.mocap_pos[slots, :2] = poses[:, :2]
    data.mocap_pos[slots, 2] = 0.0
    half = poses[:, 2] / 2.0
    data.mocap_quat[slots, 0], data.mocap_quat[slots, 3] = np.cos(half), np.sin(half)
    data.mocap_quat[slots, 1:3] = 0.0
