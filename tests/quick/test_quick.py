"""What `make quick` runs, and the faults that it is judged by."""

import ast
import functools
import re
import tomllib
from pathlib import Path

import pytest

from trundle.cli.entry import VERBS

TESTS = Path(__file__).parents[1]
SRC = TESTS.parent / "src" / "trundle"
CHOSEN = (TESTS / "quick" / "files.txt").read_text(encoding="utf-8").split()
FAULTS = tomllib.loads((TESTS / "quick" / "faults.toml").read_text(encoding="utf-8"))["fault"]


@functools.cache
def parts() -> list[tuple[Path, ast.AST]]:
    """Each chosen file, or the one test of it that is chosen."""
    found: list[tuple[Path, ast.AST]] = []
    for chosen in CHOSEN:
        name, _, test = chosen.partition("::")
        tree = ast.parse((TESTS.parent / name).read_text(encoding="utf-8"))
        functions = {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef)}
        found.append((Path(name), functions[test] if test else tree))
    return found


def test_what_is_chosen_exists_and_stands_there_once() -> None:
    assert len(parts()) == len(set(CHOSEN)) == len(CHOSEN)


def test_every_package_is_touched() -> None:
    packages = {path.parent.name for path in SRC.glob("*/__init__.py")}
    touched = {path.parts[1] for path, _ in parts()}
    for path, _ in parts():
        text = (TESTS.parent / path).read_text(encoding="utf-8")
        touched.update(re.findall(r"^from trundle\.(\w+)", text, flags=re.MULTILINE))
    assert sorted(packages - touched) == []


def test_every_verb_is_run() -> None:
    said = set()
    for path, tree in parts():
        for node in ast.walk(tree) if path.parts[1] == "cli" else ():
            words = node.args if isinstance(node, ast.Call) else node.elts if isinstance(node, ast.List) else ()
            said.update(word.value for word in words if isinstance(word, ast.Constant))
    assert sorted(set(VERBS) - said) == []


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault["file"])
def test_a_fault_can_be_planted_where_it_was(fault: dict[str, str]) -> None:
    assert (SRC / fault["file"]).read_text(encoding="utf-8").count(fault["old"]) == 1
    assert fault["new"] != fault["old"]


def test_there_are_forty_faults() -> None:
    assert len(FAULTS) == 40
