"""The figures of sensing, from folders of evaluations: python -m benchmarks.sensing.report runs/boxes runs/…

An episode whose start and goal no path joins cannot arrive. So for each one that did not, `least_cost` plans on the
costmap of the world as it is, boxes included; those without a path are counted apart. The other contacts are told from
those with obstacles that no lidar sees, and from those of movers that run into a robot that stands.
"""

import argparse
from collections import Counter

from benchmarks.timing import print_table

from trundle.costmap import Costmap
from trundle.errors import PlanningError
from trundle.evaluation import Evaluation
from trundle.evaluation.row import Row
from trundle.evaluation.statistics import wilson
from trundle.maps import OccupancyGrid
from trundle.mission import Scenario
from trundle.mission.scenario import Setting
from trundle.planning import create_planner


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", help="folders of finished evaluations")
    parser.add_argument("--failed", action="store_true", help="list the episodes that did not arrive")
    options = parser.parse_args()
    lines = []
    for folder in options.folders:
        evaluation = Evaluation(folder)
        rows: dict[str, list[Row]] = {}
        for row in evaluation.rows():
            rows.setdefault(row.settings, []).append(row)
        for settings, group in rows.items():
            lines.append((folder, settings, *describe(evaluation, group, listed=options.failed)))
    header = (
        "evaluation",
        "settings",
        "episodes",
        "no path",
        "arrived",
        "95 %",
        "contacts",
        "standing",
        "unseen",
        "others",
    )
    print_table(header, [tuple(map(str, line)) for line in lines])


def describe(evaluation: Evaluation, rows: list[Row], *, listed: bool) -> tuple[object, ...]:
    """Figures of the episodes of one combination of settings."""
    failed = [row for row in rows if row.outcome not in ("arrived", "arrived_by_estimate")]
    without = {row.id for row in failed if not has_path(evaluation.scenario_of(row.id))}
    count, arrived = len(rows) - len(without), len(rows) - len(failed)
    low, high = wilson(arrived, count)
    for row in failed if listed else ():
        mark = "no path" if row.id in without else row.outcome
        print(f"{row.id} {row.world} seed {row.seed}: {mark}: {row.message}")
    others = Counter(row.outcome for row in rows if row.outcome != "arrived" and row.id not in without)
    return (
        len(rows),
        len(without),
        f"{100.0 * arrived / count:.1f} %",
        f"{100.0 * low:.1f} to {100.0 * high:.1f}",
        sum(bool(row.contacts) for row in rows),
        sum(bool(row.standing_contacts) for row in rows),
        sum(bool(row.unseen_contacts) for row in rows),
        ", ".join(f"{number} {name}" for name, number in others.items()) or "none",
    )


def has_path(scenario: Scenario) -> bool:
    """Whether `least_cost` finds a path through the world as it is."""
    setting = scenario.prepare()
    costmap = true_costmap(setting)
    start = setting.start
    try:
        for goal in setting.goals:
            create_planner("least_cost").plan(costmap, start, goal)
            start = goal.pose
    except PlanningError:
        return False
    return True


def true_costmap(setting: Setting) -> Costmap:
    """The costmap of the world as it is, with what is not on the map, for the robot's true outline."""
    seen = OccupancyGrid.from_world(
        setting.world,
        resolution=setting.scenario.resolution,
        z_range=setting.robot.z_range,
        seeds=[setting.start.as_tuple()[:2]],
    )
    return Costmap.from_grid(seen, setting.robot)


if __name__ == "__main__":
    main()
