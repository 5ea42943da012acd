"""Without the extra, the import says how to install it."""

import importlib.util
import subprocess
import sys

import pytest


def test_without_gymnasium_the_import_gives_the_install_line():
    code = "import sys; sys.modules['gymnasium'] = None; import trundle.gym"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode != 0
    last = done.stderr.strip().splitlines()[-1]
    assert "MissingExtraError" in last
    assert "[gym]" in last


@pytest.mark.skipif(importlib.util.find_spec("gymnasium") is None, reason="needs Gymnasium, of the extra gym")
def test_the_import_registers_the_environments():
    code = "import gymnasium, trundle.gym; print('trundle/Navigation-v0' in gymnasium.registry)"
    done = subprocess.run([sys.executable, "-W", "error", "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "True"
