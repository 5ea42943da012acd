import io
import sys

from trundle.record.progress import ProgressBar


class Terminal(io.StringIO):
    def isatty(self):
        return True


def show(recorded, monkeypatch, stream, **options):
    """What a run with a bar writes to the error stream."""
    monkeypatch.setenv("TERM", "xterm-256color")
    monkeypatch.setattr(sys, "stderr", stream)
    with ProgressBar(**options) as bar:
        bar.on_start(recorded.info)
        for step in recorded.steps:
            bar.on_step(step)
        bar.on_end(recorded.episode)
        bar.report("video", 3, 10)
    return stream.getvalue()


def test_a_terminal_sees_how_far_it_is_and_the_time_left(recorded, monkeypatch):
    shown = show(recorded, monkeypatch, Terminal())
    assert "driving" in shown
    assert "100 %" in shown
    assert "video" in shown
    assert "left" in shown


def test_quiet_and_no_terminal_show_nothing(recorded, monkeypatch):
    assert show(recorded, monkeypatch, Terminal(), quiet=True) == ""
    assert show(recorded, monkeypatch, io.StringIO()) == ""


def test_plain_lines_tell_each_quarter_where_there_is_no_terminal(recorded, monkeypatch):
    lines = show(recorded, monkeypatch, io.StringIO(), plain=True).splitlines()
    assert lines[0] == "driving: 0%"
    assert lines[-2:] == ["driving: 100%", "video: 25%"]
    assert len(lines) == len(set(lines)) <= 6
    assert show(recorded, monkeypatch, io.StringIO(), plain=True, quiet=True) == ""
    assert "0%" not in show(recorded, monkeypatch, Terminal(), plain=True)
