"""Make planners.png: one query under each planner, in the built-in warehouse.

python docs/pictures/planners.py
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from trundle.cli.entry import run_command

QUERY = ["--start=-13,0", "--goal", "13,4.0,1.57", "--compare"]


def main() -> int:
    """Build the map, and compare on it."""
    picture = Path(__file__).parents[1] / "images" / "planners.png"
    with tempfile.TemporaryDirectory() as folder:
        made = run_command(["map", "build", "warehouse", "--seed", "7", "-o", f"{folder}/map.yaml", "--json"])
        return made or run_command(["plan", f"{folder}/map.yaml", *QUERY, "-o", str(picture)])


if __name__ == "__main__":
    sys.exit(main())
