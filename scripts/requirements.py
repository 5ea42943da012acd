"""Print requirements of pyproject.toml: `build`, `demo` (with videos), `dev`, `ray`, `learning`, `physx`, `docs`."""

import sys
import tomllib
from pathlib import Path


def requirements(purpose: str) -> list[str]:
    """Requirements of a purpose, without blanks."""
    project = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text())
    lists = {
        # What an isolated build environment would install; with them in ours, a rebuild compiles only what changed.
        "build": [*project["build-system"]["requires"], "cmake>=3.18", "ninja>=1.10"],
        "demo": [*project["project"]["dependencies"], *project["project"]["optional-dependencies"]["video"]],
        **project["dependency-groups"],
    }
    return [requirement.replace(" ", "") for requirement in lists[purpose]]


if __name__ == "__main__":
    print(" ".join(line for purpose in sys.argv[1:] for line in requirements(purpose)))
