"""The kernels' README names every kernel, file and caller, and nothing that is not there."""

from __future__ import annotations

import ast
import re
from pathlib import Path

from support.kernel_calls import KERNELS

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "src/trundle"
CORE = PACKAGE / "_core"


def rows() -> list[list[str]]:
    """The rows of the table of kernels, cell by cell."""
    lines = (CORE / "README.md").read_text().splitlines()
    table = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if line.startswith("|")]
    return [cells for cells in table if len(cells) == 5][2:]


def quoted(text: str) -> list[str]:
    return re.findall(r"`([^`]+)`", text)


def kernels_of(row: list[str]) -> list[str]:
    return quoted(row[0].split(":")[0])


def files_of(text: str) -> set[str]:
    """Files of a cell, each after a link to its folder."""
    found = set()
    for folder, names in re.findall(r"\]\((\w+)/\):([^;]*)", text):
        found |= {f"{folder}/{name}" for name in quoted(names)}
    return found


def callers() -> dict[str, set[str]]:
    """The packages that use each kernel."""
    found: dict[str, set[str]] = {name: set() for name in KERNELS}
    for path in PACKAGE.rglob("*.py"):
        package = path.relative_to(PACKAGE).parts[0].removesuffix(".py")
        if package == "_core":
            continue
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom) and node.module == "trundle._core":
                for alias in node.names:
                    if alias.name != "_kernels":  # the compiled module as a file, not a kernel
                        found[alias.name].add(package)
            elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "_core":
                found[node.attr].add(package)
    return found


def test_every_kernel_has_a_row():
    assert sorted(name for row in rows() for name in kernels_of(row)) == sorted(KERNELS)


def test_each_row_names_the_packages_that_call_its_kernels():
    used = callers()
    listed = {tuple(kernels_of(row)): set(quoted(row[1])) for row in rows()}
    assert listed == {names: set().union(*(used[name] for name in names)) for names in listed}


def test_every_file_is_named_once():
    text = (CORE / "README.md").read_text()
    shared = re.findall(r"^\| `(\w+\.hpp)` \|", text, re.MULTILINE)
    named = [name for row in rows() for name in files_of(row[3])] + [f"shared/{name}" for name in shared]
    there = [path.relative_to(CORE).as_posix() for path in CORE.glob("*/*.?pp")]
    ours = [name for name in there if Path(name).name not in ("bindings.cpp", "kernels.hpp")]
    assert sorted(named) == sorted(ours)


def test_every_folder_of_kernels_has_its_binding_file():
    folders = {path.parent for path in CORE.glob("*/*.?pp")} - {CORE / "shared"}
    assert [folder.name for folder in sorted(folders) if not (folder / "bindings.cpp").is_file()] == []
    bound = re.findall(r"^  bind_(\w+)\(m\);", (CORE / "bindings.cpp").read_text(), re.MULTILINE)
    assert sorted(bound) == sorted(folder.name for folder in folders)


def test_every_row_names_a_source_and_a_test_that_is_there():
    for row in rows():
        oracles = re.findall(r"\]\(([^)]+\.py)\)", row[4])
        assert row[2]
        assert oracles
        assert [path for path in oracles if not (CORE / path).is_file()] == []


def test_every_link_leads_somewhere():
    links = re.findall(r"\]\(([^)#]+)\)", (CORE / "README.md").read_text())
    assert [link for link in links if not (CORE / link).exists()] == []
