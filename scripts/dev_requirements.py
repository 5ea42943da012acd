"""Print the development requirements of pyproject.toml, for an installer's command line."""

import tomllib
from pathlib import Path

if __name__ == "__main__":
    project = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text())
    print(" ".join(requirement.replace(" ", "") for requirement in project["dependency-groups"]["dev"]))
