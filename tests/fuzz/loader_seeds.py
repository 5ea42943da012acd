"""Whole files of every format that is loaded, to be mutated."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from fuzz.world_seeds import mesh, mjcf, sdf, urdf, usd, write

MAP_YAML = (
    "image: map.pgm\nresolution: 0.05\norigin: [-1.5, 2.0, 0.1]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    "mode: trinary\n"
)
SCENARIO = """name: demo
world: {name: warehouse, seed: 7, options: {aisle_width: 1.6}}
robot: nova_carter
start: [0.5, 1.0, 0.0]
goals: [[2.0, 3.0], [4.0, 1.0, 1.57]]
planner: {name: least_cost, options: {}}
controller: regulated_pure_pursuit
unknown: costly
unknown_cost: 100
resolution: 0.05
time_limit_s: 120
control_frequency: 20.0
"""
RUN = "intact"
"""The folder of a run, in that of the files."""

_DRIVE = ("time_s", "x", "y", "yaw", "v", "w", "command_v", "command_w")


def maps(folder: Path) -> list[Path]:
    """A ROS map's YAML and a MovingAI map."""
    (folder / "map.pgm").write_bytes(b"P5 6 5 255\n" + bytes([254, 254, 0, 205, 254, 0] * 5))
    return write(folder, {"map.yaml": MAP_YAML, "arena.map": "type octile\nheight 2\nwidth 3\nmap\n.@T\nSWG\n"})


def images(folder: Path) -> list[Path]:
    """A map's images."""
    from PIL import Image

    grey = np.array([[254, 0, 205], [254, 254, 0]], dtype=np.uint8).repeat(4, 0).repeat(4, 1)
    for suffix in ("png", "pgm", "bmp"):
        Image.fromarray(grey).save(folder / f"image.{suffix}")
    (folder / "plain.pgm").write_text("P2\n3 2\n255\n254 0 205\n254 254 0\n")
    return [folder / name for name in ("image.png", "image.pgm", "image.bmp", "plain.pgm")]


def scenarios(folder: Path) -> list[Path]:
    """A scenario."""
    return write(folder, {"scenario.yaml": SCENARIO})


def npz(folder: Path) -> list[Path]:
    """A trajectory and a height field."""
    from trundle.maps import HeightField
    from trundle.mission import Trajectory

    rows = {name: np.arange(50) for name in Trajectory.columns()}
    Trajectory(**{**rows, "localization": np.arange(50) % 3}).save(folder / "trajectory.npz")
    HeightField(np.random.default_rng(0).random((20, 20)), 0.1).save(folder / "floor.npz")
    return [folder / "trajectory.npz", folder / "floor.npz"]


def runs(folder: Path) -> list[Path]:
    """The folder of a short run, and the record of a drive."""
    from trundle.mission import Scenario
    from trundle.record import RunFolder

    scenario = Scenario.make(
        world={"name": "warehouse", "options": {"size": [14, 11]}}, backend="kinematic", seed=5, time_limit_s=20
    )
    place = folder / RUN
    with (
        scenario.build() as mission,
        RunFolder(place, scenario=mission.scenario, overlay=False, video=False) as record,
    ):
        mission.run(observers=[record])
    rows = [",".join(f"{0.05 * row + column:.3f}" for column in range(len(_DRIVE))) for row in range(20)]
    (place / "drive.csv").write_text("\n".join([",".join(_DRIVE), *rows]) + "\n")
    return [place / name for name in ("episode.json", "paths.npz", "trajectory.npz", "drive.csv")]


EVALUATION = "evaluated"
"""The folder of an evaluation, in that of the files."""

BAGS = "bags"
"""A folder for what is made of a recording, in that of the files."""


def evaluations(folder: Path) -> list[Path]:
    """Files of an evaluation: its rows, its suite and what it keeps of itself."""
    from trundle.evaluation import Suite, evaluate

    place = folder / EVALUATION
    suite = Suite.make(
        worlds=[{"name": "warehouse", "seed": 1, "options": {"size": [14, 11]}}], backends=["kinematic"], seeds="0:3"
    )
    evaluate(suite, out=place, workers=1).close()
    names = ("journal.jsonl", "suite.yaml", "evaluation.json", "summary.json")
    return [*(place / name for name in names if (place / name).is_file()), *sorted(place.glob("parts/*.parquet"))]


def directives(folder: Path) -> list[Path]:
    """The directives of a steered run."""
    from trundle.mission import (
        Cancel,
        DropBox,
        End,
        FollowPath,
        GivenDirective,
        Manual,
        Pause,
        PlaceRobot,
        ReinitializeGlobal,
        Restart,
        RunBehavior,
        SetGoal,
        SetGoals,
        SetPose,
        Speed,
        StepOnce,
        WaitAtGoal,
        save_directives,
    )

    given = (
        Pause(),
        StepOnce(3),
        Speed(2.0),
        SetGoal((1.0, 2.0)),
        SetGoals(((1.0, 2.0), (3.0, 4.0, 0.5))),
        FollowPath(((0.0, 0.0, 0.0), (1.0, 0.0, 0.0))),
        RunBehavior("spin", {"angle": 1.0}),
        Cancel(),
        SetPose((1.0, 2.0, 0.5), ((0.25, 0.0, 0.0), (0.0, 0.25, 0.0), (0.0, 0.0, 0.07))),
        ReinitializeGlobal(),
        Manual(0.5, -0.1),
        DropBox(1.0, 2.0, 0.3),
        PlaceRobot(1.0, 2.0, 0.3),
        WaitAtGoal(),
        Restart("next"),
        End(),
    )
    save_directives(
        folder / "directives.json", [GivenDirective(index, 0.05 * index, one) for index, one in enumerate(given)]
    )
    return [folder / "directives.json"]


