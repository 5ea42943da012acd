"""A disk that is full: every writer names the file and says what to do; the system refuses as a full disk does."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
from pathlib import Path

import pytest

from trundle.errors import OutputError
from trundle.files.writing import cannot_write, write_bytes

ROOM = 3000
"""Bytes that a file may have: fewer than each of those that are written here."""

LIMITED = """
import resource, sys
from trundle.cli.entry import main
resource.setrlimit(resource.RLIMIT_FSIZE, ({room}, {room}))
sys.argv[1:] = {arguments!r}
sys.exit(main())
"""


def limited(*arguments):
    """A command in a process whose files may not be larger than `ROOM`."""
    code = LIMITED.format(room=ROOM, arguments=list(arguments))
    return subprocess.run([sys.executable, "-B", "-c", code], capture_output=True, text=True, timeout=120, check=False)


@pytest.mark.parametrize(
    ("arguments", "file"),
    [
        (["run", "warehouse", "--seed", "3", "--backend", "kinematic", "--no-video", "-o"], "trajectory.npz"),
        (
            ["run", "warehouse", "--seed", "3", "--backend", "kinematic", "--no-video", "--record", "-o"],
            "run.partial.mcap",
        ),
        (["map", "build", "warehouse", "--seed", "3", "--resolution", "0.01", "-o"], "map.png"),
        (["export", "warehouse", "-o"], "world.usda"),
        (["export", "warehouse", "-o"], "world.glb"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_each_writer_names_the_file_and_what_to_do(arguments, file, tmp_path):
    out = tmp_path / ("run" if arguments[0] == "run" else file.replace(".png", ".yaml"))
    done = limited(*arguments, str(out))
    assert done.returncode == 2
    assert f"{file}: {os.strerror(errno.EFBIG)}; raise the limit on the size of files" in done.stderr
    assert "Traceback" not in done.stderr
    assert len(done.stderr) < 2000
    assert not [path for path in tmp_path.rglob("*") if path.name.startswith(".") and path.name != ".lock"]


@pytest.mark.parametrize(
    ("number", "advice"),
    [(errno.ENOSPC, "free space on that disk"), (errno.EDQUOT, "free space of yours"), (errno.EROFS, "another disk")],
)
def test_the_advice_is_that_of_the_error(number, advice):
    message = str(cannot_write("a/b.png", OSError(number, os.strerror(number))))
    assert message.startswith(f"cannot write a/b.png: {os.strerror(number)}; ")
    assert advice in message


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="only Linux has a device that is always full")
def test_the_output_of_a_command_is_named_too():
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "trundle", "robot", "schema"],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            timeout=120,
            check=False,
        )
    assert done.returncode == 2
    assert "cannot write the output: No space left on device; free space on that disk" in done.stderr


def test_a_file_that_there_is_stays_as_it_was(tmp_path, monkeypatch):
    file = tmp_path / "a.bin"
    file.write_bytes(b"old")

    def fail(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr("pathlib.Path.write_bytes", fail)
    with pytest.raises(OutputError, match=r"a\.bin: No space left on device; free space"):
        write_bytes(file, b"new")
    assert file.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [file]
