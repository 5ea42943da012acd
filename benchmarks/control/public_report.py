"""The section "BARN and DynaBARN" of RESULTS.md, from the folders that trundle evaluate barn and dynabarn wrote:

    python -m benchmarks.control.public_report runs/barn runs/barn_late runs/dynabarn
    python -m benchmarks.control.public_report --print runs/barn

Each folder gives a line of figures for each combination of robot, planner and controller, and a line for each failure
with the command that runs it again.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from trundle.evaluation import Evaluation
from trundle.evaluation.public.conditions import ARRIVAL_RADIUS
from trundle.evaluation.public.reference import ReferencePath
from trundle.evaluation.row import Row
from trundle.evaluation.statistics import wilson
from trundle.robots import Robot
from trundle.worlds.dynabarn import LEVELS

PAGE = Path(__file__).parent / "RESULTS.md"
BEGIN, END = "<!-- public benchmarks: begin -->", "<!-- public benchmarks: end -->"
_VERSIONS = ("trundle", "commit", "mujoco", "numpy")
_PLACES = {"barn": "BARN", "dynabarn": "worlds.json"}
_ENDS = {"barn": ((-2.25, 3.0), (-2.25, 13.0)), "dynabarn": ((11.0, 0.0), (-9.0, 0.0))}

INTRODUCTION = """## BARN and DynaBARN

These are runs of trundle in its own engine on the public worlds. They are no entries of a competition: the BARN
Challenge runs in Gazebo, on worlds that are not public, on a Jackal that skids, and every team on the same machine.

- **What the robot knew**: its scans and its odometry, no map. With drift, the odometry has random errors of 5 mm and
  5 mrad per √m, which nothing corrects; without, the robot gets its true pose. Start and goal are given.
- **Which engine**: MuJoCo unless the command says otherwise; 20 commands a second; one thread for each run.
- **Which robot**: `jackal` of the catalogue, 0.43 × 0.508 m, with two driven wheels and without skid; 3 m/s² and
  4 rad/s; 2 m/s unless the command says otherwise, and as fast backwards. Its lidar is BARN's: 270°, 720 beams, of
  which 10 m are used, 20 times a second; noise of 1 cm.
- **Rules**: those of the BARN Challenge. A run succeeds when the robot is within 1 m of its goal, at any speed, before
  100 s. Any contact fails, also one with an obstacle that runs into the robot while it stands. BARN's start is
  (−2.25, 3, 90°), with the goal 10 m ahead; time counts from the first command (there from the first 0.1 m).
  DynaBARN's is (11, 0, 180°), with the goal 20 m ahead; the seed of a run draws how far the obstacles' motions are
  when it begins, up to 60 s. At the end of its period an obstacle jumps back to where it started, as in Gazebo.
- **Score** (BARN): OT / clip(AT, 2 OT, 8 OT) for a run that succeeds, 0 for others, where OT is the length of the
  reference path at 2 m/s: at most 0.5. It saturates at a mean of 1 m/s, so the time is given too, in full. *Possible*
  is the shortest time that the limits allow from rest: on the reference path, whose corners a robot may cut; and in
  a straight line, which no robot can beat.
- **DynaBARN's own score is void**: `run.py` takes −20 − 11 m, a negative length, for its path. The bounds of the clip
  change places, and every success scores 1/8, however long it took. Success and time are given instead.