def nav2(folder: Path) -> list[Path]:
    """Nav2's parameters, as three distributions have them."""
    data = Path(__file__).parents[1] / "nav2" / "data"
    return write(folder, {file.name: file.read_text() for file in sorted(data.glob("*.yaml"))})


def suites(folder: Path) -> list[Path]:
    """A suite that crosses everything."""
    text = """name: nightly
worlds:
  - {name: warehouse, seed: 1, options: {size: [14, 11]}}
  - {name: maze, options: {rows: 5, columns: 5}}
robots: [nova_carter, turtlebot3_burger]
planners: [auto, {name: least_cost, options: {goal_tolerance: 0.5}}]
controllers: [regulated_pure_pursuit, mppi]
backends: [mujoco]
missions: {seeds: "0:10"}
vary: {friction: {uniform: [0.5, 1.0]}}
"""
    return write(folder, {"suite.yaml": text})


def recordings(folder: Path) -> list[Path]:
    """A run as MCAP, complete and cut off."""
    from trundle.bags import Recorder
    from trundle.mission import Scenario

    scenario = Scenario.make(
        world={"name": "warehouse", "options": {"size": [14, 11]}}, backend="kinematic", seed=5, time_limit_s=3
    )
    with scenario.build() as mission, Recorder(folder / "run.mcap", scenario=mission.scenario) as record:
        mission.run(observers=[record])
    content = (folder / "run.mcap").read_bytes()
    (folder / "cut.mcap").write_bytes(content[: len(content) // 2])
    (folder / BAGS).mkdir()
    return [folder / "run.mcap", folder / "cut.mcap"]


def barn(folder: Path) -> list[Path]:
    """A world of BARN's and its path."""
    cylinder = (
        "<model name='c{0}'><static>1</static><pose>{0} 1 0 0 0 0</pose><link name='l'><collision name='c'><geometry>"
        "<cylinder><radius>0.075</radius><length>1</length></cylinder></geometry></collision></link></model>"
    )
    models = "".join(cylinder.format(number) for number in range(5))
    np.save(folder / "path_7.npy", np.stack([np.arange(30), np.arange(30)], axis=1))
    world = f"<sdf version='1.6'><world name='w'>{models}</world></sdf>"
    return [*write(folder, {"world_7.world": world}), folder / "path_7.npy"]


def dynabarn(folder: Path) -> list[Path]:
    """Two worlds of DynaBARN's."""
    import json

    moves = {"waypoints": [[0, 1, 2], [2.5, 3, 2], [5, 1, 2.5]], "period_s": 6.0}
    worlds = {f"world_{n}": {"level": level, "obstacles": [moves, moves]} for n, level in ((1, "easy"), (2, "hard"))}
    return write(folder, {"worlds.json": json.dumps(worlds, indent=1)})


def pose_graphs(folder: Path) -> list[Path]:
    """A pose graph."""
    from support.pose_graphs import make_graph
    from trundle.mapping import save_pose_graph

    save_pose_graph(make_graph(), folder / "site.posegraph")
    return [folder / "site.posegraph"]


def carmen_logs(folder: Path) -> list[Path]:
    """A drive as a CARMEN log, plain and gzipped."""
    import gzip

    from support.room_drives import Drive, write_carmen

    log = write_carmen(folder / "drive.log", Drive(seconds=4.0))
    (folder / "drive.log.gz").write_bytes(gzip.compress(log.read_bytes()))
    return [log, folder / "drive.log.gz"]


def foreign_bags(folder: Path) -> list[Path]:
    """A drive in a bag that another program wrote, as MCAP and as SQLite."""
    from support.room_drives import Drive, write_bag

    drive = Drive(seconds=4.0, beams=60)
    found = []
    for storage in ("mcap", "sqlite3"):
        bag = write_bag(folder / storage, drive, storage=storage)
        found += [file for file in bag.iterdir() if file.suffix in (".mcap", ".db3")]
    return found


SEEDS: dict[str, Callable[[Path], list[Path]]] = {
    "urdf": urdf,
    "mjcf": mjcf,
    "sdf": sdf,
    "usd": usd,
    "mesh": mesh,
    "map": maps,
    "image": images,
    "scenario": scenarios,
    "npz": npz,
    "run": runs,
    "evaluation": evaluations,
    "directives": directives,
    "nav2": nav2,
    "suite": suites,
    "mcap": recordings,
    "barn": barn,
    "dynabarn": dynabarn,
    "posegraph": pose_graphs,
    "carmen": carmen_logs,
    "drive": foreign_bags,
}
