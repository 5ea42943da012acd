"""What reads a mutated file of each format: its loader in this process, or a command."""

from __future__ import annotations

import contextlib
import io
import os
import random
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import traceback
import warnings
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from fuzz import loader_seeds
from fuzz.mutation import mutate
from trundle.errors import MapError, RobotError, TrundleError, WorldError
from trundle.guard import Child, ReadCall, ReadLimits

LIMITS = ReadLimits(seconds=3.0, gigabytes=2.0)
"""Less time than users have: a foreign file that takes longer is refused here sooner."""

MOST_SECONDS, MOST_KILOBYTES = 10.0, 2_000_000
"""What a loader, or a command, may take for a file. Memory is what this process has at most, or the command's."""

PREFIX = "mutated-"
"""Before the name of the file that was mutated."""

TOKENS = (
    *(b"0 -1 1e300 -1e300 1e-300 nan inf 999999999999 2147483648 65535 0x10 true null [] {} < > / & # ..".split()),
    *(b"def over class references payload <mujoco> </worldbody> <link/> <include/> box mesh NaN 1;2".split()),
    b"\xff\xfe",
    b"\x00",
    b"\x00\x00\x00\x00",
    b"\xff\xff\xff\xff",
    b"\x7f\xff\xff\xff",
    b"[" * 200,
    b"9" * 400,
)


def mutate_member(archive: bytes, generator: random.Random) -> bytes:
    """Mutate one array of an .npz, and pack it with a checksum that is right: otherwise that is all a reader sees."""
    out = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(archive)) as source, zipfile.ZipFile(out, "w") as target:
        names = source.namelist()
        chosen = generator.choice(names)
        for name in names:
            content = source.read(name)
            target.writestr(name, mutate(content, generator, TOKENS) if name == chosen else content)
    return out.getvalue()


class Reader:
    """Reads files of one format in a folder, foreign ones in one child that stays."""

    def __init__(self, folder: Path, form: str, *, cli: bool = False) -> None:
        self._folder, self._form, self._child, self._cli = folder, form, Child(), cli
        self._files = loader_seeds.SEEDS[form](folder)

    def close(self) -> None:
        """End the child."""
        self._child.close()

    def read(self, number: int, seed: int) -> tuple[str, Path]:
        """Mutate and read one file; return how it ended, and where the file is."""
        generator = random.Random(f"{self._form}/{seed}/{number}")
        source = generator.choice(self._files)
        file = self._folder / f"{PREFIX}{source.name}"
        content = source.read_bytes()
        if source.suffix in (".npz", ".posegraph") and generator.random() < 0.8:
            file.write_bytes(mutate_member(content, generator))
        else:
            file.write_bytes(mutate(content, generator, TOKENS))
        if self._cli:
            return command_line(self._form, file), file
        forget_peak()
        begun = time.monotonic()
        ended = self._load(file)
        took, peak = time.monotonic() - begun, peak_kilobytes()
        if took > MOST_SECONDS or peak > MOST_KILOBYTES:
            return f"it took {took:.0f} s and {peak} kB: {ended[-3000:]}", file
        return ended, file

    def _load(self, file: Path) -> str:
        try:
            with warnings.catch_warnings(), np.errstate(all="ignore"):
                warnings.simplefilter("ignore")
                LOADERS[self._form](self._child, file)
        except TrundleError as error:
            return "refused" if str(error) else "refused without a message"
        except Exception:  # noqa: BLE001 - what is looked for
            return traceback.format_exc()
        return "read"


def forget_peak() -> None:
    """Let the peak of this process's memory begin at what it has now; Linux alone can."""
    with contextlib.suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5")


def peak_kilobytes() -> int:
    """The most memory that this process has had [kB], since `forget_peak` on Linux; else since it began."""
    try:
        status = Path("/proc/self/status").read_text()
    except OSError:
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // (1024 if sys.platform == "darwin" else 1)
    return int(re.search(r"VmHWM:\s*(\d+)", status).group(1))


def _world(child: Child, file: Path) -> None:
    options: dict[str, Any] = {"missing": "skip"} if file.suffix == ".sdf" else {}
    child.read(ReadCall("trundle.worlds.load:read_world", (str(file), options), str(file), WorldError, LIMITS))


