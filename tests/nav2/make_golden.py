"""Write the expected export of tests/nav2/golden again, after a change on purpose.

python -m tests.nav2.make_golden
"""

import tempfile
from pathlib import Path

from trundle.mission import Scenario
from trundle.nav2 import export_nav2

GOLDEN = Path(__file__).parent / "golden"
SCENARIO = {
    "world": {"name": "corridors", "seed": 1},
    "robot": "turtlebot3_waffle",
    "start": (1.0, 2.0, 0.5),
    "lidar": True,
    "planner": {"name": "hybrid_astar", "options": {"motion_model": "dubins", "padding": 0.03}},
    "smoother": "constrained",
    "movers": [{"crowd": "person", "count": 2}],
    "replan_margin": 0.2,
}
"""A scenario with settings of which Nav2 has some."""

TEXTS = ("nav2_params.yaml", "nav2.launch.py", "no_counterpart.txt", "map.yaml")

if __name__ == "__main__":
    GOLDEN.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        export_nav2(Scenario.make(**SCENARIO), folder, distro="jazzy")
        for name in TEXTS:
            (GOLDEN / name).write_text((Path(folder) / name).read_text(encoding="utf-8"), encoding="utf-8")
