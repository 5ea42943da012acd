"""Do two checkouts drive, see and decide the same, bit for bit? Digests of whole runs with simulated lidars.

    python -m benchmarks.simulation.alike --before CHECKOUT [--seeds 2] [--seconds 15] [CASE ...]

A digest is of all that observers get of each control period: states, scans, estimates, commands, what the collision
monitor made of them, tracks, paths, messages and costmaps; and of the rows of the run. The other checkout has its
kernels beside its sources.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import subprocess
import sys
import tempfile
import warnings
from pathlib import Path
from typing import Any

_PEOPLE = {"low_objects": False, "forklifts": 3, "people": 6, "mover_speed": 1.2, "sees_robot": True}
_ONE_LIDAR = (
    "base: nova_carter\nname: one\nlidars:\n  front: {x: 0.1, y: 0.0, z: 0.3, fov: 4.0, beams: 360, noise: 0.01}\n"
)
_NOISY = "base: nova_carter\nname: noisy\nlidars:\n" + "".join(
    f"  {name}: {{x: {x}, y: 0.0, z: 0.418, yaw: {yaw}, noise: 0.01}}\n"
    for name, x, yaw in (("front", 0.026, 3.141592653589793), ("back", -0.4894, 0.0))
)
_BOXES = {"unmapped": {"boxes": [3, 8]}}
_ERRORS = {"lidar_errors": {"noise": 0.02, "dropouts": 0.02, "short_returns": 0.02}}
_ODOMETRY = {"odometry": {"scale": 0.01, "heading": "1deg", "slip": 0.002}, "localizer": "odometry"}
_AMCL = {"odometry": {"scale": 0.01, "heading": "1deg"}, "localizer": "amcl"}

CASES: dict[str, dict[str, Any]] = {
    "warehouse": {"world": "warehouse", **_BOXES},
    "office": {"world": "office", **_BOXES},
    "maze": {"world": "maze"},
    "people": {"world": {"name": "warehouse", "options": _PEOPLE}},
    "one lidar": {"world": "office", "robot": _ONE_LIDAR, **_BOXES},
    "turtlebot": {"world": "office", "robot": "turtlebot3_burger"},
    "errors": {"world": "office", **_BOXES, **_ERRORS},
    "late scans": {"world": "warehouse", "latency": {"scan_age_s": 0.12, "command_delay_s": 0.07}, **_BOXES},
    "late, people": {"world": {"name": "warehouse", "options": _PEOPLE}, "latency": {"scan_age_s": 0.1}},
    "odometry": {"world": "warehouse", **_BOXES, **_ODOMETRY},
    "slips": {
        "world": "warehouse",
        "odometry": {"scale": 0.01, "heading": "1deg", "slips": {"every": 2.0}},
        "localizer": "amcl",
        **_ERRORS,
    },
    "amcl": {"world": "office", **_BOXES, **_AMCL},
    "amcl, lost": {"world": "warehouse", **_AMCL, "start_error": "unknown"},
    "slam": {"world": "office", "localizer": "slam", "known_map": False, **_ERRORS},
    "no map": {"world": "office", "known_map": False},
    "rolling": {"world": "warehouse", "layers": {"rolling_window": True}, **_BOXES},
    "forgets": {"world": "warehouse", "layers": {"obstacle": {"observation_persistence": 0.5}}, **_BOXES},
    "mppi": {"world": "office", "controller": "mppi", **_BOXES},
    "mujoco": {"world": "warehouse", "backend": "mujoco", **_BOXES},
    "blind": {"world": "office", "lidar": False, "robot": "nova_carter"},
}


def drive(case: dict[str, Any], seed: int, seconds: float, folder: Path) -> str:
    """The digest of one run."""
    import numpy as np

    from trundle.errors import TrundleError
    from trundle.mission import Scenario

    settings = {"backend": "kinematic", "lidar": True, "robot": _NOISY, "time_limit_s": seconds, **case}
    if "\n" in settings["robot"]:
        (folder / "robot.yaml").write_text(settings["robot"])
        settings["robot"] = str(folder / "robot.yaml")
    digest = hashlib.sha256()

    def note(*values: object) -> None:
        digest.update(repr(values).encode())

    class Notes:
        def on_start(self, info: Any) -> None:
            note(info.start, info.goals)

        def on_step(self, step: Any) -> None:
            state, estimate = step.state, step.estimate
            note(state.time, state.pose, state.twist, state.odometry, state.wheel_positions, state.wheel_speeds)
            note(state.contacts, state.movers, estimate.pose, estimate.T_map_odom, estimate.state)
            note(step.command, step.sent, step.monitor, step.status, step.message, step.tracks, step.goal)
            for scan in step.observation.scans:
                note(scan.lidar, scan.time)
                digest.update(scan.ranges.tobytes())
            if step.path is not None:
                digest.update(np.ascontiguousarray(step.path.poses).tobytes())
            if step.costmap is not None:
                digest.update(step.costmap.data.tobytes())

        def on_end(self, episode: Any) -> None:
            note(episode.outcome, episode.message)

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            with Scenario.make(seed=seed, **settings).build() as mission:
                episode = mission.run(observers=[Notes()], stop_on_contact=False)  # type: ignore[list-item]
        except TrundleError as error:
            return f"{type(error).__name__}: {error}".replace(str(folder), "")
    for name in episode.trajectory.columns():
        digest.update(np.ascontiguousarray(getattr(episode.trajectory, name)).tobytes())
    return f"{episode.outcome} {episode.trajectory.time[-1]:.1f} s {digest.hexdigest()[:16]}"


def work(options: argparse.Namespace) -> None:
    """Drive all cases with the package of a checkout, and print their digests."""
    if options.before:  # its sources come before an editable installation of this one
        sys.meta_path[:] = [finder for finder in sys.meta_path if "_editable" not in type(finder).__module__]
        sys.path.insert(0, str(options.before / "src"))
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        for name in options.cases:
            for seed in range(options.seeds):
                found[f"{name} {seed}"] = drive(CASES[name], seed, options.seconds, Path(folder))
                print(f"{name} {seed}: {found[f'{name} {seed}']}", file=sys.stderr, flush=True)
    print(json.dumps(found))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="*", default=list(CASES), help=f"some of: {', '.join(CASES)}")
    parser.add_argument("--before", type=Path, help="another checkout")
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--seconds", type=float, default=15.0, help="of each run at most")
    parser.add_argument("--work", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.work:
        work(options)
        return
    found: list[dict[str, str]] = []
    for other in ([], ["--before", str(options.before.resolve())] if options.before else None):
        if other is None:
            continue
        command = [sys.executable, __file__, "--work", "--seeds", str(options.seeds), "--seconds", str(options.seconds)]
        done = subprocess.run(
            [*command, *other, *options.cases], env=os.environ, stdout=subprocess.PIPE, text=True, check=True
        )
        found.append(json.loads(done.stdout.splitlines()[-1]))
    for name, digest in found[0].items():
        said = "" if len(found) == 1 else "  same" if found[1][name] == digest else f"  DIFFERS: {found[1][name]}"
        print(f"{name}: {digest}{said}")


if __name__ == "__main__":
    main()
