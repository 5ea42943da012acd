"""`Watch`: the observer that hands a run to the hub."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from trundle.mission import Episode, Observer, RunInfo, Steering, Step
from trundle.page.scene import solid_instances
from trundle.serve.hub import Hub
from trundle.serve.page_messages import encode_message
from trundle.serve.run_feed import RunFeed, scene_message
from trundle.worlds import World

REPORT = "report.html"


class Watch:
    """Shows one run to the pages; it takes next to no time of the run's thread.

    Args:
        hub: Where the pages are.
        number: Number of the run, from 1.
        folder: Where the run is recorded, so that pages get its files; None if it is not recorded.
        world: The simulated world now, with what was added to it.
        steering: The steering through which pages steer it; None if they cannot.
    """

    def __init__(
        self,
        hub: Hub,
        number: int,
        folder: Path | None,
        *,
        world: Callable[[], World | None] | None = None,
        steering: Steering | None = None,
    ) -> None:
        self._hub, self._number, self._folder, self._world, self._steering = hub, number, folder, world, steering
        self._feed: RunFeed | None = None
        self._solids = 0

    @property
    def wants_rollouts(self) -> bool:
        """Whether a page shows the samples of the controller."""
        return len(self._hub) > 0

    def on_start(self, run: RunInfo) -> None:
        """Show the world and the start."""
        self._solids = 0 if run.world is None else len(run.world.solids)
        scene, remark = scene_message(run.world, run.robot, run.grid)
        if remark:
            self._hub.announce(remark)
        if self._folder is not None:
            self._hub.folders[self._number] = self._folder.resolve()
        orders = None if self._steering is None else self._steering.run
        self._feed = RunFeed(self._number, scene, run, orders)
        self._hub.present(self._feed)

    def on_step(self, step: Step) -> None:
        """Hand over the step, and what was added to the world."""
        feed = self._feed
        if feed is None:
            return
        if step.steering is not None and step.steering.boxes > len(feed.solids):
            self._add_solids(feed)
        feed.add(step)

    def on_end(self, episode: Episode) -> None:
        """Hand over the end; the outcome is shown once it is `recorded`."""
        if self._feed is not None:
            self._feed.add(episode)

    @property
    def recorded(self) -> Observer:
        """The observer to be notified after those that write the folder: it shows the outcome, with its files."""
        return _Recorded(self._tell_end)

    def _tell_end(self, episode: Episode) -> None:
        feed, folder = self._feed, self._folder
        if feed is None:
            return
        has_report = folder is not None and (folder / REPORT).is_file()
        feed.end = encode_message(
            "end",
            outcome=episode.outcome.value,
            message=episode.message,
            folder=None if folder is None else str(folder),
            files=None if folder is None else f"/runs/{self._number}/",
            replay=f"/runs/{self._number}/{REPORT}" if has_report else None,
        )

    def _add_solids(self, feed: RunFeed) -> None:
        world = None if self._world is None else self._world()
        if world is None:
            return
        for solid in world.solids[self._solids :]:
            feed.solids.append(encode_message("solid", instances=solid_instances([solid])))
        self._solids = len(world.solids)


class _Recorded:
    """An observer that calls a function when the run ends."""

    def __init__(self, tell: Callable[[Episode], None]) -> None:
        self._tell = tell

    def on_start(self, run: RunInfo) -> None:
        """Do nothing."""

    def on_step(self, step: Step) -> None:
        """Do nothing."""

    def on_end(self, episode: Episode) -> None:
        """Call back."""
        self._tell(episode)
