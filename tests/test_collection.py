"""What a run of tests costs before its first test."""

import os
import sys
from pathlib import Path


def test_compiled_tests_are_kept_for_the_next_run():
    assert not sys.dont_write_bytecode
    assert "PYTHONDONTWRITEBYTECODE" not in os.environ
    assert list(Path(__file__).parent.glob(f"__pycache__/{Path(__file__).stem}.*-pytest-*.pyc"))
