"""PyTorch's arrays on a GPU, and a batch simulator that speaks in them."""

# pyright: reportMissingImports=false, reportAttributeAccessIssue=false

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from trundle.errors import MissingExtraError
from trundle.gym.arrays import Arrays
from trundle.sim.batch import BatchSimulator

try:
    import torch
except ModuleNotFoundError:
    raise MissingExtraError("an environment on a GPU", "torch", "pip install torch") from None


class TorchArrays(Arrays):
    """PyTorch's arrays, on a device."""

    lib: Any = torch
    on_host = False

    def __init__(self, device: torch.device) -> None:
        self.device = device

    def put(self, values: Any) -> torch.Tensor:
        """Return values of the host as a tensor of the device; a tensor that is there is itself."""
        if isinstance(values, torch.Tensor):
            return values.detach().to(self.device)
        return torch.from_numpy(np.array(values)).to(self.device)

    def host(self, values: Any) -> npt.NDArray[Any]:
        """Return a tensor as an array of the host."""
        return values.cpu().numpy()

    def cast(self, values: Any, kind: str) -> torch.Tensor:
        """Return a tensor with another type of numbers; itself if it has that type."""
        return values.to(getattr(torch, kind))

    def copy(self, values: Any) -> torch.Tensor:
        """Return a copy of a tensor."""
        return values.clone()

    def full(self, shape: int | tuple[int, ...], value: float, kind: str = "float64") -> torch.Tensor:
        """Return a tensor of one value."""
        sizes = (shape,) if isinstance(shape, int) else shape
        return torch.full(sizes, value, dtype=getattr(torch, kind), device=self.device)

    def indices(self, mask: Any) -> torch.Tensor:
        """Return where a mask is true, shape (n,); the host waits for their number."""
        return mask.nonzero()[:, 0]

    def columns(self, *parts: Any, kind: str = "float64") -> torch.Tensor:
        """Return tensors of shape (n,) as columns, numbers of one type."""
        return self.cast(torch.stack(parts, dim=-1), kind)

    def clip(self, values: Any, low: Any, high: Any) -> torch.Tensor:
        """Return values cut off at two bounds, both numbers or both arrays."""
        return values.clip(low, high)


class TorchSimulator:
    """A `BatchSimulator` on a GPU by the names that `Episodes` uses; its arrays are tensors on that GPU.

    Args:
        sim: The simulator. Tensors are views of its state, and nothing of a step passes through the host. Its stream
            waits for PyTorch's default stream, not for others.
    """

    def __init__(self, sim: BatchSimulator) -> None:
        import warp as wp

        self._sim = sim
        self.poses, self.lengths, self.steps, self.contacts, self.places, self.twists, self.ranges = (
            torch.from_dlpack(each)
            for each in (sim.poses, sim.lengths, sim.steps, sim.contacts, sim.places, sim.twists, sim.ranges)
        )
        self.count, self.columns = sim.count, sim.columns
        device, count = self.poses.device, sim.count
        self._commands = torch.zeros((count, 2), dtype=torch.float64, device=device)
        self._chosen = torch.zeros(count, dtype=torch.bool, device=device)
        self._new = {"poses": torch.zeros((count, 3), dtype=torch.float64, device=device)}
        self._new |= {name: torch.zeros(count, dtype=torch.int64, device=device) for name in ("maps", "recordings")}
        self._new |= {"seeds": torch.zeros(count, dtype=torch.int64, device=device)}
        self._new |= {name: torch.zeros(count, dtype=torch.float64, device=device) for name in ("noise", "dropouts")}
        # The same memory as Warp's arrays: made once, as each view takes the host longer than a launch.
        self._given = {name: wp.from_torch(values) for name, values in self._new.items()}
        self._given_commands, self._given_chosen = wp.from_torch(self._commands), wp.from_torch(self._chosen)

    @property
    def times(self) -> torch.Tensor:
        """Time since each robot's reset [s], shape (N,)."""
        return self.steps.double() * self._sim.timestep

    def reset(self, poses: torch.Tensor, *, robots: torch.Tensor, **given: Any) -> None:
        """Put robots at rest; `poses` and `given` have a row for each of them, or one value for all."""
        for name, rows in {"poses": poses, **given}.items():
            self._new[name][robots] = rows
        chosen = None if len(robots) == self.count else self._choose(robots)
        self._sim.reset(self._given["poses"], robots=chosen, **self._without_poses())

    def step(self, commands: torch.Tensor, dt: float, *, robots: torch.Tensor | None = None) -> None:
        """Drive one period; `robots` is a bool for each robot, or None for all."""
        self._commands.copy_(commands)
        if robots is not None:
            self._chosen.copy_(robots)
        self._sim.step(self._given_commands, dt, robots=None if robots is None else self._given_chosen)

    def scan(self, *, robots: torch.Tensor | None = None) -> None:
        """Turn the lidars of some robots once, by their indices, or of all."""
        self._sim.scan(robots=None if robots is None else self._choose(robots))

    def movers(self, robot: int) -> npt.NDArray[np.float64]:
        """Return (x, y, yaw) of the movers around a robot, an array of the host, shape (M, 3)."""
        return self._sim.movers(robot)

    def _without_poses(self) -> dict[str, Any]:
        return {name: values for name, values in self._given.items() if name != "poses"}

    def _choose(self, robots: torch.Tensor) -> Any:
        self._chosen.zero_()
        self._chosen[robots] = True
        return self._given_chosen
