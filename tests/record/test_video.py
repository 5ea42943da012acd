import builtins

import av
import numpy as np
import pytest
from PIL import Image

from trundle.errors import InputError, OutputError
from trundle.record.video import MAX_FRAMES, DrawnFrames, encode, pick_rows, write_video


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


def test_a_run_is_drawn_and_reported(told, tmp_path):
    reports = []
    name = write_video(tmp_path / "v.mp4", told.info, told.episode, report=lambda *report: reports.append(report))
    count = min(MAX_FRAMES, len(told.episode.trajectory))
    assert len(frames(tmp_path / name)) == count
    assert reports[-1] == ("video", count, count)


def test_drawn_frames_move_the_robot_and_keep_its_way(told):
    poses = [told.steps[0].state.pose, told.steps[-1].state.pose]
    with DrawnFrames(told.info, told.episode) as source:
        first, last = (source.render(pose).astype(int) for pose in poses)
    assert first.shape == last.shape
    assert (abs(first - last).sum(axis=2) > 30).sum() > 500


def test_pictures_may_come_from_elsewhere_and_the_source_is_closed(told, tmp_path):
    class Grey:
        closed = False

        def __enter__(self):
            return self

        def __exit__(self, *_):
            Grey.closed = True

        def render(self, pose):
            return np.full((32, 32, 3), 128, dtype=np.uint8)

    write_video(tmp_path / "v.mp4", told.info, told.episode, lambda run, episode: Grey())
    assert Grey.closed
    assert frames(tmp_path / "v.mp4")[0].mean() == pytest.approx(128, abs=3)
