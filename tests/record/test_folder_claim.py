"""A run's folder: nobody else writes there, and no earlier run is lost, whatever stops the new one."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from trundle.errors import OutputError
from trundle.files.writing import LOCK
from trundle.record.folder_claim import PREVIOUS, RUN_FILES, FolderClaim, check_free

OLD = {"episode.json": "old", "trajectory.npz": "old", "overlay.png": "old"}
NEW = {"trajectory.npz": "new", "episode.json": "new", "video.mp4": "new"}

WRITE = """
import sys
from pathlib import Path
from support.killed import kill_at_every_step
from trundle.record.folder_claim import FolderClaim

folder = Path(sys.argv[1])

def write(files):
    for name in files:
        (folder / name).write_text(files[name])

def prepare():
    for path in folder.rglob("*"):
        if path.is_file():
            path.unlink()
    write(OLD | {"mine.txt": "mine"})

def replace():
    with FolderClaim(folder, "run", overwrite=True) as claim, claim.replacing():
        write(NEW)

def read(folder):
    return {path.name: path.read_text() for path in folder.iterdir() if path.is_file() and path.name[0] != "."}

def check(step):
    # The next claim mends what was left.
    try:
        FolderClaim(folder, "run").close()
    except Exception as error:
        assert "holds a run" in str(error), error
    after = read(folder)
    assert after.pop("mine.txt") == "mine"
    kept = read(folder / "previous-run") if (folder / "previous-run").is_dir() else {}
    if after == OLD:
        print("old")
    elif kept == OLD and after["episode.json"] == "new":
        print("both")
    else:
        assert after == NEW and (not kept or set(kept) < set(OLD)), (step, after, kept)
        print("new")

kill_at_every_step(prepare, replace, check)
"""


def fill(folder: Path, files: dict[str, str]) -> None:
    folder.mkdir(exist_ok=True)
    for name, text in files.items():
        (folder / name).write_text(text)


def read(folder: Path) -> dict[str, str]:
    return {path.name: path.read_text() for path in folder.iterdir() if path.is_file()}


def test_a_kill_at_any_step_of_a_replacement_loses_neither_run_before_the_other_is_there(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", f"OLD, NEW = {OLD!r}, {NEW!r}\n{WRITE}", str(tmp_path)],
        env={**os.environ, "PYTHONPATH": str(Path(__file__).parents[1])},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    seen = done.stdout.split()
    assert seen == sorted(seen, key=("old", "both", "new").index)
    assert {"old", "both", "new"} == set(seen)


@pytest.mark.parametrize("name", RUN_FILES)
def test_a_folder_that_holds_a_run_is_refused_and_stays_as_it_is(tmp_path: Path, name: str) -> None:
    fill(tmp_path, {name: "old"})
    for refuse in (lambda: check_free(tmp_path), lambda: FolderClaim(tmp_path, "run")):
        with pytest.raises(OutputError, match=rf"{name}.*-o.*--overwrite"):
            refuse()
    assert read(tmp_path) == {name: "old"}


def test_files_that_are_not_of_a_run_are_no_hindrance_and_stay(tmp_path: Path) -> None:
    fill(tmp_path, {"notes.txt": "mine", "map.yaml": "mine"})
    check_free(tmp_path)
    with FolderClaim(tmp_path, "run", overwrite=True) as claim, claim.replacing():
        fill(tmp_path, NEW)
    assert read(tmp_path) == NEW | {"notes.txt": "mine", "map.yaml": "mine"}
    fill(tmp_path / "other", {"map.yaml": "mine"})
    with pytest.raises(OutputError, match=r"map\.yaml"):
        check_free(tmp_path / "other", extra=("map.yaml",))


def test_a_replaced_run_is_there_until_the_new_one_is_and_then_gone(tmp_path: Path) -> None:
    fill(tmp_path, OLD)
    with FolderClaim(tmp_path, "run", overwrite=True) as claim:
        assert {name: text for name, text in read(tmp_path).items() if name != LOCK} == OLD
        with claim.replacing():
            assert read(tmp_path / PREVIOUS) == OLD
            fill(tmp_path, NEW)
    assert read(tmp_path) == NEW
    assert not (tmp_path / PREVIOUS).exists()


def test_a_replacement_that_fails_puts_the_old_run_back(tmp_path: Path) -> None:
    fill(tmp_path, OLD)

    def fail() -> None:
        with FolderClaim(tmp_path, "run", overwrite=True) as claim, claim.replacing():
            (tmp_path / "trajectory.npz").write_text("new")
            raise RuntimeError("disk full")

    with pytest.raises(RuntimeError):
        fail()
    assert read(tmp_path) == OLD


def test_the_second_of_two_runs_is_refused_because_of_the_first(tmp_path: Path) -> None:
    folder = tmp_path / "r"
    for overwrite in (False, True):
        with (
            FolderClaim(folder, "run"),
            pytest.raises(OutputError, match=rf"another run \(process {os.getpid()}\) .*-o"),
        ):
            FolderClaim(folder, "run", overwrite=overwrite)
    assert not folder.exists(), "nothing was written"
    FolderClaim(folder, "run").close()


def test_the_lock_of_a_run_that_was_killed_holds_nobody_up(tmp_path: Path) -> None:
    code = (
        "import os, signal, sys\nfrom trundle.record.folder_claim import FolderClaim\n"
        "FolderClaim(sys.argv[1], 'run')\nos.kill(os.getpid(), signal.SIGKILL)\n"
    )
    done = subprocess.run([sys.executable, "-c", code, str(tmp_path)], check=False)
    assert done.returncode < 0
    assert [path.name for path in tmp_path.iterdir()] == [LOCK]
    with FolderClaim(tmp_path, "run"):
        assert (tmp_path / LOCK).read_text() == f"{os.getpid()}\n"
    assert list(tmp_path.iterdir()) == []


def test_a_file_system_without_locks_is_written_to_all_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> None:
        raise OSError(37, "No locks available")

    monkeypatch.setattr("fcntl.flock", refuse)
    with FolderClaim(tmp_path / "r", "run") as claim, claim.replacing():
        fill(claim.path, NEW)
    assert read(tmp_path / "r") == NEW


def test_a_new_folder_is_named_after_time_and_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with FolderClaim(None, "night shift/7") as first, FolderClaim(None, "night shift/7") as second:
        assert first.path != second.path
        assert first.path.parent == Path("runs")
        assert first.path.name.endswith("-night-shift-7")


@pytest.mark.parametrize(("out", "root"), [("file", "runs"), ("file/below", "runs"), (None, "file")])
def test_a_folder_that_cannot_be_written_is_said_with_the_option(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, out: str | None, root: str
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match=r"cannot write to the folder file.*-o"):
        FolderClaim(out, "x", root=root)
