"""`RunFolder`: writes what a run leaves, so that a kill at any moment leaves no half file."""

from __future__ import annotations

import io
import json
import logging
import os
import platform
import re
import time
from collections.abc import Callable
from contextlib import suppress
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Self

from PIL import Image

from trundle import __version__
from trundle.errors import OutputError, TrundleError
from trundle.files import make_folder, write_bytes, write_text
from trundle.mission import Episode, RunInfo, Scenario, Step
from trundle.record.overlay import draw_run
from trundle.record.video import MakeFrames, Report, write_video

_LOGGER = logging.getLogger(__name__)

_VERSIONS = ("numpy", "mujoco", "isaacsim", "pillow", "av")


def make_run_folder(out: str | os.PathLike[str] | None, name: str, *, root: str | os.PathLike[str] = "runs") -> Path:
    """Create the folder of a run: `out`, or a new `runs/<time>-<name>`.

    Raises:
        OutputError: If it cannot be created or written to.
    """
    if out is not None:
        return make_folder(out)
    make_folder(root)
    tidy = re.sub(r"[^\w.-]+", "-", name).strip("-.") or "run"
    stem = f"{time.strftime('%Y%m%d-%H%M%S')}-{tidy}"
    number = 1
    while True:
        folder = Path(root) / (stem if number == 1 else f"{stem}-{number}")
        try:
            folder.mkdir()
        except FileExistsError:
            number += 1
            continue
        except OSError as error:
            raise OutputError(f"cannot write to the folder {folder}: {error.strerror or error}") from error
        return make_folder(folder)


class RunFolder:
    """An observer that writes a run's folder at its end; `episode.json` comes last and says that all is there.

    Use it in a `with` block: a folder in which nothing was written is removed again, if it was made here.

    Args:
        out: The folder; none means a new `runs/<time>-<name>`.
        name: Of the run, for the folder's name.
        scenario: The exact scenario, written as `scenario.yaml`; none where the run has none.
        overlay: Whether to draw `overlay.png`.
        video: Whether to make `video.mp4`.
        frames: Where the video's pictures come from; none means a drawn view from above.
        report: Told how far the video is.

    Attributes:
        path: The folder.
        record: What `episode.json` holds; none before the end.

    Raises:
        OutputError: If the folder cannot be created or written to.
    """

    def __init__(
        self,
        out: str | os.PathLike[str] | None = None,
        *,
        name: str = "run",
        scenario: Scenario | None = None,
        overlay: bool = True,
        video: bool = True,
        frames: MakeFrames | None = None,
        report: Report | None = None,
    ) -> None:
        self._is_new = out is None or not Path(out).exists()
        self.path = make_run_folder(out, name)
        self.record: dict[str, object] | None = None
        self._scenario = scenario
        self._overlay = overlay
        self._video = video
        self._frames = frames
        self._report = report
        self._info: RunInfo | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._is_new:
            with suppress(OSError):  # it is not empty: it stays
                self.path.rmdir()

    def on_start(self, run: RunInfo) -> None:
        """Take an earlier run's record away: what is written from now on does not belong to it."""
        self._info = run
        (self.path / "episode.json").unlink(missing_ok=True)

    def on_step(self, step: Step) -> None:
        """Keep nothing: the episode has all of it."""

    def on_end(self, episode: Episode) -> None:
        """Write the files. One that fails, or is stopped by Ctrl-C, does not keep the others from being written.

        Raises:
            OutputError: If files could not be written; it names them.
        """
        info = self._info
        if info is None:
            raise OutputError("the run folder was not told of the start of the run")
        failures: list[str] = []
        files: list[str] = []

        def save(file: str, write: Callable[[Path], str | None]) -> None:
            try:
                files.append(write(self.path / file) or file)
            except KeyboardInterrupt:
                _LOGGER.warning("%s is left out: stopped by Ctrl-C", file)
            except (TrundleError, OSError, ValueError) as error:
                failures.append(f"{file}: {error}")

        save("trajectory.npz", episode.trajectory.save)
        if self._scenario is not None:
            save("scenario.yaml", self._scenario.save)
        if self._overlay:
            save(
                "overlay.png",
                lambda path: save_png(draw_run(info.costmap, info.robot, episode, speed_mask=info.speed_mask), path),
            )
        if self._video:
            save("video.mp4", lambda path: write_video(path, info, episode, self._frames, report=self._report))
        self.record = {
            **episode.as_dict(),
            "run_dir": str(self.path),
            "files": list(files),
            "versions": _versions(),
            "written": time.strftime("%Y-%m-%dT%H:%M:%S%z"),
        }
        save("episode.json", lambda path: write_text(path, json.dumps(self.record, indent=2, allow_nan=False) + "\n"))
        if failures:
            raise OutputError(f"in {self.path}: " + "; ".join(failures))


def save_png(image: Image.Image, path: str | os.PathLike[str]) -> None:
    """Write a PNG whole, or leave what was there.

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