def _model(child: Child, file: Path) -> None:
    """As a world, as a robot and for its joints; the first error ends it only where it is no TrundleError."""
    calls: list[tuple[str, tuple[Any, ...], type[WorldError] | type[RobotError]]] = [
        ("trundle.worlds.load:read_world", (str(file), {}), WorldError),
        ("trundle.robots.from_model:read_robot", (file, {"drive": {}}, ()), RobotError),
        ("trundle.sim.mujoco.joints:read_joints", (file,), RobotError),
    ]
    refused: TrundleError | None = None
    for target, args, error in calls:
        try:
            child.read(ReadCall(target, args, str(file), error, LIMITS))
        except TrundleError as problem:
            refused = problem
    if refused is not None:
        raise refused


def _usd(child: Child, file: Path) -> None:
    try:
        child.read(ReadCall("trundle.sim.mujoco.joints:read_joints", (file,), str(file), RobotError, LIMITS))
    finally:
        _world(child, file)


def _map(_: Child, file: Path) -> None:
    from trundle.maps import OccupancyGrid
    from trundle.maps.check import check_map

    check_map(file)
    OccupancyGrid.load(file)


def _beside(file: Path) -> Path:
    """The YAML of a map's image."""
    yaml = file.with_suffix(".yaml")
    yaml.write_text(loader_seeds.MAP_YAML.replace("map.pgm", file.name))
    return yaml


def _image(child: Child, file: Path) -> None:
    _map(child, _beside(file))


def _scenario(_: Child, file: Path) -> None:
    from trundle.mission import Scenario

    Scenario.load(file)


def _npz(_: Child, file: Path) -> None:
    from trundle.maps import HeightField
    from trundle.mission import Trajectory

    try:
        Trajectory.load(file)
    except MapError:
        raise
    except TrundleError:
        HeightField.load(file)


def _in_run(file: Path) -> Path:
    folder = file.parent / "run"
    shutil.copytree(file.parent / loader_seeds.RUN, folder, dirs_exist_ok=True)
    shutil.copy(file, folder / file.name.removeprefix(PREFIX))
    return folder


def _run(_: Child, file: Path) -> None:
    """In the place of the file of a run that it was made from."""
    from trundle.mission import Episode, Scenario
    from trundle.record.motion import Motion

    if file.suffix == ".csv":
        Motion.load(file)
        return
    folder = _in_run(file)
    try:
        Episode.load(folder)
    finally:
        Scenario.load(folder)


def _in_evaluation(file: Path) -> Path:
    folder = file.parent / "evaluation"
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(file.parent / loader_seeds.EVALUATION, folder)
    shutil.copy(file, next(folder.rglob(file.name.removeprefix(PREFIX))))
    return folder


def _evaluation(_: Child, file: Path) -> None:
    """In the place of the file of an evaluation that it was made from; read by tables, reports and a continuation."""
    from trundle.evaluation import Evaluation

    evaluation = Evaluation(_in_evaluation(file))
    try:
        evaluation.summary()
        evaluation.write_report(apart=False)
        evaluation.read_summary()
        list(evaluation.rows())
    finally:
        evaluation.close()


def _directives(_: Child, file: Path) -> None:
    from trundle.mission import load_directives

    load_directives(file)


def _nav2(_: Child, file: Path) -> None:
    from trundle.mission import Scenario
    from trundle.nav2 import read_nav2_params

    Scenario.make(**{"world": "warehouse", **read_nav2_params(file, "nova_carter").settings})


