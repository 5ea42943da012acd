"""How soon a robot finds itself that somebody carries away while it drives: it may stop, and turn to see more.

    python -m benchmarks.localization.carried_away --runs 100 --jobs 16

On a mission in a generated world, after some seconds, the robot is put somewhere else, where it fits; neither its
odometry nor its localizer notices. It is driven by trundle's navigator, so that it looks around as soon as it doubts.
Odometry is 1 % and 1°/m off. "Found" is within 0.5 m for good, with the state `localized`, or at the goal in truth.
Half of the runs have the true map; on the others a quarter of the smaller objects is missing and twelve ghosts stand.
"""

from __future__ import annotations

import argparse
import warnings
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass

import numpy as np
from benchmarks.timing import print_table

import trundle
from trundle.costmap import Costmap
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.mission import Outcome, PlaceRobot, Steering, sample_mission
from trundle.observation import Estimate

WORLDS = {
    "warehouse": {"low_objects": False},
    "office": {"low_objects": False},
    "corridors": {},
    "cylinders": {},
    "maze": {},
    "lot": {"low_objects": False},
}
NEAR_M, WITHIN_S, LATER_S, SAID_AFTER_S = 0.5, 10.0, 30.0, 2.0
_ALIKE = 0.97
"""Share of the true place's agreement with the scans from which on another one cannot be told from it."""
_LEAST_CARRIED_M = 2.0


@dataclass(frozen=True)
class Found:
    """What became of one run: times are from when the robot was carried away [s].

    Attributes:
        after: When it was found for good; None if it was not.
        bad: For how long it was wrong, from two seconds on.
        said: For how long of that it said so.
        wrongly: For how long it was wrong and said `localized`, from two seconds on.
        alike: Whether it was not found within ten seconds, said `ambiguous`, and another place agreed as well then.
        outcome: How the run ended.
    """

    name: str
    after: float | None
    bad: float
    said: float
    wrongly: float
    alike: bool
    outcome: str


def drive(kind: str, seed: int, changed: bool, seconds: float) -> Found | None:
    """Drive one mission; None where it ended before the robot was carried away."""
    warnings.simplefilter("ignore")
    scenario = trundle.Scenario.make(
        world={"name": kind, "options": WORLDS[kind]},
        seed=seed,
        backend="kinematic",
        lidar=True,
        lidar_errors={"noise": 0.02, "dropouts": 0.01, "short_returns": 0.01},
        localizer="amcl",
        odometry={"scale": 0.01, "heading": "1deg"},
        map_errors={"missing": 0.25, "ghosts": 12} if changed else None,
    )
    rng = np.random.default_rng(seed)
    steering = Steering()
    with scenario.build() as mission, mission.session(steering=steering) as session:
        true_grid = OccupancyGrid.from_world(mission.world, z_range=mission.robot.z_range)
        true_map = Costmap.from_grid(true_grid, mission.robot)
        carry_at = rng.uniform(4.0, 8.0)
        while session.time < carry_at and session.step() is not None:
            pass
        if session.outcome is not None:
            return None
        before = session.time
        for _ in range(100):
            there, _ = sample_mission(true_map, int(rng.integers(1 << 30)))
            if there.distance_to(session.state.pose) > _LEAST_CARRIED_M:
                break
        steering.put(PlaceRobot(*there.as_tuple()))
        good_since: float | None = None
        bad = said = wrongly = 0.0
        alike = False
        while session.time < before + seconds and (step := session.step()) is not None:
            off, localized = step.estimate.pose.distance_to(step.state.pose), step.estimate.state == "localized"
            passed = step.state.time - before
            good = off <= NEAR_M and localized
            good_since = (passed if good_since is None else good_since) if good else None
            if passed <= WITHIN_S:
                alike = step.estimate.state == "ambiguous" and has_alike(step.estimate, step.state.pose)
            if off > NEAR_M and passed > SAID_AFTER_S:
                bad += session.dt
                said += session.dt * (not localized)
                wrongly += session.dt * localized
        outcome = session.outcome
    name = f"{kind} {seed}{' changed' if changed else ''}"
    return Found(name, good_since, bad, said, wrongly, alike, "" if outcome is None else outcome.value)


def has_alike(estimate: Estimate, truth: Pose2D) -> bool:
    """Whether another place agrees with what the lidars see as well as the true one does."""
    weights = dict.fromkeys((True, False), 0.0)
    for one in estimate.hypotheses:
        near = one.pose.distance_to(truth) <= NEAR_M
        weights[near] = max(weights[near], one.weight)
    return weights[False] >= _ALIKE * weights[True]


def _drive(job: tuple[str, int, bool, float]) -> Found | None:
    return drive(*job)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=12, help="with the true map, and as many with a changed one")
    parser.add_argument("--seconds", type=float, default=60.0, help="of simulated time after the robot was carried")
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--each", action="store_true", help="print each run")
    options = parser.parse_args()
    kinds = list(WORLDS)
    rows = []
    with ProcessPoolExecutor(options.jobs) as pool:
        for changed in (False, True):
            seeds = range(options.first, options.first + options.runs)
            jobs = [(kinds[k % len(kinds)], k, changed, options.seconds) for k in seeds]
            found = [one for one in pool.map(_drive, jobs) if one is not None]
            if options.each:
                for each in found:
                    print(each, flush=True)
            rows.append(("changed map" if changed else "true map", *summarize(found)))
    header = ("carried away", "runs", "found", f"within {WITHIN_S:g} s", f"within {LATER_S:g} s", "median, longest [s]")
    header = (*header, "later, as places look alike", "said of bad time", "runs wrongly localized", "contacts")
    print_table(header, rows)


def summarize(found: list[Found]) -> tuple[str, ...]:
    """One line of the table."""
    times = [each.after for each in found if each.after is not None]
    bad = sum(each.bad for each in found)
    return (
        str(len(found)),
        str(len(times)),
        *(f"{100 * sum(each <= limit for each in times) / len(found):.0f} %" for limit in (WITHIN_S, LATER_S)),
        f"{np.median(times):.1f}, {max(times):.1f}" if times else "–",
        str(sum(each.alike for each in found)),
        f"{100 * sum(each.said for each in found) / bad:.1f} %" if bad > 0.0 else "–",
        str(sum(each.wrongly > 0.0 for each in found)),
        str(sum(each.outcome == Outcome.COLLIDED.value for each in found)),
    )


if __name__ == "__main__":
    main()
