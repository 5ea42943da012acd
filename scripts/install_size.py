"""Measure a plain `pip install` of trundle: install_size.py WHEEL [--python PYTHON] [--at-most MB].

Installs the wheel with its requirements into an empty environment and adds up the files that pip lists for each
distribution, compiled Python included. pip itself, and setuptools where venv brings it, do not count.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from importlib import metadata
from pathlib import Path

_NOT_OURS = {"pip", "setuptools"}


def sizes(packages: Path) -> dict[str, int]:
    """Bytes of each distribution in a folder of packages, the largest first; a file of two counts once."""
    counted: set[Path] = set()
    found: dict[str, int] = {}
    for distribution in metadata.distributions(path=[str(packages)]):
        if distribution.name in _NOT_OURS:
            continue
        files = {Path(str(file.locate())) for file in distribution.files or []}
        found[distribution.name] = sum(path.stat().st_size for path in files - counted if path.is_file())
        counted |= files
    return dict(sorted(found.items(), key=lambda item: -item[1]))


def main() -> int:
    """Print a table in MB (10^6 bytes); 1 where the sum is above the limit."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("wheel", type=Path)
    parser.add_argument("--python", default=sys.executable)
    parser.add_argument("--at-most", type=float, default=220.0, metavar="MB")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([options.python, "-m", "venv", folder], check=True)
        constraints = Path(__file__).parents[1] / "constraints.txt"
        install = [f"{folder}/bin/python", "-m", "pip", "install", "--quiet", "-c", str(constraints)]
        subprocess.run([*install, str(options.wheel.resolve())], check=True)
        found = sizes(next(Path(folder).glob("lib/python3.*/site-packages")))
    for name, size in found.items():
        print(f"{size / 1e6:8.1f}  {name}")
    total = sum(found.values()) / 1e6
    print(f"{total:8.1f}  sum, at most {options.at_most:g}")
    return 0 if total <= options.at_most else 1


if __name__ == "__main__":
    sys.exit(main())
