"""`video.mp4`: a time-lapse of a run, rendered or drawn."""

from __future__ import annotations

import io
import os
from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager
from fractions import Fraction
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Protocol, Self, TypeAlias

import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw

from trundle.control.controller import Rollouts
from trundle.errors import InputError, OutputError
from trundle.files.writing import write_bytes
from trundle.geometry import FloatArray, Pose2D
from trundle.mission import Episode, RunInfo
from trundle.observation import LOCALIZATION_STATES, LocalizationState
from trundle.pictures.colors import ESTIMATED, GOAL, INK, PAGE, PLANNED, ROBOT, SAMPLED, START, WARNING
from trundle.pictures.figure import font
from trundle.record.map_view import STATE_COLORS, has_estimates, view_run
from trundle.sim.mover_history import MoverHistory, ShownMovers

FRAMES_PER_SECOND = 30
MAX_FRAMES = 300
DRAWN_SIDE = 840  # least longer side of a drawn frame [px], where the map has fewer cells
MAX_DRAWN_SIDE = 1280  # with more cells than this, several share a pixel

Pixels: TypeAlias = npt.NDArray[np.uint8]
Report: TypeAlias = Callable[[str, int, int], None]
"""Called with the task, the number of finished parts, and their total."""

Samples: TypeAlias = npt.NDArray[np.float32]
"""Places (x, y) [m], map frame, shape (N, T, 2), of N samples."""

LINES = 12
"""How many samples are kept of a step."""
_POINTS = 15  # of each sample, about


class FrameSource(Protocol):
    """Gives a picture for each pose, in the order of the run."""

    def render(self, pose: Pose2D, movers: ShownMovers) -> Pixels:
        """Return the picture of the robot at a pose, and of the movers then.

        RGB, uint8, shape (height, width, 3), always of the same size.
        """
        ...


MakeFrames: TypeAlias = Callable[[RunInfo, Episode], AbstractContextManager[FrameSource]]


def write_video(
    path: str | os.PathLike[str],
    run: RunInfo,
    episode: Episode,
    frames: MakeFrames | None = None,
    *,
    movers: MoverHistory | None = None,
    samples: SampleHistory | None = None,
    report: Report | None = None,
) -> str:
    """Write a time-lapse of a run, of at most 300 frames; as an animated GIF if PyAV is missing.

    Each frame shows the time, the robot's speed and the playback rate.

    Args:
        path: The .mp4 to write.
        run: The run.
        episode: Its episode.
        frames: Source of the pictures. By default, they are drawn from above.
        movers: Where the moving obstacles were. If None, none are shown.
        samples: The controller's best samples, thin lines in the drawn view. If None, none are shown.
        report: Called with the progress.

    Returns:
        The name of the file that was written: of the .mp4, or of a .gif beside it.

    Raises:
        OutputError: If it cannot be written.
    """
    rows = pick_rows(len(episode.trajectory))
    lapse = len(rows) < len(episode.trajectory)
    fps = FRAMES_PER_SECOND if lapse else max(1, round(1.0 / run.dt))
    trajectory = episode.trajectory
    rate = playing_rate(trajectory.time[rows], fps)
    believes = has_estimates(trajectory)

    def pictures(source: FrameSource) -> Iterator[Pixels]:
        for number, row in enumerate(rows):
            time = float(trajectory.time[row])
            moving = ShownMovers() if movers is None else movers.at(time)
            if samples is not None and isinstance(source, DrawnFrames):
                source.samples = samples.at(int(row))
            if believes and isinstance(source, DrawnFrames):
                source.estimate = Pose2D(*trajectory.estimates[row].tolist())
            state = LOCALIZATION_STATES[trajectory.localization[row]]
            frame = source.render(Pose2D(*trajectory.poses[row].tolist()), moving)
            yield caption(frame, time, float(trajectory.v[row]), rate, state)
            if report is not None:
                report("video", number + 1, len(rows))

    make = frames or DrawnFrames
    with make(run, episode) as source:
        return encode(path, pictures(source), fps=fps)


