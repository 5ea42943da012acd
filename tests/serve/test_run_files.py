import os
from pathlib import Path

import pytest

from trundle.serve import run_files
from trundle.serve.run_files import TooLargeError, find_run_file, list_run_files, read_run_file


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    run = tmp_path / "run"
    run.mkdir()
    (run / "report.html").write_text("<title>report</title>")
    (run / "run.mcap").write_bytes(b"mcap")
    (run / ".hidden").write_text("no")
    (run / "sub").mkdir()
    (run / "sub" / "inside.txt").write_text("no")
    (tmp_path / "secret.txt").write_text("secret")
    (run / "link.txt").symlink_to(tmp_path / "secret.txt")
    os.mkfifo(run / "pipe")
    return run


def test_files_of_a_run_are_read_with_their_type(folder: Path) -> None:
    report = read_run_file(folder, "report.html")
    assert (report.content, report.kind) == (b"<title>report</title>", "text/html; charset=utf-8")
    assert read_run_file(folder, "run.mcap").is_download


@pytest.mark.parametrize(
    "name",
    [
        "..",
        ".",
        "",
        ".hidden",
        "link.txt",
        "pipe",
        "sub",
        "sub/inside.txt",
        "../secret.txt",
        "no.txt",
        "a\0b",
        "%2e%2e",
    ],
)
def test_nothing_else_is_read(folder: Path, name: str) -> None:
    with pytest.raises(OSError):  # noqa: PT011 - of any kind
        read_run_file(folder, name)


def test_a_file_that_is_too_large_is_refused(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run_files, "MAX_FILE_BYTES", 3)
    with pytest.raises(TooLargeError, match=r"run\.mcap has 0 MB: open it in the folder"):
        read_run_file(folder, "run.mcap")


def test_the_list_names_what_can_be_read(folder: Path) -> None:
    page = list_run_files(3, folder)
    assert '<a href="/runs/3/report.html">' in page
    assert not any(name in page for name in ("hidden", "link.txt", "pipe", "sub"))


def test_addresses_name_given_runs_only(tmp_path: Path) -> None:
    folders = {2: tmp_path}
    assert find_run_file(folders, "/runs/2/report.html") == (2, tmp_path, "report.html")
    assert find_run_file(folders, "/runs/2/") == (2, tmp_path, "")
    for path in ("/runs/3/report.html", "/runs/2/a/b", "/runs/02x/a", "/runs/", "/etc/passwd", "/runs/2/../../x"):
        assert find_run_file(folders, path) is None, path
