"""Ctrl-C ends the export to USD, also while USD is imported, which drops what Python raises in it."""

from __future__ import annotations

import signal
import subprocess
import sys

import pytest

# Sends itself the signal from inside the import, at each of many places, one run for each.
SCRIPT = """
import os, signal, sys
place, seen = {place}, 0
class Finder:
    def find_spec(self, name, path=None, target=None):
        global seen
        seen += name.startswith("pxr")
        if seen == place:
            seen += 1
            os.kill(os.getpid(), signal.SIGINT)
        return None
sys.meta_path.insert(0, Finder())
from trundle.cli import main
main(["export", "maze", "--to", "usd", "-o", {target!r}])
"""


@pytest.mark.parametrize("place", [1, 4, 8, 12])
def test_ctrl_c_during_the_import_ends_the_export(tmp_path, place):
    target = tmp_path / "maze.usd"
    script = SCRIPT.format(place=place, target=str(target))
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, timeout=120, text=True)
    assert (done.returncode, done.stderr.strip()) == (128 + signal.SIGINT, "interrupted")
    assert not target.exists()
