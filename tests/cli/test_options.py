import math
from pathlib import Path

import pytest

from trundle.cli.shared import options
from trundle.errors import AngleWarning, InputError
from trundle.geometry import Pose2D, wrap_angle


def test_poses() -> None:
    assert options.parse_pose("--start", "-6,-1,3.0") == Pose2D(-6.0, -1.0, 3.0)
    assert options.parse_pose("--start", "1e0,.5") == Pose2D(1.0, 0.5, 0.0)


def test_a_goal_without_a_yaw_stays_without() -> None:
    assert options.parse_goal("--goal", "-1,2") == (-1.0, 2.0)
    assert options.parse_goal("--goal", "-1,2,-3") == (-1.0, 2.0, -3.0)


def test_a_yaw_may_be_in_degrees() -> None:
    assert options.parse_pose("--start", "1,2,-90deg") == Pose2D(1.0, 2.0, -math.pi / 2.0)
    assert options.parse_goal("--goal", "1,2,90deg") == (1.0, 2.0, math.pi / 2.0)
    with pytest.raises(InputError, match=r"YAW 'north' is not an angle; write .* 90deg"):
        options.parse_pose("--start", "1,2,north")


def test_a_yaw_beyond_a_whole_turn_is_warned_of_once() -> None:
    with pytest.warns(AngleWarning, match=r"^--goal 1,2,90: YAW 90 is more than one turn.* write 90deg") as caught:
        assert Pose2D.of(options.parse_goal("--goal", "1,2,90")).yaw == wrap_angle(90.0)
    assert len(caught) == 1


@pytest.mark.parametrize("text", ["", "1", "1,2,3,4", "a,b", "1;2", "nan,0", "inf,0", "1,,2", "--json"])
def test_what_is_no_pose_is_refused_with_the_option_and_the_form(text: str) -> None:
    with pytest.raises(InputError, match=r"--start .*X,Y,YAW"):
        options.parse_pose("--start", text)


def test_settings() -> None:
    assert options.parse_settings(["aisle-width=1.6", "racks=3", "doors=true", "name=a=b"]) == {
        "aisle_width": 1.6,
        "racks": 3,
        "doors": True,
        "name": "a=b",
    }


@pytest.mark.parametrize("texts", [["x"], ["=1"], ["a b=1"], ["a=1", "a=2"]])
def test_what_is_no_setting_is_refused(texts: list[str]) -> None:
    with pytest.raises(InputError, match="--set"):
        options.parse_settings(texts)


def test_an_output_is_a_file_or_a_folder(tmp_path: Path) -> None:
    suffixes = (".yaml", ".yml")
    assert options.output_file(tmp_path / "a.YAML", "map.yaml", suffixes) == tmp_path / "a.YAML"
    assert options.output_file(tmp_path, "map.yaml", suffixes) == tmp_path / "map.yaml"
    assert options.output_file(tmp_path / "new" / "b", "map.yaml", suffixes) == tmp_path / "new" / "b" / "map.yaml"
    assert (tmp_path / "new" / "b").is_dir()
    assert options.output_file(tmp_path / "other" / "c.yml", "map.yaml", suffixes).parent.is_dir()


def test_an_output_of_another_kind_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"\.yaml or \.yml, or a folder"):
        options.output_file(tmp_path / "map.png", "map.yaml", (".yaml", ".yml"))
    assert list(tmp_path.iterdir()) == []


def test_exclude_is_an_option_of_the_world() -> None:
    assert options.parse_settings(["missing=error"], ["/World/Robot", "floor"]) == {
        "missing": "error",
        "exclude": "/World/Robot,floor",
    }
    with pytest.raises(InputError, match="not both"):
        options.parse_settings(["exclude=floor"], ["ceiling"])
