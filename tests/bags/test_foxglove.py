"""`npm install` in benchmarks/recording/foxglove gives what these tests need."""

import shutil
import subprocess
from pathlib import Path

import pytest

from trundle.bags import Recorder, recover
from trundle.messages.codec import DISTROS

READER = Path(__file__).parents[2] / "benchmarks/recording/foxglove"


@pytest.mark.skipif(
    shutil.which("node") is None or not (READER / "node_modules").is_dir(),
    reason="needs Node.js and npm install in benchmarks/recording/foxglove",
)
def test_mcap_core_with_foxgloves_decoder_reads_every_message(recorded, partial, tmp_path):
    files = [recorded.path, recover(partial).path]
    for distro in DISTROS:
        files.append(tmp_path / f"{distro}.mcap")
        recorder = Recorder(files[-1], distro=distro)
        recorder.on_start(recorded.info)
        for step in recorded.steps[:40]:
            recorder.on_step(step)
        recorder.on_end(recorded.episode)
    done = subprocess.run(
        ["node", "read.mjs", *map(str, files)], cwd=READER, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert len(done.stdout.splitlines()) == len(files)