def _suite(_: Child, file: Path) -> None:
    from trundle.evaluation import Suite

    suite = Suite.load(file)
    for index in range(0, len(suite), max(1, len(suite) // 3)):
        suite.spec(index)


def _mcap(_: Child, file: Path) -> None:
    from trundle.bags import read_info, read_run, recover

    read_info(file)
    try:
        recover(file, file.parent / loader_seeds.BAGS / "new.mcap", overwrite=True)
    finally:
        read_run(file)


def _barn(child: Child, file: Path) -> None:
    from trundle.evaluation.public.reference import load_reference

    if file.suffix == ".npy":
        load_reference(file)
    else:
        _world(child, file)


def _dynabarn(_: Child, file: Path) -> None:
    from trundle.worlds.dynabarn import load_dynabarn, read_dynabarn

    for name in read_dynabarn(file):
        load_dynabarn(file, world=name)


def _posegraph(_: Child, file: Path) -> None:
    from trundle.mapping import load_pose_graph

    load_pose_graph(file)


def _drive(_: Child, file: Path) -> None:
    from trundle.recordings import open_drive

    for _step in open_drive(file).steps():
        pass


def _commands(form: str, file: Path) -> list[list[str]]:
    """How the command line reads a file of a format."""
    out = file.parent / "out"
    short = ["--workers", "1", "--time-budget", "1s", "--overwrite", "-o", str(out)]
    match form:
        case "evaluation":
            folder = str(_in_evaluation(file))
            return [["evaluate", "report", folder], ["evaluate", "show", folder, "--json"]]
        case "run":
            return [["replay", str(_in_run(file)), "--json"]]
        case "directives":
            scenario = file.with_suffix(".yaml")
            scenario.write_text(f"world: warehouse\nbackend: kinematic\ntime_limit_s: 0.1\ndirectives: {file.name}\n")
            return [["run", str(scenario), "--no-video", "--overwrite", "-o", str(out)]]
        case "nav2":
            return [["scenario", "warehouse", "--nav2-params", str(file), "--overwrite", "-o", f"{out}.yaml"]]
        case "suite":
            return [["evaluate", str(file), "--time-limit", "0.1", *short]]
        case "mcap":
            made = ["-o", f"{out}.mcap", "--overwrite"]
            return [["record", "info", str(file)], ["record", "recover", str(file), *made]]
        case "dynabarn":
            return [["evaluate", "dynabarn", "--worlds", str(file), "--phases", "1", "--backend", "kinematic", *short]]
        case "barn" if file.suffix == ".npy":
            shutil.copy(file, file.with_name("path_7.npy"))
            return [
                ["evaluate", "barn", "--worlds", str(file.parent), "--seeds", "1", "--backend", "kinematic", *short]
            ]
        case "map":
            return [["map", "check", str(file)]]
        case "image":
            return [["map", "check", str(_beside(file))]]
        case "scenario":
            return [["scenario", str(file), "--json", "-o", f"{out}.yaml"]]
        case _:
            return [["map", "build", str(file), "-o", f"{out}.yaml"]]


def command_line(form: str, file: Path) -> str:
    """Read a file by the command line; return how it ended."""
    ended = "read"
    limits = {**os.environ, "TRUNDLE_READ_SECONDS": f"{LIMITS.seconds:g}", "TRUNDLE_READ_GIGABYTES": "1"}
    for command in _commands(form, file):
        with tempfile.TemporaryFile() as said:
            process = subprocess.Popen(
                [sys.executable, "-m", "trundle", *command], stdout=said, stderr=said, env=limits
            )
            killer = threading.Timer(MOST_SECONDS, process.kill)
            killer.start()
            _, status, used = os.wait4(process.pid, 0)
            killer.cancel()
            process.returncode = code = os.waitstatus_to_exitcode(status)
            said.seek(0)
            text = said.read().decode(errors="replace")
        if code not in (0, 1, 2) or used.ru_maxrss > MOST_KILOBYTES:
            return f"{' '.join(command)}: exit code {code}, {used.ru_maxrss} kB\n{text[-3000:]}"
        ended = "refused" if code == 2 else ended
    return ended


LOADERS: dict[str, Callable[[Child, Path], None]] = {
    "urdf": _model,
    "mjcf": _model,
    "sdf": _world,
    "usd": _usd,
    "mesh": _world,
    "map": _map,
    "image": _image,
    "scenario": _scenario,
    "npz": _npz,
    "run": _run,
    "evaluation": _evaluation,
    "directives": _directives,
    "nav2": _nav2,
    "suite": _suite,
    "mcap": _mcap,
    "barn": _barn,
    "dynabarn": _dynabarn,
    "posegraph": _posegraph,
    "carmen": _drive,
    "drive": _drive,
}
