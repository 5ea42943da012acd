"""`NavigationEnv`: one robot that has to reach a goal, as a Gymnasium environment."""

from __future__ import annotations

from typing import Any, SupportsFloat

import gymnasium
import numpy as np
import numpy.typing as npt
from gymnasium import spaces

from trundle.errors import InputError, UnknownNameError
from trundle.gym.arena import Arena, make_arena
from trundle.gym.episodes import LARGEST_SEED, Episodes
from trundle.gym.navigation_settings import NavigationSettings
from trundle.gym.observations import Observations, Observer
from trundle.gym.render import PagePicture, draw_robot
from trundle.values import check_count

RENDER_MODES = ("rgb_array", "human")


class NavigationEnv(gymnasium.Env[Any, Any]):
    """One robot that has to reach a goal. Options are those of `NavigationSettings`.

    Args:
        render_mode: "rgb_array" for pictures, "human" for the page in a browser, or None.
        arena: Maps and missions, made of the settings if None.
        options: The settings by name.
    """

    metadata = {"render_modes": list(RENDER_MODES), "render_fps": 5}  # noqa: RUF012 - Gymnasium's name and kind

    def __init__(self, *, render_mode: str | None = None, arena: Arena | None = None, **options: Any) -> None:
        settings = NavigationSettings.of(options)
        if settings.device != "cpu":
            raise InputError(
                f"one robot computes on the CPU, got device={settings.device!r}; use device='cpu', or many robots: "
                "gymnasium.make_vec('trundle/Navigation-v0', num_envs=4096, device='cuda')"
            )
        self.render_mode = check_render_mode(render_mode)
        self.metadata = {**self.metadata, "render_fps": max(1, round(1.0 / settings.period_s))}
        arena = make_arena(settings, settings.load_robot()) if arena is None else arena
        self.episodes = Episodes(settings, arena, 1)
        self._observer = Observer(self.episodes)
        self.observation_space = self._observer.space()
        self.action_space = action_space(self.episodes)
        self._picture: PagePicture | None = None
        self._ready = False

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observations, dict[str, Any]]:
        """Begin an episode: with a seed the first one of it, else the next.

        Raises:
            InputError: If the seed is bad.
            WorldError: If no start leaves room for the crowd; the last episode stays as it is.
        """
        if seed is not None:
            check_count("seed", seed, 0, LARGEST_SEED)
        super().reset(seed=seed)
        only = np.zeros(1, dtype=np.int64)
        if seed is not None:
            self.episodes.seed([seed], only)
        elif not self._ready:
            self.episodes.seed([int(self.np_random.integers(2**62))], only)
        self.episodes.reset(only)
        self._ready = True
        self._observer.scan()
        self._show()
        return self._observe(), _plain(self.episodes.start_figures())

    def step(self, action: npt.NDArray[np.float32]) -> tuple[Observations, SupportsFloat, bool, bool, dict[str, Any]]:
        """Drive one period.

        Raises:
            InputError: If the action is not finite or out of bounds, or there was no reset.
        """
        if not self._ready:
            raise InputError("call reset before step")
        outcome = self.episodes.step(self.episodes.check_actions(np.asarray(action)[None]))
        self._observer.scan()
        self._show()
        reward, terminated, truncated = outcome.rewards.item(), outcome.terminated.item(), outcome.truncated.item()
        return self._observe(), reward, terminated, truncated, _plain(outcome.info)

    def render(self) -> Any:
        """Return a picture of the robot, its scan and its goal, uint8, shape (rows, cols, 3); None for the page."""
        return draw_robot(self.episodes, 0) if self.render_mode == "rgb_array" and self._ready else None

    def close(self) -> None:
        """Close the page, if there is one."""
        if self._picture is not None:
            self._picture.close()
            self._picture = None

    def _observe(self) -> Observations:
        return {name: values[0] for name, values in self._observer.observe().items()}

    def _show(self) -> None:
        if self.render_mode == "human":
            if self._picture is None:
                self._picture = PagePicture(self.episodes)
            self._picture.update()


def check_render_mode(mode: str | None) -> str | None:
    """Return a render mode, checked.

    Raises:
        UnknownNameError: If there is no such mode.
    """
    if mode is not None and mode not in RENDER_MODES:
        raise UnknownNameError("render mode", str(mode), RENDER_MODES)
    return mode


def action_space(episodes: Episodes) -> spaces.Box:
    """Return the space of one robot's action (v, w)."""
    return spaces.Box(episodes.action_low.astype(np.float32), episodes.action_high.astype(np.float32))


def _plain(info: dict[str, Any]) -> dict[str, Any]:
    """Return the figures of the one robot as numbers."""
    return {name: values.item() for name, values in info.items()}
