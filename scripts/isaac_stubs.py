"""Write the type stubs of Isaac Sim under typings/ from the signatures that trundle keeps of it.

Run it after a change of src/trundle/sim/isaac/signatures.yaml: python scripts/isaac_stubs.py
"""

from __future__ import annotations

from pathlib import Path

from trundle.sim.isaac.signatures import ApiModule, read_signatures

ROOT = Path(__file__).parents[1] / "typings"

_HEAD = "# Made by scripts/isaac_stubs.py of src/trundle/sim/isaac/signatures.yaml: change that.\n"
_PRELUDE = """\
from collections.abc import Callable
from typing import Annotated, Any

import numpy as np
import numpy.typing as npt
"""


def make_stubs() -> dict[str, str]:
    """Return the text of every stub, by its path below typings/."""
    modules = {module.name: module for module in read_signatures()}
    packages = {name.rpartition(".")[0] for name in modules} | set(modules)
    for name in list(packages):
        while name:
            packages.add(name)
            name = name.rpartition(".")[0]
    packages.discard("")
    return {f"{name.replace('.', '/')}/__init__.pyi": _text(modules.get(name)) for name in sorted(packages)}


def _text(module: ApiModule | None) -> str:
    if module is None:
        return _HEAD
    imports = f"\n{module.imports}\n" if module.imports else ""
    return f"{_HEAD}{_PRELUDE}{imports}\n{module.text}"


def main() -> None:
    """Write them all."""
    for path, text in make_stubs().items():
        target = ROOT / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