def playing_rate(times: FloatArray, fps: int) -> float:
    """Return the playback rate: seconds of the run per second of video, for frames at these times [s]."""
    return float(times[-1] - times[0]) * fps / max(1, len(times) - 1) if len(times) > 1 else 1.0


def caption(frame: Pixels, time_s: float, speed: float, rate: float, state: LocalizationState = "localized") -> Pixels:
    """Write the time [s], the speed [m/s] and the playback rate into the upper left corner of a frame.

    Where the localizer is not sure, its state follows.
    """
    size = max(13, frame.shape[0] // 26)
    letters = font(size)
    speed = round(speed, 2) + 0.0  # never -0.00
    texts = (f"{time_s:.1f} s", f"{speed:.2f} m/s", f"{rate:.1f}x speed" if rate >= 1.05 else "real time")
    widths = [letters.getlength(text) for text in ("8888.8 s", "-88.88 m/s", "888.8x speed")]
    if state in STATE_COLORS:
        texts, widths = (*texts, state), [*widths, letters.getlength("ambiguous ")]
    room = (round(sum(widths)) + size, round(1.7 * size))
    # Drawn on a copy of only the corner: a frame may be shown more than once.
    corner = Image.fromarray(np.ascontiguousarray(frame[: room[1] + size // 2, : room[0] + size // 2]))
    draw = ImageDraw.Draw(corner, "RGBA")
    left, top = size // 2, size // 2
    draw.rectangle((left, top, corner.width, corner.height), fill=(*PAGE, 225))
    x = left + size // 2
    for text, wide in zip(texts, widths, strict=True):
        color = STATE_COLORS[state] if text == state and state in STATE_COLORS else INK
        draw.text((x, top + room[1] // 2), text, font=letters, fill=color, anchor="lm")
        x += round(wide)
    captioned = frame.copy()
    captioned[: corner.height, : corner.width] = np.asarray(corner)
    return captioned


def has_encoder() -> bool:
    """Return whether PyAV is installed, which writes .mp4 files; without it a video is an animated GIF."""
    try:
        return find_spec("av") is not None
    except ImportError:
        return False


def pick_rows(count: int) -> npt.NDArray[np.intp]:
    """Return which of `count` rows of a trajectory to show: all up to 300, else 300 evenly spread, with both ends."""
    return np.linspace(0, count - 1, min(MAX_FRAMES, count)).round().astype(np.intp)


def encode(path: str | os.PathLike[str], pictures: Iterable[Pixels], *, fps: int = FRAMES_PER_SECOND) -> str:
    """Write pictures of one size as H.264 (MPEG-4 part 2 without an encoder for it), or as GIF without PyAV.

    Returns:
        The name of the file that was written.

    Raises:
        OutputError: If it cannot be written.
        InputError: If there is no picture.
    """
    target = Path(path)
    try:
        import av
        import av.error
    except ImportError:
        return _encode_gif(target.with_suffix(".gif"), pictures, fps)
    stream: Any = None
    content = io.BytesIO()
    try:
        with av.open(content, "w", format="mp4") as container:
            for picture in pictures:
                even = np.ascontiguousarray(picture[: picture.shape[0] // 2 * 2, : picture.shape[1] // 2 * 2])
                if stream is None:
                    stream = _add_stream(container, even.shape, fps)
                container.mux(stream.encode(av.VideoFrame.from_ndarray(even, format="rgb24")))
            if stream is None:
                raise InputError("a video needs at least one picture")
            container.mux(stream.encode(None))
    except av.error.FFmpegError as error:
        raise OutputError(f"cannot write {target}: {error}") from error
    write_bytes(target, content.getvalue())
    return target.name


def _add_stream(container: Any, shape: tuple[int, ...], fps: int) -> Any:
    import av.codec

    has_h264 = "libx264" in av.codec.codecs_available
    stream = container.add_stream("libx264" if has_h264 else "mpeg4", rate=Fraction(fps))
    stream.height, stream.width = shape[:2]
    stream.pix_fmt = "yuv420p"
    stream.options = {"crf": "23", "preset": "ultrafast"} if has_h264 else {"qscale": "4"}
    return stream


def _encode_gif(target: Path, pictures: Iterable[Pixels], fps: int) -> str:
    images = [Image.fromarray(picture).quantize(64) for picture in pictures]
    if not images:
        raise InputError("a video needs at least one picture")
    content = io.BytesIO()
    pause = round(1000 / fps)  # [ms]
    images[0].save(content, format="GIF", save_all=True, append_images=images[1:], duration=pause, loop=0)
    write_bytes(target, content.getvalue())
    return target.name


class DrawnFrames:
    """Frames drawn from above: the map, the planned paths, the trajectory so far, the robot and its estimate.

    Args:
        run: The run.
        episode: Its episode.

    Attributes:
        samples: The controller's samples to draw in the next frame, or none.
        estimate: Where the robot believes to be in the next frame, or None where that is the true pose.
    """

    def __init__(self, run: RunInfo, episode: Episode) -> None:
        self.samples: Samples | None = None
        self.estimate: Pose2D | None = None
        self._robot = run.robot
        sides = {"long_side": DRAWN_SIDE, "max_side": MAX_DRAWN_SIDE}
        view = view_run(run.costmap, run.robot, episode, run.speed_mask, **sides)
        for path in episode.paths:
            view.line(path.poses[:, :2], PLANNED, 6)
        view.disc(episode.start.as_tuple()[:2], 6, START)
        for goal in episode.goals:
            view.ring(goal[:2], 8, GOAL, 2.5)
            view.disc(goal[:2], 3.5, GOAL)
        self._view = view
        self._picture = view.finish()
        self._last: Pose2D | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        """Do nothing: there is nothing to release."""

    def render(self, pose: Pose2D, movers: ShownMovers) -> Pixels:
        """Draw the next frame; the trajectory so far stays visible."""
        if self._last is not None:
            step = [(self._last.x, self._last.y), (pose.x, pose.y)]
            self._view.line(step, ROBOT, 2)
            self._view.refresh(self._picture, step, 4.0)
        self._last = pose
        frame = self._picture.copy()
        if self.samples is not None:
            self._view.stamp_lines(frame, self.samples, SAMPLED, 1.0)
        for trail, state in zip(movers.trails, movers.states, strict=True):
            self._view.stamp_trail(frame, trail, WARNING, 2.0)
            self._view.stamp(frame, state.pose, np.array(state.outline), WARNING)
        self._view.stamp(frame, pose, self._robot.outline, START)
        if self.estimate is not None:
            outline = self._robot.outline
            nose = np.array([(0.0, 0.0), (float(outline[:, 0].max()), 0.0)])
            for corners in (np.vstack([outline, outline[:1]]), nose):
                self._view.stamp_trail(frame, self.estimate.transform_points(corners), ESTIMATED, 2.5)
        return np.asarray(frame)


class SampleHistory:
    """Collects what a controller considered best in each step; nothing for steps without samples.

    A step takes about 1.5 kB.
    """

    def __init__(self) -> None:
        self._steps: dict[int, Samples] = {}

    def __len__(self) -> int:
        return len(self._steps)

    def add(self, index: int, rollouts: Rollouts | None) -> None:
        """Add the samples of a step, by its index; step 0 begins another run."""
        if index == 0:
            self._steps.clear()
        if rollouts is None or not len(rollouts.poses):
            return
        stride = max(1, rollouts.poses.shape[1] // _POINTS)
        self._steps[index] = rollouts.poses[:LINES, ::stride, :2].astype(np.float32)

    def at(self, index: int) -> Samples | None:
        """Return the samples of a step, the best first, or None if it had none."""
        return self._steps.get(index)
