import builtins

import av
import numpy as np
import pytest
from PIL import Image, ImageDraw

from trundle.control.controller import Rollouts
from trundle.errors import InputError, OutputError
from trundle.geometry import Pose2D
from trundle.pictures.colors import BAD, ESTIMATED, WARNING
from trundle.record.video import (
    MAX_FRAMES,
    DrawnFrames,
    SampleHistory,
    caption,
    encode,
    pick_rows,
    playing_rate,
    write_video,
)
from trundle.sim import MoverState
from trundle.sim.mover_history import MoverHistory, ShownMovers


def pictures(count=5, shape=(48, 64)):
    for index in range(count):
        yield np.full((*shape, 3), 20 * index, dtype=np.uint8)


def frames(path):
    with av.open(str(path)) as container:
        return [frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)]


def test_pictures_become_frames_of_a_video(tmp_path):
    assert encode(tmp_path / "v.mp4", pictures(5, (49, 65))) == "v.mp4"
    got = frames(tmp_path / "v.mp4")
    assert len(got) == 5
    assert got[0].shape == (48, 64, 3)  # H.264 needs even sides
    assert [round(float(frame.mean()), -1) for frame in got] == [0, 20, 40, 60, 80]
    assert [file.name for file in tmp_path.iterdir()] == ["v.mp4"]


def test_without_pyav_it_becomes_a_gif(tmp_path, monkeypatch):
    original = builtins.__import__

    def refuse(name, *arguments, **options):
        if name == "av" or name.startswith("av."):
            raise ImportError(name)
        return original(name, *arguments, **options)

    monkeypatch.setattr(builtins, "__import__", refuse)
    assert encode(tmp_path / "v.mp4", pictures()) == "v.gif"
    with Image.open(tmp_path / "v.gif") as image:
        assert image.n_frames == 5
    with pytest.raises(InputError):
        encode(tmp_path / "none.mp4", [])
    assert not (tmp_path / "none.gif").exists()


def test_no_picture_is_refused_and_no_folder_is_an_output_error(tmp_path):
    with pytest.raises(InputError, match="at least one"):
        encode(tmp_path / "v.mp4", [])
    with pytest.raises(OutputError):
        encode(tmp_path / "none" / "v.mp4", pictures())
    assert list(tmp_path.iterdir()) == []


def test_short_runs_are_shown_whole_and_long_ones_as_a_time_lapse():
    assert pick_rows(1).tolist() == [0]
    assert pick_rows(7).tolist() == list(range(7))
    rows = pick_rows(5000)
    assert len(rows) == MAX_FRAMES
    assert rows[0] == 0
    assert rows[-1] == 4999
    assert np.diff(rows).max() <= 18


@pytest.mark.slow
def test_a_run_is_drawn_and_reported(recorded, tmp_path):
    reports = []
    name = write_video(
        tmp_path / "v.mp4", recorded.info, recorded.episode, report=lambda *report: reports.append(report)
    )
    count = min(MAX_FRAMES, len(recorded.episode.trajectory))
    assert len(frames(tmp_path / name)) == count
    assert reports[-1] == ("video", count, count)


def test_drawn_frames_move_the_robot_and_keep_its_trail(recorded):
    poses = [recorded.steps[0].state.pose, recorded.steps[-1].state.pose]
    with DrawnFrames(recorded.info, recorded.episode) as source:
        first, last = (source.render(pose, ShownMovers()).astype(int) for pose in poses)
    assert first.shape == last.shape
    assert (abs(first - last).sum(axis=2) > 30).sum() > 500


def test_pictures_may_come_from_elsewhere_and_the_source_is_closed(recorded, tmp_path):
    class Grey:
        closed = False

        def __enter__(self):
            return self

        def __exit__(self, *_):
            Grey.closed = True

        def render(self, pose, movers):
            return np.full((360, 640, 3), 128, dtype=np.uint8)

    write_video(tmp_path / "v.mp4", recorded.info, recorded.episode, lambda run, episode: Grey())
    assert Grey.closed
    first, *_, last = frames(tmp_path / "v.mp4")
    assert first[60:].mean() == pytest.approx(128, abs=3)
    light = (first[:40] > 200).all(axis=-1)
    assert 0.1 < light.mean() < 0.8  # the caption's field
    assert (np.abs(first[:40].astype(int) - last[:40]) > 60).any()  # another time


