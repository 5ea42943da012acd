"""Missions between tight ends with `mppi` and `regulated_pure_pursuit`: of what one solves, how much does the other?

    python benchmarks/control/tight_ends.py --seeds 0:100
    python benchmarks/control/tight_ends.py --seeds 100:600 --map carter_warehouse_navigation.yaml --workers 16

The worlds are those of `trundle evaluate tight`, and the maps that are given. An episode takes about 0.4 s of CPU time
with either controller. The folder can be continued, and reported like any other evaluation.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from trundle.evaluation import Suite, evaluate

WORLDS = ("office", "warehouse", "lot")
TRIED, FOLLOWER = "mppi", "regulated_pure_pursuit"


def main() -> int:
    """Drive, and print what was solved; 1 if the share is below the aim."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", default="0:100", help="of each world, as 0:100")
    parser.add_argument("--map", action="append", default=[], help="another world: a ROS map; may be repeated")
    parser.add_argument("--workers", type=int, help="processes; one for each CPU if left out")
    parser.add_argument("--out", default="runs/tight_ends", help="folder to write into, or to continue")
    parser.add_argument("--aim", type=float, default=0.995, help=f"share of {FOLLOWER}'s that {TRIED} is to solve")
    options = parser.parse_args()
    worlds = [{"name": name, "seed": 3} for name in WORLDS] + [str(Path(path).resolve()) for path in options.map]
    suite = Suite.make(
        name="tight ends",
        worlds=worlds,
        controllers=[TRIED, FOLLOWER],
        missions={"seeds": options.seeds, "ends": "tight"},
    )
    evaluation = evaluate(suite, workers=options.workers, out=options.out)
    rows = {(row.mission, row.controller): row for row in evaluation.rows()}
    plannable = sorted({mission for mission, _ in rows if rows[mission, FOLLOWER].outcome != "no_path"})
    solved = {name: {m for m in plannable if rows[m, name].outcome == "arrived"} for name in (TRIED, FOLLOWER)}
    for mission in plannable:
        for name in (TRIED, FOLLOWER):
            row = rows[mission, name]
            if row.outcome != "arrived":
                print(f"{row.world} {row.seed} {name}: {row.message}, {row.behaviors or 'no recovery'} ({row.id[:12]})")
    for world in sorted({row.world for row in rows.values()}):
        here = {m for m in plannable if rows[m, FOLLOWER].world == world}
        counts = ", ".join(f"{name} {len(solved[name] & here)}" for name in (TRIED, FOLLOWER))
        print(f"{world}: {counts} of {len(here)} that are planned")
    both = len(solved[TRIED] & solved[FOLLOWER])
    ratio = len(solved[TRIED]) / max(1, len(solved[FOLLOWER]))
    touched = sum(row.outcome == "collided" for row in rows.values())
    cpu_s = sum(row.cpu_s or 0.0 for row in rows.values())
    print(f"all: {TRIED} {len(solved[TRIED])}, {FOLLOWER} {len(solved[FOLLOWER])}, both {both} of {len(plannable)}")
    print(f"contacts: {touched}; CPU time: {cpu_s:.0f} s; ratio: {ratio:.4f} (aim: {options.aim:g})")
    return int(ratio < options.aim)


if __name__ == "__main__":
    raise SystemExit(main())
