"""The compiled kernels load where glibc is 2.35 (Ubuntu 22.04, Isaac Sim's wheels), beside another libstdc++."""

import re
import shutil
import subprocess
import sys

import pytest

from trundle._core import _kernels


def read_elf(*options: str) -> str:
    tool = shutil.which("readelf")
    if sys.platform != "linux" or tool is None:
        pytest.skip("no readelf: it comes with the compiler on Linux")
    done = subprocess.run([tool, *options, _kernels.__file__], capture_output=True, text=True, check=True)
    return done.stdout


def test_no_symbol_is_newer_than_glibc_2_35() -> None:
    needed = {
        tuple(map(int, found)) for found in re.findall(r"\bGLIBC_(\d+)\.(\d+)", read_elf("--version-info", "--wide"))
    }
    assert needed
    assert max(needed) <= (2, 35)


def test_libstdcxx_is_linked_dynamically() -> None:
    assert "[libstdc++.so.6]" in read_elf("--dynamic", "--wide")
