"""Print how large the code of src is, and how much of it one step of a run goes through.

python scripts/size.py          tables
python scripts/size.py --json   one JSON value

Lines are those of Python files; comments and docstrings count as lines, and comments are counted apart. The step is one
of a mission on the kinematic simulator without a lidar, by pure pursuit: the median of 40 control periods. What is
planned in between is no part of it.
"""

from __future__ import annotations

import argparse
import ast
import io
import json
import statistics
import sys
import tokenize
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import FrameType
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
SOURCE = ROOT / "src" / "trundle"
SEAMS = ("mission", "navigation", "sim", "control")
"""Where no capability may go by a name that no protocol has."""

STEPS = 40
LONG_FILE, SHORT_FUNCTION = 400, 3


@dataclass(frozen=True)
class File:
    """What one file has: lines in all, lines with a comment alone, the lengths of its functions, informal seams."""

    path: Path
    lines: int
    comments: int
    functions: tuple[int, ...]
    names_in_text: int
    checks_for_navigator: int

    @property
    def package(self) -> str:
        parts = self.path.relative_to(SOURCE).parts
        return parts[0] if len(parts) > 1 else "."


def read(path: Path) -> File:
    """Read one file of Python."""
    text = path.read_text(encoding="utf-8")
    tokens = tokenize.generate_tokens(io.StringIO(text).readline)
    comments = sum(token.type == tokenize.COMMENT and not token.line[: token.start[1]].strip() for token in tokens)
    nodes = list(ast.walk(ast.parse(text)))
    functions = [node for node in nodes if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)]
    calls = [node for node in nodes if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)]
    return File(
        path,
        text.count("\n"),
        comments,
        tuple((node.end_lineno or node.lineno) - node.lineno + 1 for node in functions),
        sum(names_text(call) for call in calls),
        sum(asks_for(call, "Navigator") for call in calls),
    )


def names_text(call: ast.Call) -> bool:
    """Whether a call is `getattr(x, "name")` or `hasattr(x, "name")`."""
    return called(call) in ("getattr", "hasattr") and len(call.args) > 1 and isinstance(call.args[1], ast.Constant)


def asks_for(call: ast.Call, kind: str) -> bool:
    """Whether a call is `isinstance(x, kind)`, alone or in a tuple or a union."""
    if called(call) != "isinstance" or len(call.args) != 2:
        return False
    return any(isinstance(node, ast.Name) and node.id == kind for node in ast.walk(call.args[1]))


def called(call: ast.Call) -> str:
    return call.func.id if isinstance(call.func, ast.Name) else ""


def measure_step() -> dict[str, float]:
    """Files and functions that a step goes through, and how deep: medians."""
    from trundle.mission import Scenario

    scenario = Scenario.make(world="warehouse", backend="kinematic", controller="regulated_pure_pursuit", seed=1)
    steps: list[tuple[int, int, int]] = []
    with scenario.build() as mission:
        session = mission.session()
        for _ in range(STEPS // 2):  # the first ones import and plan
            session.step()
        while len(steps) < STEPS and session.outcome is None:
            steps.append(traced(session.step))
    files, functions, depth = (statistics.median(values) for values in zip(*steps, strict=True))
    return {"files": files, "functions": functions, "depth": depth}


def traced(call: Any) -> tuple[int, int, int]:
    """How many files and functions of trundle a call goes through, and how many of them stand in one another."""
    files: set[str] = set()
    functions: set[tuple[str, int]] = set()
    depth = deepest = 0

    def follow(frame: FrameType, event: str, _: object) -> None:
        nonlocal depth, deepest
        code = frame.f_code
        if event not in ("call", "return") or not code.co_filename.startswith(str(SOURCE)):
            return
        depth += 1 if event == "call" else -1
        deepest = max(deepest, depth)
        files.add(code.co_filename)
        functions.add((code.co_filename, code.co_firstlineno))

    sys.setprofile(follow)
    try:
        call()
    finally:
        sys.setprofile(None)
    return len(files), len(functions), deepest


def summarise(files: list[File]) -> dict[str, Any]:
    """The figures of all files together, and by package."""
    packages: dict[str, dict[str, int]] = {}
    for file in files:
        package = packages.setdefault(file.package, {"files": 0, "lines": 0})
        package["files"] += 1
        package["lines"] += file.lines
    lengths = [length for file in files for length in file.functions]
    lines, comments = sum(file.lines for file in files), sum(file.comments for file in files)
    seams = [file for file in files if file.package in SEAMS]
    smallest = sorted(files, key=lambda file: file.lines)
    return {
        "files": len(files),
        "lines": lines,
        "lines_without_comments": lines - comments,
        "comment_share": comments / lines,
        "median_file": statistics.median(file.lines for file in files),
        "smallest_150_lines": sum(file.lines for file in smallest[:150]),
        "long_files": {str(file.path.relative_to(SOURCE)): file.lines for file in files if file.lines > LONG_FILE},
        "functions": len(lengths),
        "median_function": statistics.median(lengths),
        "short_functions": sum(length <= SHORT_FUNCTION for length in lengths),
        "root_modules": packages["."]["files"],
        "names_in_text": sum(file.names_in_text for file in seams),
        "checks_for_navigator": sum(file.checks_for_navigator for file in seams),
        "packages": dict(sorted(packages.items(), key=lambda item: -item[1]["lines"])),
    }


def table(figures: dict[str, Any]) -> Iterator[str]:
    """The figures for people."""
    step = figures["step"]
    long_files = ", ".join(f"{name} ({lines})" for name, lines in figures["long_files"].items())
    rows = {
        "Python files": f"{figures['files']}, median {figures['median_file']:.0f} lines",
        "lines": f"{figures['lines']:,}, {figures['lines_without_comments']:,} without comments",
        "comment lines": f"{100.0 * figures['comment_share']:.1f} %",
        "functions": (
            f"{figures['functions']:,}, median {figures['median_function']:.0f} lines, "
            f"{figures['short_functions']:,} of at most {SHORT_FUNCTION}"
        ),
        "the 150 smallest files": f"{figures['smallest_150_lines']:,} lines",
        f"files over {LONG_FILE} lines": long_files or "none",
        "modules at the root": str(figures["root_modules"]),
        f"getattr and hasattr with a literal name in {', '.join(SEAMS)}": str(figures["names_in_text"]),
        "isinstance(…, Navigator) there": str(figures["checks_for_navigator"]),
        "a step without a lidar": (
            f"{step['files']:.0f} files, {step['functions']:.0f} functions, {step['depth']:.0f} deep"
        ),
    }
    for name, text in rows.items():
        yield f"{name}: {text}"
    yield ""
    for name, package in figures["packages"].items():
        yield f"{name:<14} {package['files']:>4} files {package['lines']:>7,} lines"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", action="store_true", help="one JSON value")
    given = parser.parse_args()
    figures = {**summarise([read(path) for path in sorted(SOURCE.rglob("*.py"))]), "step": measure_step()}
    print(json.dumps(figures, indent=2) if given.json else "\n".join(table(figures)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
