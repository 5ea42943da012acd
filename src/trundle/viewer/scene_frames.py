"""The frames of a run's video by OpenGL, in a quality that this machine can render in reasonable time."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Self

from trundle.geometry import Pose2D
from trundle.sim.mover_history import ShownMovers
from trundle.viewer.scene import SceneRenderer

if TYPE_CHECKING:
    from trundle.mission import Episode, Mission
    from trundle.viewer.painters import Pixels

QUICK_S = 0.01
"""If a small picture takes longer than this, it is rendered by the CPU instead of a GPU."""

STRIDE = 2
"""Without a GPU, frames per rendered picture."""


class SceneFrames:
    """Follows the robot with a camera behind it.

    With a GPU: large, with shadows. Without one: smaller, without shadows, and each picture is shown twice.

    Args:
        mission: The mission.
        episode: Its episode.
    """

    def __init__(self, mission: Mission, episode: Episode) -> None:
        self._mission = mission
        self._path = episode.paths[0].poses if episode.paths else None
        self._goal = episode.goals[-1].pose if episode.goals else None
        self._stride = STRIDE
        self._count = 0
        self._scene = self._open((960, 540), shadow_size=0)
        if self._is_quick():
            self._scene.close()
            self._stride = 1
            self._scene = self._open((1280, 720), shadow_size=2048)
        self._picture = self._scene.render(mission.start)

    def render(self, pose: Pose2D, movers: ShownMovers) -> Pixels:
        """Return the picture for the next frame."""
        if self._count % self._stride == 0:
            self._picture = self._scene.render(pose, movers=movers)
        self._count += 1
        return self._picture

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._scene.close()

    def _open(self, size: tuple[int, int], *, shadow_size: int) -> SceneRenderer:
        return SceneRenderer(
            self._mission.world,
            self._mission.robot,
            size=size,
            camera="chase",
            path=self._path,
            goal=self._goal,
            shadow_size=shadow_size,
        )

    def _is_quick(self) -> bool:
        self._scene.render(self._mission.start)  # the first picture also prepares the driver
        began = time.perf_counter()
        self._scene.render(self._mission.start)
        return time.perf_counter() - began < QUICK_S
