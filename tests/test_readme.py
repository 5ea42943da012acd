"""Every command and snippet of the README and of docs/commands.md runs; the Korean README has the same."""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from trundle.cli.entry import VERBS
from trundle.geometry import Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.mission import Episode

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text()
KOREAN = (ROOT / "README.ko.md").read_text()
PAGE = (ROOT / "docs" / "commands.md").read_text()
SNIPPETS = re.findall(r"```python\n(.*?)```", README, flags=re.DOTALL)
STEP = re.compile(r"^\| (\d)\. [^|]+ \| `(trundle [^`]+)`[^|]*\|$", flags=re.MULTILINE)
VERB = re.compile(r"^\| `(trundle [^`]+)` \|", flags=re.MULTILINE)


def commands_of(readme: str) -> list[str]:
    """The commands of the tables, in their order: the steps of the post, then the other verbs."""
    return [command for _, command in STEP.findall(readme)] + VERB.findall(readme)


def without_comments(text: str) -> list[str]:
    blocks = re.findall(r"```(?:sh|python)\n(.*?)```", text, flags=re.DOTALL)
    return [re.sub(r"\s*#.*", "", block) for block in blocks]


def test_the_readme_is_read_in_minutes() -> None:
    assert len(README.split()) <= 1200


def test_five_steps_are_followed_by_eight_other_verbs_and_the_page_of_commands_has_all() -> None:
    steps, others = [command for _, command in STEP.findall(README)], VERB.findall(README)
    assert [number for number, _ in STEP.findall(README)] == ["1", "2", "3", "4", "5"]
    verbs = {command.split()[1] for command in others}
    assert len(others) == len(verbs) == 8
    assert verbs.isdisjoint(command.split()[1] for command in steps)
    assert {*steps, *others} < set(VERB.findall(PAGE))
    assert {command.split()[1] for command in VERB.findall(PAGE)} == set(VERBS)


def test_the_korean_readme_has_the_same_commands_and_code() -> None:
    assert commands_of(KOREAN) == commands_of(README)
    assert without_comments(KOREAN) == without_comments(README)


def inline_commands(text: str) -> list[str]:
    """Commands and options that stand in a line of text or in a table."""
    return sorted(re.findall(r"`((?:trundle |make |pip |source |\./isaac\.sh |--)[^`]*)`", text))


def tables(text: str) -> list[int]:
    """How many lines each table has."""
    return [len(table.splitlines()) for table in re.findall(r"(?:^\|.*\n)+", text, flags=re.MULTILINE)]


def test_the_korean_readme_has_the_same_sections_tables_and_commands_in_its_text() -> None:
    assert inline_commands(KOREAN) == inline_commands(README)
    assert KOREAN.count("\n## ") == README.count("\n## ")
    assert tables(KOREAN) == tables(README)


RUN_ELSEWHERE = [["map", "from-bag"], ["map", "continue"], ["map", "from-graph"], ["ros2", "navigate"]]
"""They need a recording with scans, or a robot in ROS 2: tests/cli/test_map_drives.py, tests/ros2/remote. Servers run
until they are ended: tests/cli/test_serve.py, tests/cli/test_ros2.py. A policy is needed in tests/navigation."""


def test_the_commands_run_one_after_another(tmp_path: Path) -> None:
    """Those of the README as it has them, and then, in the same folder, the others of docs/commands.md."""
    readme = commands_of(README)
    environment = {key: value for key, value in os.environ.items() if key not in ("DISPLAY", "WAYLAND_DISPLAY")}
    for command in [*readme, *(command for command in VERB.findall(PAGE) if command not in readme)]:
        words = shlex.split(command)[1:]
        if "serve" in words[:2] or words[:2] in RUN_ELSEWHERE or "policy.onnx" in words:
            continue
        words += ["--no-video"] if words[0] in ("demo", "run") else []
        done = subprocess.run(
            [sys.executable, "-m", "trundle", *words],
            cwd=tmp_path,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"
        assert done.stdout, command


def test_the_five_lines_arrive(capsys: pytest.CaptureFixture[str]) -> None:
    names: dict[str, object] = {}
    exec(SNIPPETS[0], names)
    episode = names["episode"]
    assert isinstance(episode, Episode)
    assert episode.arrived, episode.message
    assert capsys.readouterr().out.startswith("arrived")


def test_a_loop_of_your_own_ends_at_the_goal(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    data = np.zeros((140, 140), dtype=np.int8)
    data[[0, -1], :] = data[:, [0, -1]] = 100
    OccupancyGrid(data, 0.05, Pose2D(0.0, 0.0)).save(tmp_path / "map.yaml")
    monkeypatch.chdir(tmp_path)
    pose = Pose2D(2.0, 2.0, 1.0)
    names: dict[str, object] = {"twist": Twist2D()}

    def pose_of_my_robot() -> Pose2D:
        nonlocal pose
        twist = names["twist"]
        assert isinstance(twist, Twist2D)
        pose = twist.integrate(pose, 0.05)
        return pose

    names["pose_of_my_robot"] = pose_of_my_robot
    exec("import trundle\n" + SNIPPETS[1], names)
    assert pose.distance_to(Pose2D(5.0, 3.5)) < 0.3
