"""`RunFolder`: the folder of a run, also of one whose plug-in raised before there was a session."""

from __future__ import annotations

import io
import json
import logging
import math
import os
import platform
import time
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import replace
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Self

from PIL import Image

from trundle.errors import OutputError, TrundleError
from trundle.fault import find_fault, note_folder
from trundle.files.writing import write_bytes, write_text
from trundle.geometry import Pose2D, Twist2D
from trundle.mission import Episode, Outcome, RunInfo, Scenario, Step
from trundle.mission.goal_fields import make_goal
from trundle.mission.own_map import OwnMap
from trundle.mission.run_files import DIRECTIVES_FILE, save_directives, save_paths
from trundle.mission.running.episode_maker import make_episode
from trundle.mission.running.preparation import describe_run, standing_at
from trundle.mission.running.run_log import AgentTotals, RunLog
from trundle.navigation import AgentInfo
from trundle.navigation.agent import CONTROL_PERIOD_S
from trundle.page.report import REPORT, report_scene, write_report
from trundle.page.run_data import RunData
from trundle.record.folder_claim import FolderClaim
from trundle.record.overlay import MoverTrails, draw_run
from trundle.record.own_map import MapGrowth, costmap_of, draw_own_map
from trundle.record.video import MakeFrames, Report, SampleHistory, write_video
from trundle.robots import Robot
from trundle.version import __version__

_LOGGER = logging.getLogger(__name__)

_VERSIONS = ("numpy", "mujoco", "ovphysx", "isaacsim", "pillow", "av")


WriteExtra = Callable[[Path, Episode], object]
"""Writes an additional file of a run, given its path and the episode."""


