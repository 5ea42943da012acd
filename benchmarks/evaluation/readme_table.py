"""The tables of benchmarks/README.md: python benchmarks/evaluation/readme_table.py runs/planners runs/…

They were made from the evaluations of these commands:

    trundle evaluate benchmarks/evaluation/planners.yaml -o runs/planners
    trundle evaluate benchmarks/evaluation/controllers.yaml -o runs/controllers
    trundle evaluate smoke -o runs/smoke
    trundle evaluate tight -o runs/tight
    trundle evaluate warehouses -o runs/warehouses

Each folder becomes a table with a row for each combination of planner, controller, backend and settings, over all its
worlds. SPL is the mean over all episodes, those that failed with 0; time and clearance are medians over those that
arrived.
"""

import argparse
from collections.abc import Sequence

import numpy as np

from trundle.evaluation import Evaluation
from trundle.evaluation.report.summary import count_outcomes
from trundle.evaluation.statistics import wilson
from trundle.evaluation.statistics.figures import BY_NAME, write_number, write_share
from trundle.evaluation.statistics.table import VARIANT, Group, Table, group_rows

COLUMNS = ("episodes", "arrived (95 %)", "did not arrive", "SPL", "time", "clearance", "planning")


def parse_arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", help="folders of finished evaluations")
    return parser.parse_args()


def write_arrived(successes: int, episodes: int) -> str:
    """A share and its interval: `98.5 % (97.2 to 99.2)`."""
    low, high = wilson(successes, episodes)
    return f"{write_share(successes / episodes, episodes)} ({100.0 * low:.1f} to {100.0 * high:.1f})"


def write_outcomes(table: Table, group: Group) -> str:
    counts = count_outcomes(table, group.rows)
    return ", ".join(f"{count} {name}" for name, count in counts.items() if name != "arrived")


def write_mean(table: Table, group: Group, name: str, reduce=np.nanmedian) -> str:
    """A figure with its unit, over the rows that have it."""
    figure = BY_NAME[name]
    values = figure.values(table)[group.rows]
    if np.isnan(values).all():
        return "–"
    return f"{write_number(float(reduce(values)))} {figure.unit}".rstrip()


def row_of(table: Table, group: Group, labels: Sequence[str]) -> list[str]:
    rows = group.rows
    return [
        *(f"`{group.labels[label]}`" for label in labels),
        f"{len(rows):,}",
        write_arrived(int(table.arrived[rows].sum()), len(rows)),
        write_outcomes(table, group),
        write_mean(table, group, "spl", np.nanmean),
        write_mean(table, group, "time_s"),
        write_mean(table, group, "min_clearance_m"),
        write_mean(table, group, "planning_ms"),
    ]


def table_lines(evaluation: Evaluation) -> list[str]:
    """The table of one evaluation, in Markdown; labels that all rows share are left out, but for the planner."""
    table = evaluation.table
    labels = [name for name in VARIANT if name == "planner" or len(table.named[name].names) > 1]
    lines = [[*labels, *COLUMNS], ["---"] * (len(labels) + len(COLUMNS))]
    lines += [row_of(table, group, labels) for group in group_rows(table, VARIANT)]
    return [f"| {' | '.join(line)} |" for line in lines]


def main() -> None:
    for folder in parse_arguments().folders:
        evaluation = Evaluation(folder)
        if not evaluation.is_complete:
            raise SystemExit(f"{folder} is not finished: {len(evaluation)} of {evaluation.results.total} episodes")
        print(f"{evaluation.results.name}\n", *table_lines(evaluation), "", sep="\n")


if __name__ == "__main__":
    main()
