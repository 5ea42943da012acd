"""docs/ros2.md and ros2_reference.md: the commands can be parsed, and the tables have what the bridge has."""

import re
import shlex
from pathlib import Path

import pytest
from cyclopts import App

from trundle.ros2.navigator_role.role import REFUSED_ACTIONS
from trundle.ros2.profile import Profile

DOCS = Path(__file__).parents[2] / "docs"
GUIDE, REFERENCE = ((DOCS / page).read_text() for page in ("ros2.md", "ros2_reference.md"))
COMMANDS = re.findall(r"^ +(trundle ros2 [^\n#]+)", GUIDE, flags=re.MULTILINE)
ROWS = [
    [cell.strip() for cell in line.strip("|").split("|")] for line in REFERENCE.splitlines() if line.startswith("|")
]


@pytest.mark.parametrize("command", COMMANDS)
def test_a_command_can_be_parsed(command: str) -> None:
    words = shlex.split(re.sub(r"\$\([^)]*\)", "/opt/ros", command))[1:]
    app = App(name="trundle", result_action="return_value")
    app.command("trundle.cli.ros2:app", name="ros2")
    function, bound, _ = app.parse_args(words, exit_on_error=False, print_error=False)
    assert function.__name__ in ("serve", "check")
    assert bound is not None


def test_the_page_has_commands_of_both_verbs_both_roles_and_all_profiles() -> None:
    text = "\n".join(COMMANDS)
    for part in ("serve", "check", "--role navigator", "--profile carter_navigation", "--profile turtlebot3"):
        assert part in text


@pytest.mark.parametrize("refusal", REFUSED_ACTIONS, ids=lambda refusal: refusal.name)
def test_what_is_refused_is_in_the_table_with_its_call(refusal) -> None:
    (row,) = (row for row in ROWS if f"`{refusal.name}`" in row[0] and len(row) == 3)
    for call in refusal.call.split(", "):
        assert f"`{call}`" in row[1]


@pytest.mark.parametrize("name", ["carter_navigation", "plain", "turtlebot3"])
def test_a_profile_is_in_the_table_with_its_robot_and_its_topics(name: str) -> None:
    profile = Profile.load(name)
    (row,) = (row for row in ROWS if row[0] == f"`{name}`")
    text = " ".join(row)
    assert (profile.robot or "nova_carter") in row[1]
    for frame in (profile.frames.base, *profile.frames.also_base):
        assert f"`{frame}`" in text or name == "turtlebot3"
    assert f"`{profile.topics.odom}`" in row[3]
    for sensor in profile.sensors.values():
        for topic in (sensor.scan, sensor.points):
            assert topic is None or f"`{topic}`" in text
