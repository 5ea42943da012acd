"""`scripts/size.py` counts what it says."""

import json
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CODE = '''"""A module."""

# why
def one(value):
    text = "# no comment"  # after code
    return getattr(value, "name", text)


class Some:
    def two(self, value):
        if isinstance(value, (str, Navigator)) or hasattr(value, "name"):
            return getattr(value, self.name)
        return isinstance(value, Path)
'''


def run(*arguments: str) -> dict:
    done = subprocess.run(
        [sys.executable, *arguments], cwd=ROOT, capture_output=True, text=True, check=True, timeout=300
    )
    return json.loads(done.stdout)


def test_a_file_is_counted(tmp_path):
    (tmp_path / "some.py").write_text(CODE)
    code = (
        "import json, sys; sys.path.insert(0, 'scripts'); import size; from pathlib import Path\n"
        f"file = size.read(Path({str(tmp_path / 'some.py')!r}))\n"
        "print(json.dumps([file.lines, file.comments, file.functions, file.names_in_text, file.checks_for_navigator]))"
    )
    assert run("-c", code) == [13, 1, [3, 4], 2, 1]


def test_the_whole_package_and_a_step_are_measured():
    figures = run("scripts/size.py", "--json")
    files = sum(package["files"] for package in figures["packages"].values())
    assert figures["files"] == files == len(list((ROOT / "src" / "trundle").rglob("*.py")))
    assert figures["step"]["depth"] > 1
    assert figures["step"]["functions"] >= figures["step"]["files"] > 5
