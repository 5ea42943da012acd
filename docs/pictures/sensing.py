"""Make unknown.png and people.png: the pictures of the examples 07 and 08.

python docs/pictures/sensing.py FOLDER
"""

from __future__ import annotations

import os
import runpy
import sys
import tempfile
from pathlib import Path

from PIL import Image

EXAMPLES = Path(__file__).parents[2] / "examples"
WIDTH = 900


def main() -> None:
    folder = Path(sys.argv[1]).absolute()
    for example, name in (("07_unknown_warehouse", "unknown.png"), ("08_people", "people.png")):
        with tempfile.TemporaryDirectory() as empty:
            os.chdir(empty)
            try:
                runpy.run_path(str(EXAMPLES / f"{example}.py"), run_name="__main__")
            except SystemExit as end:
                if end.code:
                    raise
            picture = Image.open(name).convert("RGB")
            small = picture.resize((WIDTH, round(WIDTH * picture.height / picture.width)), Image.Resampling.LANCZOS)
            small.quantize(128).save(folder / name, optimize=True)
            os.chdir(folder)


if __name__ == "__main__":
    main()
