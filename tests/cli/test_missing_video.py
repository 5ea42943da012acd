"""A run beside no PyAV says what brings its video."""

import sys

import pytest

from support.command_line import Trundle
from trundle.extras import install_line


@pytest.mark.slow
@pytest.mark.parametrize("quiet", [False, True])
def test_a_run_without_pyav_says_how_to_get_its_video(
    trundle: Trundle, monkeypatch: pytest.MonkeyPatch, quiet: bool
) -> None:
    monkeypatch.setitem(sys.modules, "av", None)
    options = ("--quiet",) if quiet else ()
    done = trundle("run", "maze", "--seed", "1", "--time-limit", "1", "--json", *options)
    assert "video.gif" in done.json["files"]
    assert (f"For an MP4: {install_line('video')}" in done.err) is not quiet