class RunFolder:
    """An observer that writes a run's folder at its end.

    `trajectory.npz`, `paths.npz`, `scenario.yaml`, `directives.json` of a steered run, and `episode.json` are written
    first, so that a later failure cannot lose the outcome; then the report, pictures and video. `episode.json` is
    written again at the end, with `complete: true`. Of a robot that has made a map there is also `own_map.yaml`, on
    which the pictures are drawn, with its poses and loops in `own_map_overlay.png`, and as it grew in `own_map.mp4`.

    Use it in a `with` block: an empty folder is removed if it was created here.

    Args:
        out: The folder. By default, it is a new `runs/<time>-<name>`.
        name: Name of the run, for the folder's name.
        overwrite: Replace an existing run in the folder; it is deleted once the new one is complete.
        scenario: The exact scenario, written as `scenario.yaml`; None if the run has none.
        page: Whether to write `report.html`: one file with the replay, plots and figures of the run.
        overlay: Whether to draw `overlay.png`.
        video: Whether to make `video.mp4`.
        frames: Source of the video's pictures. By default, they are drawn from above.
        report: Called with the progress of the video.
        extras: Additional files by name, with their writers.

    Attributes:
        path: The folder.
        record: The content of `episode.json`; None before the end.

    Raises:
        OutputError: If the folder holds a run, another run is writing there, or it cannot be written to.
    """

    def __init__(
        self,
        out: str | os.PathLike[str] | None = None,
        *,
        name: str = "run",
        overwrite: bool = False,
        scenario: Scenario | None = None,
        page: bool = True,
        overlay: bool = True,
        video: bool = True,
        frames: MakeFrames | None = None,
        report: Report | None = None,
        extras: Mapping[str, WriteExtra] | None = None,
    ) -> None:
        self._extras = dict(extras or {})
        self._claim = FolderClaim(out, name, overwrite=overwrite, extra=with_images(self._extras))
        self.path = self._claim.path
        self.record: dict[str, object] | None = None
        self._scenario = scenario
        self._data = RunData() if page else None
        self._overlay = overlay
        self._video = video
        self._frames = frames
        self._report = report
        self._info: RunInfo | None = None
        self._movers = MoverTrails()
        self._samples = SampleHistory()
        self._growth = MapGrowth()
        self._files: list[str] = []
        self._failures: list[str] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._claim.close()

    @property
    def wants_rollouts(self) -> bool:
        """Whether it needs the samples of the controller: for its video and its report."""
        return bool(self._video) or self._data is not None

    def on_start(self, run: RunInfo) -> None:
        """Store the information of the run.

        Raises:
            OutputError: If it has already recorded a run.
        """
        if self.record is not None:
            raise OutputError(f"{self.path} already has a run; create another RunFolder for the next one")
        self._info = run
        self._follow(lambda data: data.on_start(run))

    def on_step(self, step: Step) -> None:
        """Keep where the movers are, and what the video shows of samples; the episode has everything else."""
        self._movers.add(step.state.time, step.state.movers)
        self._follow(lambda data: data.on_step(step))
        if self._video:
            self._samples.add(step.index, step.rollouts)
            self._growth.on_step(step)

    def on_end(self, episode: Episode) -> None:
        """Write the files. If one fails, or is stopped by Ctrl-C, the others are still written.

        Raises:
            OutputError: If files could not be written; it names them.
        """
        info = self._info
        if info is None:
            raise OutputError("the run folder got the end of a run without its start: pass it to run(observers=[…])")
        with self._claim.replacing():
            self._save("trajectory.npz", episode.trajectory.save)
            self._save("paths.npz", lambda path: save_paths(path, episode.paths))
            self._save_scenario(episode)
            self._save_record(episode, complete=False)
            own = episode.own_map
            if own is not None:
                self._save("own_map.yaml", own.grid.save)
            self._save_report(info, episode)
            if own is not None:
                info = replace(info, costmap=costmap_of(own.grid, info.robot))
            self._save_pictures(info, episode)
            if own is not None:
                self._save_own_map(own, info)
            self._save_record(episode, complete=True)
        self._claim.close()
        if self._failures:
            raise OutputError(f"in {self.path}: " + "; ".join(self._failures))

    def _save(self, file: str, write: Callable[[Path], object]) -> None:
        """Write a file; if `write` returns a name, that is the actual file."""
        try:
            name = write(self.path / file)
            self._files.append(name if isinstance(name, str) else file)
        except KeyboardInterrupt:
            _LOGGER.warning("%s was not written: stopped by Ctrl-C", file)
        except (TrundleError, OSError, ValueError) as error:
            self._failures.append(f"{file}: {error}")

    def _save_scenario(self, episode: Episode) -> None:
        """Write what repeats the run."""
        scenario = self._scenario
        if episode.directives:
            self._save(DIRECTIVES_FILE, lambda path: save_directives(path, episode.directives))
            if scenario is not None:
                scenario = scenario.model_copy(update={"directives": str(self.path / DIRECTIVES_FILE)})
        if scenario is not None:
            self._save("scenario.yaml", scenario.save)

    def _follow(self, follow: Callable[[RunData], object]) -> None:
        """Let the report follow the run; where it fails, the run and its other files go on without it."""
        if self._data is None:
            return
        try:
            follow(self._data)
        except Exception as error:  # noqa: BLE001 - a report never costs the record of a run
            self._data = None
            self._failures.append(f"{REPORT}: {error or type(error).__name__}")

    def _save_report(self, info: RunInfo, episode: Episode) -> None:
        self._follow(lambda data: data.on_end(episode))
        self._follow(lambda data: self._save(REPORT, lambda path: self._write_report(path, data, info)))

    def _write_report(self, path: Path, data: RunData, info: RunInfo) -> None:
        write_report(
            path,
            run=data.run_dict(),
            scene=report_scene(info.world, info.robot, info.grid),
            record=self.record or {},
            settings=None if self._scenario is None else self._scenario.plain(),
            folder=self.path,
        )

    def _save_pictures(self, info: RunInfo, episode: Episode) -> None:
        if self._overlay:
            self._save(
                "overlay.png",
                lambda path: save_png(
                    draw_run(info.costmap, info.robot, episode, speed_mask=info.speed_mask, movers=self._movers), path
                ),
            )
        for name, write in self._extras.items():
            self._save(name, lambda path, write=write: write(path, episode))
        if self._video:
            self._save(
                "video.mp4",
                lambda path: write_video(
                    path, info, episode, self._frames, movers=self._movers, samples=self._samples, report=self._report
                ),
            )

    def _save_own_map(self, own: OwnMap, info: RunInfo) -> None:
        """Write the pictures of the map that the robot has made."""
        if self._overlay:
            title = f"{info.name} · own map"
            self._save("own_map_overlay.png", lambda path: save_png(draw_own_map(own, title=title), path))
        if self._video:
            self._save("own_map.mp4", lambda path: self._growth.write(path, own.grid, info.robot))

    def _save_record(self, episode: Episode, *, complete: bool) -> None:
        """Write episode.json, without which the folder holds no run.

        Raises:
            OutputError: If it cannot be written.
        """
        self.record = {
            **episode.as_dict(),
            **({} if episode.own_map is None else {"own_map": episode.own_map.as_dict()}),
            "run_dir": str(self.path),
            "files": list(self._files),
            "versions": _versions(),
            "written": time.strftime("%Y-%m-%dT%H:%M:%S%z"),
            "complete": complete,
        }
        write_text(self.path / "episode.json", json.dumps(self.record, indent=2, allow_nan=False) + "\n", durable=True)