"""


@dataclass(frozen=True)
class Group:
    """The rows of one evaluation that were driven alike."""

    evaluation: Evaluation
    rows: list[Row]

    @property
    def benchmark(self) -> str:
        """`barn` or `dynabarn`."""
        return self.evaluation.suite.title

    @property
    def robot(self) -> Robot:
        """The robot."""
        path = next(path for path in self.evaluation.suite.robots if Path(path).stem == self.rows[0].robot)
        return Robot.load(path)

    @property
    def runs(self) -> str:
        """How many worlds and runs."""
        worlds = len({row.world for row in self.rows})
        return f"{worlds} worlds × {len(self.rows) // worlds}"

    def options(self) -> list[str]:
        """The options of the command that ran it, but for the worlds and the seeds."""
        first, robot, settings = self.rows[0], self.robot, self.evaluation.suite.crossed()
        lidar = next(iter(robot.lidars.values()))
        drifts = settings.get("odometry", (None,))[0] is not None
        latency = settings.get("latency", (None,))[0]
        given = {
            "--controller": (first.controller, "regulated_pure_pursuit"),
            "--planner": (first.planner, "auto"),
            "--backend": (first.backend, "mujoco"),
            "--speed": (f"{robot.limits.linear_speed:g}", "2"),
            "--noise": (f"{lidar.noise:g}", "0.01"),
            "--scan-age": (f"{latency.scan_age_s:g}" if latency else "0", "0"),
            "--command-delay": (f"{latency.command_delay_s:g}" if latency else "0", "0"),
        }
        options = [f"{name} {value}" for name, (value, usual) in given.items() if value != usual]
        if drifts != (self.benchmark == "barn"):
            options.append("--drift" if drifts else "--no-drift")
        watched = settings.get("collision_monitor", (None,))[0] is not False
        if watched != (self.benchmark == "barn"):
            options.append("--collision-monitor" if watched else "--no-collision-monitor")
        return options

    def command(self, row: Row | None = None) -> str:
        """The command that ran them, or that runs one of them again."""
        seeds = sorted({one.seed for one in self.rows}) if row is None else [row.seed]
        text = f"{seeds[0]}:{seeds[-1] + 1}" if row is not None or seeds[0] else f"{len(seeds)}"
        numbers = [] if row is None else [f"--only {row.world.rpartition('_')[2]}"]
        name = "--seeds" if self.benchmark == "barn" else "--phases"
        parts = ["trundle evaluate", self.benchmark, "--worlds", _PLACES[self.benchmark], *numbers, f"{name} {text}"]
        return " ".join([*parts, *self.options()])

    def possible(self) -> str:
        """The shortest times [s] that the limits allow: on the reference path, and in a straight line."""
        straight = ReferencePath(np.array(_ENDS[self.benchmark])).shortest_time(self.robot.limits, ARRIVAL_RADIUS)
        on_path = [row.shortest_time_s for row in self.rows if row.shortest_time_s is not None]
        return f"{np.mean(on_path):.2f}, {straight:.2f}" if on_path else f"{straight:.2f}"


def groups_of(folder: str) -> Iterator[Group]:
    """The groups of an evaluation."""
    evaluation = Evaluation(folder)
    if evaluation.suite.title not in _PLACES:
        raise SystemExit(f"{folder} is the evaluation of {evaluation.suite.title}, not of barn or dynabarn")
    found: dict[tuple[str, ...], list[Row]] = {}
    for row in evaluation.rows():
        found.setdefault((row.robot, row.planner, row.controller, row.backend, row.settings), []).append(row)
    for rows in found.values():
        yield Group(evaluation, rows)


def figures(group: Group, rows: list[Row]) -> list[str]:
    """Success, contacts, score and times of some rows."""
    arrived = [row for row in rows if row.outcome == "arrived"]
    low, high = wilson(len(arrived), len(rows))
    times = [row.time_s for row in arrived if row.time_s is not None]
    others = Counter(row.outcome for row in rows if row.outcome != "arrived")
    scores = [row.barn_score for row in rows if row.barn_score is not None]
    return [
        f"{len(arrived)} of {len(rows)} ({100 * low:.1f} to {100 * high:.1f} %)",
        str(others.pop("collided", 0)),
        ", ".join(f"{count} {name}" for name, count in others.items()) or "none",
        *([f"{np.mean(scores):.4f}"] if group.benchmark == "barn" else []),
        f"{np.mean(times):.2f}, {np.percentile(times, 95):.2f}" if times else "–",
        group.possible(),
    ]


def table(benchmark: str, groups: list[Group]) -> list[str]:
    """The table of a benchmark."""
    if not groups:
        return []
    score = ["mean score"] if benchmark == "barn" else []
    level = ["level"] if benchmark == "dynabarn" else []
    header = ["runs", *level, "arrived (95 %)", "with a contact", "other failures", *score, "time, mean and p95 [s]"]
    lines = ["", f"### {'BARN' if benchmark == 'barn' else 'DynaBARN'}", ""]
    lines.append("| " + " | ".join([*header, "possible [s]", "command"]) + " |")
    lines.append("|" + " --- |" * (len(header) + 2))
    for group in groups:
        for name in LEVELS if level else ("",):
            rows = [row for row in group.rows if not level or row.world.startswith(f"{name}/")]
            if rows:
                cells = [Group(group.evaluation, rows).runs, *([name] if level else []), *figures(group, rows)]
                lines.append("| " + " | ".join([*cells, f"`{group.command()}`"]) + " |")
    return lines


def failures(groups: list[Group]) -> list[str]:
    """A line for each failure, with the command that runs it again."""
    lines: list[str] = []
    for group in groups:
        failed = [row for row in group.rows if row.outcome != "arrived"]
        lines += ["", f"Failures of `{group.command()}`: {len(failed) or 'none'}.", *([""] if failed else [])]
        for row in failed:
            said = (row.error or row.message).replace("|", "/")
            lines.append(f"- {row.world}, seed {row.seed}, {row.outcome}: {said}. `{group.command(row)}`")
    return lines


def section(folders: list[str]) -> str:
    """The section."""
    groups = [group for folder in folders for group in groups_of(folder)]
    lines = [INTRODUCTION]
    versions = groups[0].evaluation.results.versions
    lines.append(f"Measured with {', '.join(f'{name} {versions[name]}' for name in _VERSIONS if name in versions)}.")
    lines.append("The commands need the public files, which trundle does not ship.")
    for benchmark in _PLACES:
        of_benchmark = [group for group in groups if group.benchmark == benchmark]
        lines += [*table(benchmark, of_benchmark), *failures(of_benchmark)]
    return "\n".join(lines) + "\n"


def main() -> None:
    """Write the section, or print it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", help="folders that trundle evaluate barn or dynabarn wrote")
    parser.add_argument("--print", action="store_true", dest="prints", help="print the section, and write nothing")
    options = parser.parse_args()
    text = section(options.folders)
    if options.prints:
        print(text, end="")
        return
    page = PAGE.read_text(encoding="utf-8")
    before, _, rest = page.partition(BEGIN)
    after = rest.partition(END)[2]
    PAGE.write_text(f"{before.rstrip()}\n\n{BEGIN}\n{text}{END}\n{after.lstrip()}", encoding="utf-8")


if __name__ == "__main__":
    main()