def test_frames_say_time_speed_and_how_fast_they_play(monkeypatch):
    said = []
    write = ImageDraw.ImageDraw.text
    monkeypatch.setattr(
        ImageDraw.ImageDraw, "text", lambda self, at, text, **more: (said.append(text), write(self, at, text, **more))
    )
    frame = np.zeros((540, 960, 3), dtype=np.uint8)
    captioned = caption(frame, 12.34, 0.617, 4.04)
    caption(frame, 0.0, -0.001, 1.0)
    assert said == ["12.3 s", "0.62 m/s", "4.0x speed", "0.0 s", "0.00 m/s", "real time"]
    assert not frame.any()  # a source may give the same frame again
    rows = np.flatnonzero(captioned.any(axis=(1, 2)))
    assert rows.max() - rows.min() > 25  # large enough to be read
    assert caption(np.zeros((8, 8, 3), dtype=np.uint8), 1.0, 1.0, 1.0).shape == (8, 8, 3)


@pytest.mark.parametrize(("state", "color"), [("lost", BAD), ("ambiguous", WARNING), ("localized", None)])
def test_a_frame_says_where_the_robot_is_not_sure_of_its_place(state, color):
    frame = caption(np.zeros((400, 600, 3), dtype=np.uint8), 1.0, 0.5, 1.0, state)
    marks = [one for one in (BAD, WARNING) if (frame == one).all(axis=2).any()]
    assert marks == ([] if color is None else [color])


def test_how_fast_a_video_plays_follows_from_its_frames():
    assert playing_rate(np.arange(0.0, 5.0, 0.05), 20) == pytest.approx(1.0)
    times = np.linspace(0.0, 100.0, 2001)[pick_rows(2001)]
    assert playing_rate(times, 30) == pytest.approx(10.0, rel=0.01)
    assert playing_rate(np.array([3.0]), 30) == 1.0


def test_drawn_frames_show_the_movers_with_their_trails(recorded):
    start = recorded.steps[0].state.pose
    near = Pose2D(start.x + 0.4, start.y, 0.0)
    square = ((-0.2, -0.2), (0.2, -0.2), (0.2, 0.2), (-0.2, 0.2))
    trail = np.array([(near.x, near.y - 1.0 + 0.1 * index) for index in range(11)])
    history = MoverHistory()
    history.add(0.0, (MoverState("cart", near, outline=square),))
    shown = history.at(0.0)._replace(trails=(trail,))
    with DrawnFrames(recorded.info, recorded.episode) as source:
        plain, moving = (source.render(start, each).astype(int) for each in (ShownMovers(), shown))
        again = source.render(start, ShownMovers()).astype(int)
    changed = abs(moving - plain).sum(axis=2) > 60
    assert changed.sum() > 100
    assert np.ptp(np.flatnonzero(changed.any(axis=1))) > 1.1 * np.ptp(np.flatnonzero(changed.any(axis=0)))
    assert (abs(again - plain).sum(axis=2) > 60).sum() == 0  # nothing of it stays


def test_drawn_frames_show_the_samples_of_their_step_only(recorded):
    start = recorded.steps[0].state.pose
    along = start.x + np.linspace(0.0, 1.5, 57)
    poses = np.stack([np.column_stack([along, np.full(57, start.y + offset), np.zeros(57)]) for offset in (-0.3, 0.3)])
    history = SampleHistory()
    history.add(3, None)
    history.add(3, Rollouts(poses[:0], np.zeros(0)))  # none of them was free
    assert len(history) == 0
    history.add(4, Rollouts(poses, np.zeros(2)))
    with DrawnFrames(recorded.info, recorded.episode) as source:
        frames = []
        source.render(start, ShownMovers())
        for index in (3, 4, 5):
            source.samples = history.at(index)
            frames.append(source.render(start, ShownMovers()).astype(int))
    plain, sampled, again = frames
    assert (abs(sampled - plain).sum(axis=2) > 60).sum() > 100
    assert (abs(again - plain).sum(axis=2) > 60).sum() == 0
    history.add(0, None)
    assert len(history) == 0  # another run


def test_a_drawn_frame_shows_the_robot_where_it_believes_to_be(recorded):
    pose = recorded.episode.start
    with DrawnFrames(recorded.info, recorded.episode) as source:
        plain = source.render(pose, ShownMovers())
        source.estimate = Pose2D(pose.x + 1.0, pose.y + 1.0, 0.5)
        shown = source.render(pose, ShownMovers())
    count = [int((one == ESTIMATED).all(axis=2).sum()) for one in (plain, shown)]
    assert count[0] == 0
    assert count[1] > 50
