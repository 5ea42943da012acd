import random
import subprocess
import sys
from pathlib import Path

import pytest

from trundle.bags import recover

LOST_S = 1.2


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_killed_recording_has_all_but_the_last_second_of_the_run(seed, tmp_path):
    target = tmp_path / "run.mcap"
    script = Path(__file__).with_name("killed_writer.py")
    steps = random.Random(seed).randint(30, 150)
    with subprocess.Popen(
        [sys.executable, str(script), str(target), "20"], stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        for _ in range(steps):
            last = float(process.stdout.readline())
        process.kill()
    assert not target.exists()
    done = recover(tmp_path / "run.partial.mcap")
    assert done.path == target
    assert done.end_s >= last - LOST_S


def test_a_run_that_is_killed_while_its_recording_begins_leaves_no_empty_file(tmp_path):
    script = Path(__file__).with_name("killed_writer.py")
    target = tmp_path / "run.mcap"
    with subprocess.Popen([sys.executable, str(script), str(target), "20"], stdout=subprocess.DEVNULL) as process:
        while not any(tmp_path.iterdir()):
            assert process.poll() is None
        process.kill()
    left = tmp_path / "run.partial.mcap"
    assert not left.exists() or recover(left).messages > 0
