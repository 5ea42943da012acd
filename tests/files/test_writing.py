import os
import stat

import pytest

from trundle.errors import OutputError
from trundle.files.writing import atomic_path, make_folder, write_text


def test_a_file_is_there_whole_or_not_at_all(tmp_path):
    target = tmp_path / "a.txt"
    write_text(target, "old")

    def write_and_break() -> None:
        with atomic_path(target) as temporary:
            temporary.write_text("half")
            raise RuntimeError("power cut")

    with pytest.raises(RuntimeError, match="power cut"):
        write_and_break()
    assert target.read_text() == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["a.txt"]


def test_a_written_file_can_be_read_by_others(tmp_path):
    write_text(tmp_path / "a.txt", "x")
    mask = os.umask(0)
    os.umask(mask)
    assert stat.S_IMODE((tmp_path / "a.txt").stat().st_mode) == 0o666 & ~mask


def test_a_file_that_is_replaced_keeps_its_permissions(tmp_path):
    target = tmp_path / "a.txt"
    target.write_text("old")
    target.chmod(0o640)
    write_text(target, "new")
    assert target.read_text() == "new"
    assert stat.S_IMODE(target.stat().st_mode) == 0o640


def test_a_durable_file_is_on_the_disk_before_its_name_and_then_its_name(tmp_path, monkeypatch):
    steps = []
    replace, sync = os.replace, os.fsync

    def note_sync(descriptor):
        steps.append("folder" if stat.S_ISDIR(os.fstat(descriptor).st_mode) else "file")
        sync(descriptor)

    def note_rename(*names, **options):
        steps.append("rename")
        replace(*names, **options)

    monkeypatch.setattr(os, "fsync", note_sync)
    monkeypatch.setattr(os, "replace", note_rename)
    write_text(tmp_path / "a.txt", "x", durable=True)
    assert steps == ["file", "rename", "folder"]
    steps.clear()
    write_text(tmp_path / "b.txt", "x")
    assert steps == ["rename"]


def test_a_folder_that_is_missing_is_named(tmp_path):
    with pytest.raises(OutputError, match=r"cannot write .*nowhere.*a\.txt: No such file"):
        write_text(tmp_path / "nowhere" / "a.txt", "x")


def test_a_folder_cannot_be_made_where_a_file_stands(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="cannot write to the folder"):
        make_folder(tmp_path / "file" / "below")
