"""`NavigationVectorEnv`: many robots in one step, as a Gymnasium `VectorEnv`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from trundle.errors import InputError, UnknownNameError, WorldError
from trundle.gym.arena import Arena, make_arena
from trundle.gym.env import RENDER_MODES, action_space, check_render_mode
from trundle.gym.episodes import LARGEST_SEED, Episodes
from trundle.gym.navigation_settings import NavigationSettings
from trundle.gym.observations import Observations, Observer
from trundle.gym.render import draw_robot
from trundle.values import check_count, show_value

_MODES = {
    "next_step": AutoresetMode.NEXT_STEP,
    "same_step": AutoresetMode.SAME_STEP,
    "disabled": AutoresetMode.DISABLED,
}


class NavigationVectorEnv(VectorEnv[Any, Any, Any]):
    """Robots that each have to reach a goal of their own, stepped together by one kernel.

    Robot i of a reset with the seed s has the episodes of a `NavigationEnv` with the seed s + i, bit for bit.

    With `device="cuda"` observations, rewards, ends and `infos` are PyTorch's tensors on the GPU, and actions may be:
    no step copies them through the host. Numbers are drawn there too, but for those of `vary`; `final_obs` is a
    dictionary of tensors. A bad action is raised by its step or a later one. Call it within PyTorch's default stream of
    that GPU: the environment does not wait for other streams, nor do they wait for it.

    Args:
        num_envs: Number of robots.
        autoreset_mode: "next_step" (the step after the end of an episode begins the next one; its action is not used),
            "same_step" (the step that ends an episode begins the next one, and `final_obs` and `final_info` are of the
            end) or "disabled" (reset with the option `reset_mask`); or Gymnasium's `AutoresetMode`.
        render_mode: "rgb_array", or None.
        arena: Maps and missions, made of the settings if None.
        options: The settings by name; see `NavigationSettings`.
    """

    def __init__(
        self,
        num_envs: int = 1,
        *,
        autoreset_mode: str | AutoresetMode = "next_step",
        render_mode: str | None = None,
        arena: Arena | None = None,
        **options: Any,
    ) -> None:
        settings = NavigationSettings.of(options)
        self.num_envs = check_count("num_envs", num_envs, 1, 10_000_000)
        self._mode = _read_mode(autoreset_mode)
        self.render_mode = check_render_mode(render_mode)
        if render_mode == "human":
            raise InputError("many robots have no page: use render_mode='rgb_array', or one NavigationEnv")
        self.metadata = {
            "autoreset_mode": self._mode,
            "render_modes": list(RENDER_MODES[:1]),
            "render_fps": max(1, round(1.0 / settings.period_s)),
        }
        arena = make_arena(settings, settings.load_robot()) if arena is None else arena
        self.episodes = Episodes(settings, arena, num_envs)
        self._observer = Observer(self.episodes)
        self.single_observation_space = self._observer.space()
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.single_action_space = action_space(self.episodes)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._ended = self.episodes.arrays.full(num_envs, 0, "bool")
        self._ready = np.zeros(num_envs, dtype=bool)
        # Where a robot finds no room: with "next_step" who has begun in the step that is broken off; with "same_step"
        # why the next step cannot be.
        self._begun: Any = None
        self._no_room: str | None = None

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observations, dict[str, Any]]:
        """Begin episodes of all robots, or of those of the option `reset_mask`, bools of shape (num_envs,).

        Args:
            seed: An integer s, for the seeds s, s + 1, …; one for each robot; or None, for the next episodes.
            options: May hold `reset_mask`.

        Raises:
            UnknownNameError: If there is no such option.
            InputError: If the mask or a seed is bad, or a GPU has found a bad action of an earlier step.
            WorldError: If no start leaves room for the crowd of a robot: that one stays as it is, and the others have
                begun.
        """
        put = self.episodes.arrays.put
        mask = self._read_mask(options)
        chosen = np.flatnonzero(mask)
        robots = put(chosen)
        self._seed(seed, chosen)
        try:
            self.episodes.reset(robots)
        except WorldError:
            self._note_begun(chosen[self.episodes.arrays.host(self.episodes.is_placed)[chosen]])
            raise
        self._note_begun(chosen)
        return self._observer.observe(), self._masked(self.episodes.start_figures(), put(mask))

    def step(self, actions: Any) -> tuple[Observations, Any, Any, Any, dict[str, Any]]:
        """Drive one period with an action for each robot.

        Raises:
            InputError: If an action is not finite or out of bounds, or a robot was not reset. On the CPU nothing has
                moved then; a GPU may tell at a later step, and has moved nothing since.
            WorldError: If no start of the next episode leaves room for the crowd of a robot. Nothing has moved then;
                once that robot is reset with another seed, by `reset_mask`, the step goes on with what the others have
                begun. With "same_step" the step that ends its episode still returns, with what the robot observed last,
                and the next one raises.
        """
        if not self._ready.all():
            raise InputError(f"call reset before step: robot {int(np.argmin(self._ready))} has no episode")
        if self._no_room is not None:
            raise WorldError(self._no_room)
        arrays = self.episodes.arrays
        waiting: Any = () if self._mode is AutoresetMode.SAME_STEP else arrays.indices(self._ended)
        if self._mode is AutoresetMode.DISABLED and len(waiting):
            raise InputError(
                f"the episode of robot {int(waiting[0])} has ended, and autoreset is disabled: reset it, "
                "reset(options={'reset_mask': terminated | truncated})"
            )
        active = ~self._ended if len(waiting) else None
        given = self.episodes.check_actions(actions, active)
        self._begin_next(waiting)  # these stand still in this step, so that its figures are of their new episodes
        outcome = self.episodes.step(given, active)
        self._observer.scan()
        ended = outcome.terminated | outcome.truncated
        info = self._masked(outcome.info, True)
        observations = self._observer.observe()
        if self._mode is AutoresetMode.SAME_STEP:
            robots = arrays.indices(ended)
            if len(robots):
                observations, info = self._begin_again(ended, robots, observations, info)
        else:
            self._ended[:] = ended
        return observations, outcome.rewards, outcome.terminated, outcome.truncated, info

    def render(self) -> tuple[Any, ...] | None:
        """Return a picture of each robot, uint8, shape (rows, cols, 3); None before all are reset."""
        if self.render_mode is None or not self._ready.all():
            return None
        return tuple(draw_robot(self.episodes, robot) for robot in range(self.num_envs))

    def _note_begun(self, robots: npt.NDArray[np.int64]) -> None:
        """Scan where robots have begun an episode by `reset`."""
        placed = self.episodes.arrays.put(robots)
        self._ended[placed], self._ready[robots] = False, True
        self._observer.scan(placed)
        if self._no_room is not None and not self._ended.any():
            self._no_room = None

    def _begin_next(self, robots: Any) -> None:
        """Begin the next episodes of robots, but of those that a step which was broken off has begun."""
        if self._begun is not None:
            robots = robots[~self._begun[robots]]
        try:
            self.episodes.reset(robots)
        except WorldError:
            if self._begun is None:
                self._begun = self.episodes.arrays.full(self.num_envs, 0, "bool")
            self._begun[robots] = self.episodes.is_placed[robots]
            raise
        self._begun = None

    def _begin_again(
        self, ended: Any, robots: Any, observations: Observations, info: dict[str, Any]
    ) -> tuple[Observations, dict[str, Any]]:
        """Begin the next episodes where one has ended, scan there again, and keep what the ends were like."""
        arrays = self.episodes.arrays
        final: Any = observations
        if arrays.on_host:
            final = np.full(self.num_envs, None, dtype=object)
            for robot in robots:
                final[robot] = {name: values[robot].copy() for name, values in observations.items()}
        final_info = {name: values for name, values in info.items() if not name.startswith("_")}
        begun = ended
        try:
            self.episodes.reset(robots)
        except WorldError as error:
            self._no_room = str(error)
            begun = ended & self.episodes.is_placed
            self._ended[:] = ended & ~begun
            robots = arrays.indices(begun)
        self._observer.scan(robots)
        fresh = self.episodes.start_figures()
        info = {
            name: values
            if name.startswith("_")
            else arrays.lib.where(begun, fresh[name] if name in fresh else arrays.lib.zeros_like(values), values)
            for name, values in info.items()
        }
        info |= {"final_obs": final, "_final_obs": ended}
        info |= {"final_info": self._masked(final_info, ended), "_final_info": arrays.copy(ended)}
        return self._observer.observe(), info

    def _masked(self, info: dict[str, Any], mask: Any) -> dict[str, Any]:
        """Return an info as Gymnasium has it for many: beside every array, which robots it is of."""
        masks = self.episodes.arrays.full((len(info), self.num_envs), 0, "bool")
        masks[:] = mask
        return info | {f"_{name}": own for name, own in zip(info, masks, strict=True)}

    def _read_mask(self, options: dict[str, Any] | None) -> npt.NDArray[np.bool_]:
        if options is not None and not isinstance(options, Mapping):
            raise InputError(f"the options of reset must be a mapping, got {show_value(options)}")
        for name in options or ():
            if name != "reset_mask":  # with a misspelt one all episodes would be lost
                raise UnknownNameError("option of reset", str(name), ["reset_mask"])
        if not options:
            return np.ones(self.num_envs, dtype=bool)
        given = options["reset_mask"]
        mask = np.asarray(given if isinstance(given, np.ndarray | list) else self.episodes.arrays.host(given))
        if mask.shape != (self.num_envs,) or mask.dtype != np.bool_:
            raise InputError(f"reset_mask must be bools of shape ({self.num_envs},), got {mask.dtype} of {mask.shape}")
        return mask

    def _seed(self, seed: int | Sequence[int | None] | None, robots: npt.NDArray[np.int64]) -> None:
        put = self.episodes.arrays.put
        if seed is None:
            fresh = robots[~self._ready[robots]]
            if len(fresh):
                self.episodes.seed(self.np_random.integers(2**62, size=self.num_envs)[fresh], put(fresh))
            return
        if isinstance(seed, int | np.integer):
            first = check_count("seed", seed, 0, LARGEST_SEED + 1 - self.num_envs)
            self.episodes.seed(np.uint64(first) + robots.astype(np.uint64), put(robots))
            return
        if isinstance(seed, np.ndarray):
            seed = seed.tolist()
        if not isinstance(seed, Sequence) or isinstance(seed, str | bytes):
            raise InputError(
                f"a seed must be an integer, a list of one for each robot, or None, got {show_value(seed)}"
            )
        if len(seed) != self.num_envs:
            raise InputError(f"a list of seeds needs one for each of {self.num_envs} robots, got {len(seed)}")
        given = [robot for robot in robots if seed[robot] is not None or not self._ready[robot]]
        drawn = [
            int(self.np_random.integers(2**62))
            if seed[robot] is None
            else check_count(f"the seed of robot {robot}", seed[robot], 0, LARGEST_SEED)
            for robot in given
        ]
        if given:
            self.episodes.seed(drawn, put(np.array(given)))


def _read_mode(mode: str | AutoresetMode) -> AutoresetMode:
    if isinstance(mode, AutoresetMode):
        return mode
    if str(mode).lower() not in _MODES:
        raise UnknownNameError("autoreset mode", str(mode), _MODES)
    return _MODES[str(mode).lower()]