def with_images(names: Iterable[str]) -> tuple[str, ...]:
    """Return names of files, and of the images of those that are maps."""
    return tuple(
        one for name in names for one in ((name, f"{Path(name).stem}.png") if name.endswith(".yaml") else (name,))
    )


def save_png(image: Image.Image, path: str | os.PathLike[str]) -> None:
    """Write a PNG atomically.

    Raises:
        OutputError: If it cannot be written.
    """
    content = io.BytesIO()
    image.save(content, format="PNG", compress_level=4)
    write_bytes(path, content.getvalue())


def _versions() -> dict[str, str]:
    versions = {"trundle": __version__, "python": platform.python_version()}
    for package in _VERSIONS:
        with suppress(PackageNotFoundError):
            versions[package] = version(package)
    return versions


def record_failure(
    error: BaseException,
    scenario: Scenario,
    out: str | os.PathLike[str] | None = None,
    *,
    overwrite: bool = False,
    page: bool = True,
) -> Path:
    """Write the folder of a run that an exception ended before it began, and note it in the exception.

    Args:
        error: What a plug-in raised, such as the constructor of a planner.
        scenario: What was to be run.
        out: The folder. By default, it is a new one in `runs`.
        overwrite: Replace an existing run in it.
        page: Whether to write report.html.

    Returns:
        The folder.

    Raises:
        OutputError: If it cannot be written.
    """
    with RunFolder(
        out, name=scenario.title, overwrite=overwrite, scenario=scenario, page=page, overlay=False, video=False
    ) as folder:
        episode, info = _failed_episode(error, scenario)
        folder.on_start(info)
        folder.on_end(episode)
    note_folder(error, folder.path)
    return folder.path


def _failed_episode(error: BaseException, scenario: Scenario) -> tuple[Episode, RunInfo]:
    start = Pose2D(0.0, 0.0) if scenario.start is None else Pose2D.of(scenario.start)
    given = scenario.goals if scenario.goals is not None else () if scenario.goal is None else (scenario.goal,)
    info = describe_run(
        AgentInfo(scenario.controller.name, scenario.planner.name),
        CONTROL_PERIOD_S,
        Robot.load(scenario.robot),
        scenario.title,
        start,
        tuple(make_goal(goal) for goal in given),
        (),
        math.inf if scenario.time_limit_s is None else scenario.time_limit_s,
        scenario.seed,
        None,
    )
    log = RunLog()
    state, estimate = standing_at(start)
    log.add(state, Twist2D(), estimate, 0, None)
    fault = find_fault(error)
    episode = make_episode(
        info,
        log,
        AgentTotals(),
        Outcome.ERROR,
        str(fault),
        goals_reached=0,
        behaviors=(),
        directives=(),
        world=None,
        boxes=(),
        wall_s=0.0,
        measure=None,
        fault=fault,
    )
    return episode, info
