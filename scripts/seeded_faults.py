"""Plant each fault of tests/quick/faults.toml in a copy of this repository and say whether the quick tests find it.

python scripts/seeded_faults.py              all of them: up to the time of `make quick` for each
python scripts/seeded_faults.py --only 3 17  some, by number
"""

import argparse
import importlib.util
import shutil
import subprocess
import sys
import tempfile
import tomllib
import venv
from pathlib import Path

from trundle._core import _kernels

ROOT = Path(__file__).resolve().parents[1]
FAULTS = ROOT / "tests" / "quick" / "faults.toml"
CHOSEN = (ROOT / "tests" / "quick" / "files.txt").read_text(encoding="utf-8").split()
NEEDED = 30
LEFT_OUT = shutil.ignore_patterns(
    ".git", ".venv", "build", "runs", "node_modules", "site", ".hypothesis", ".pytest_cache"
)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", type=int, nargs="+", metavar="N", help="the numbers of the faults")
    given = parser.parse_args()
    faults = list(enumerate(tomllib.loads(FAULTS.read_text(encoding="utf-8"))["fault"], 1))
    chosen = [(number, fault) for number, fault in faults if given.only is None or number in given.only]
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "trundle"
        shutil.copytree(ROOT, copy, ignore=LEFT_OUT)
        python = make_environment(copy)
        if given.only is None and (found := run(copy, python, CHOSEN)):
            print(f"without a fault {found} fails already", file=sys.stderr)
            return 2
        count = 0
        for number, fault in chosen:
            found = plant(copy, python, fault)
            count += bool(found)
            print(f"{number:2} {fault['file']}: {fault['what']}: {found or 'NOT FOUND'}", flush=True)
    print(f"{count} of {len(chosen)} found")
    return 0 if given.only or count >= NEEDED else 1


def make_environment(copy: Path) -> Path:
    """Give a copy an environment that imports its sources, with the kernels and packages of this one; its Python."""
    kernels = Path(_kernels.__file__)
    shutil.copy(kernels, copy / "src" / "trundle" / "_core" / kernels.name)
    venv.create(copy / ".venv", symlinks=True)
    [packages] = (copy / ".venv" / "lib").glob("python*/site-packages")
    # As paths alone: the .pth files in them, with which an editable install finds its sources, are not read.
    paths = [copy / "src", *(path for path in sys.path if path.endswith("site-packages"))]
    (packages / "copy.pth").write_text("".join(f"{path}\n" for path in paths), encoding="utf-8")
    return copy / ".venv" / "bin" / "python"


def plant(copy: Path, python: Path, fault: dict[str, str]) -> str:
    """Run the quick tests with a fault, those of its package first; the first test that fails, or nothing."""
    file = copy / "src" / "trundle" / fault["file"]
    sound = file.read_text(encoding="utf-8")
    write_source(file, sound.replace(fault["old"], fault["new"], 1))
    package, _, inside = fault["file"].partition("/")
    beside = [
        chosen for chosen in CHOSEN if chosen.startswith(f"tests/{package}/" if inside else f"tests/test_{package}")
    ]
    try:
        return (run(copy, python, beside) if beside else "") or run(copy, python, CHOSEN)
    finally:
        write_source(file, sound)


def write_source(file: Path, text: str) -> None:
    """Write a source, and delete what was compiled of it: by second and size, Python may take that for up to date."""
    file.write_text(text, encoding="utf-8")
    Path(importlib.util.cache_from_source(str(file))).unlink(missing_ok=True)


def run(copy: Path, python: Path, tests: list[str]) -> str:
    """Run tests on the sources of a copy, until one fails; its name, or nothing."""
    workers = ["-n", "2", "--dist", "loadfile"] if tests is CHOSEN else []
    options = ["-x", "-q", *workers, "--timeout", "600", "--deselect", "tests/quick"]
    done = subprocess.run(
        [python, "-m", "pytest", *options, *tests], cwd=copy, capture_output=True, text=True, check=False
    )
    if done.returncode == 0:
        return ""
    lines = [line for line in done.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))]
    return lines[0].split(" - ")[0] if lines else (done.stdout + done.stderr).strip()[-300:]


if __name__ == "__main__":
    sys.exit(main())
