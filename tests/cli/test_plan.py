from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from support.command_line import Trundle, room
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid, SpeedMask
from trundle.pictures.colors import BAD, KEPT_OUT, PLANNED
from trundle.planning import planner_names
from trundle.planning.planner import PLANNERS
from trundle.record.map_view import SpeedZones
from trundle.robots import Robot


def test_a_straight_path(trundle: Trundle, room_map: Path, tmp_path: Path) -> None:
    done = trundle("plan", room_map, "--start", "0.5,1.5", "--goal", "5.5,1.5,0", "-o", "plan.png", "--json")
    assert done.code == 0, done.err
    assert done.json["length_m"] == pytest.approx(5.0, abs=0.01)
    assert done.json["poses"][0] == pytest.approx([0.5, 1.5, 0.0])
    assert done.json["poses"][-1] == pytest.approx([5.5, 1.5, 0.0])
    assert done.json["cost"] > 0.0
    assert done.json["planning_ms"] > 0.0
    assert done.json["overlay"] == "plan.png"
    with Image.open(tmp_path / "plan.png") as picture:
        assert min(picture.size) > 200


def test_negative_coordinates_need_no_equals_sign(trundle: Trundle, room_map: Path) -> None:
    done = trundle("plan", room_map, "--start", "-.2,0.5,3.14", "--goal", "5,-0.3", "--robot", "turtlebot3_burger")
    assert done.code == 0, done.err
    lines = dict(line.split(maxsplit=1) for line in done.out.splitlines())
    assert lines["from"] == "x -0.200, y 0.500, yaw 3.140"
    assert lines["length"].endswith(" m")
    assert lines["time"].endswith(" ms")
    assert lines["overlay"] == "overlay.png"


def test_ends_are_picked_by_seed(trundle: Trundle, room_map: Path) -> None:
    first, same, other = (trundle("plan", room_map, "--seed", seed, "--json").json for seed in (1, 1, 2))
    assert first["poses"] == same["poses"]
    assert first["poses"] != other["poses"]
    given = trundle("plan", room_map, "--seed", 1, "--goal", "5.5,1.5,0", "--json").json
    assert given["poses"][-1] == pytest.approx([5.5, 1.5, 0.0])


def test_the_planner_is_chosen_by_name(trundle: Trundle, room_map: Path) -> None:
    done = trundle(
        "plan",
        room_map,
        "--start",
        "0.5,0.5",
        "--goal",
        "4.5,2.5",
        "--planner",
        "manhattan_astar",
        "--out",
        "a",
        "--json",
    )
    assert done.code == 0, done.err
    assert (done.json["planner"], done.json["overlay"]) == ("manhattan_astar", "a/overlay.png")


def bad(tmp_path: Path, name: str) -> Path:
    """A map that cannot be used."""
    folder = tmp_path / "maps"
    yaml, image = folder / "room.yaml", folder / "room.png"
    text = yaml.read_text()
    match name:
        case "missing":
            return folder / "none.yaml"
        case "empty":
            yaml.write_text("")
        case "binary":
            yaml.write_bytes(b"\x89PNG\r\n\x1a\n\x00\xff")
        case "no image":
            image.unlink()
        case "truncated image":
            image.write_bytes(image.read_bytes()[:100])
        case "empty image":
            image.write_bytes(b"")
        case "huge image":
            image.write_bytes(b"P5 60000 60000 255\n")
        case "image outside":
            yaml.write_text(text.replace("room.png", "../elsewhere.png"))
        case "wrong key":
            yaml.write_text(text.replace("resolution", "resolutoin"))
        case "wrong type":
            yaml.write_text(text.replace("0.05", "fine"))
        case "nan":
            yaml.write_text(text.replace("0.05", ".nan"))
        case "alias":
            yaml.write_text(text + "a: &a [1]\nb: *a\n")
        case "huge yaml":
            yaml.write_text(text + "#" * 2_000_000)
    return yaml


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("missing", "none.yaml: no such file"),
        ("empty", "the file is empty"),
        ("binary", "not a text file in UTF-8"),
        ("no image", "room.png"),
        ("truncated image", "room.png"),
        ("empty image", "room.png"),
        ("huge image", "room.png"),
        ("image outside", "room.yaml:1:"),
        ("wrong key", "the key 'resolution' is missing"),
        ("wrong type", "room.yaml:3:13: resolution"),
        ("nan", "room.yaml:3:13: resolution"),
        ("alias", "anchors and aliases are not accepted"),
        ("huge yaml", "larger than"),
    ],
)
@pytest.mark.parametrize("verb", ["plan", "run"])
def test_a_map_that_cannot_be_used(
    trundle: Trundle, room_map: Path, tmp_path: Path, verb: str, name: str, words: str
) -> None:
    done = trundle(verb, bad(tmp_path, name))
    assert done.code == 2
    assert words in done.err
    assert "Traceback" not in done.err
    assert done.out == ""
    assert [path.name for path in tmp_path.iterdir()] == ["maps"]


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (("--robot", "nova_cartr"), 2, "Did you mean 'nova_carter'?"),
        (("--robot", "none.yaml"), 2, "none.yaml: no such file"),
        (("--planner", "lest_cost"), 2, "Did you mean 'least_cost'?"),
        (("--start", "0,0,0", "--goal", "60,2"), 2, "goal"),
        (("--start", "-0.9,0", "--goal", "4,2"), 2, "start"),
        (("--start", "4", "--goal", "4,2"), 2, "X,Y or X,Y,YAW"),
        (("--out", "plan.jpg"), 2, "ends in .png"),
    ],
)
def test_bad_input_leaves_nothing(
    trundle: Trundle, room_map: Path, tmp_path: Path, arguments: tuple[str, ...], code: int, words: str
) -> None:
    done = trundle("plan", room_map, *arguments)
    assert done.code == code
    assert words in done.err
    assert len(done.err.splitlines()) == 1
    assert done.out == ""
    assert [path.name for path in tmp_path.iterdir()] == ["maps"]


@pytest.mark.slow
@pytest.mark.parametrize("door_m", [0.0, 0.4])
def test_where_there_is_no_path_the_exit_code_is_not_bad_input(trundle: Trundle, tmp_path: Path, door_m: float) -> None:
    room(door_m=door_m).save(tmp_path / "door.yaml")
    done = trundle("plan", "door.yaml", "--start", "0.5,0.5", "--goal", "5.5,0.5", "-o", "plan.png")
    assert done.code == 1
    assert done.err.startswith("trundle: ")
    assert done.out == ""
    assert not (tmp_path / "plan.png").exists()


def test_a_footprint_that_still_collides_is_not_bad_input(trundle: Trundle, tmp_path: Path) -> None:
    cells = np.zeros((160, 240), np.int8)
    cells[80, :200] = 100
    OccupancyGrid(cells, 0.05).save(tmp_path / "wall.yaml")
    ends = ("--start", "1.5,1.5,0", "--goal", "2,6,0", "--planner", "any_angle")
    assert trundle("plan", "wall.yaml", *ends).code == 0
    done = trundle("plan", "wall.yaml", *ends, "--planner-option", "max_replans=0")
    assert (done.code, "none found within 1 plan" in done.err) == (1, True)


@pytest.mark.parametrize(("goal", "code"), [("-9,0", 2), ("3.02,0.5,1.57", 2), ("5,2,1.57", 1)])
def test_a_comparison_distinguishes_bad_input_from_no_path(
    trundle: Trundle, tmp_path: Path, goal: str, code: int
) -> None:
    room(door_m=0.0).save(tmp_path / "halves.yaml")
    query = ("plan", "halves.yaml", "--start", "0,0,0", "--goal", goal)
    assert trundle(*query).code == code
    assert trundle(*query, "--compare").code == code


def test_a_goal_that_was_moved_is_reported(trundle: Trundle, room_map: Path) -> None:
    ends = ("--start", "0.5,0.5", "--robot", "turtlebot3_burger")
    done = trundle("plan", room_map, *ends, "--goal", "6.97,0.5,0", "--planner-option", "goal_tolerance=0.5")
    lines = dict(line.split(maxsplit=1) for line in done.out.splitlines())
    assert lines["moved"].startswith("the goal by 0.")
    assert "moved" not in trundle("plan", room_map, *ends, "--goal", "1.5,0.5").out


def test_a_folder_that_cannot_be_written_to(trundle: Trundle, room_map: Path, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    done = trundle("plan", room_map, "--out", "file/below")
    assert done.code == 2
    assert "file/below" in done.err
    assert "-o" in done.err
    assert done.err.count("\n") == 1


def test_a_plan_is_printed_where_its_picture_cannot_be_written(
    trundle: Trundle, room_map: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("tempfile.TemporaryFile", refuse)  # file modes do not stop root
    ends = ("--start", "0.5,0.5", "--goal", "5.5,1.5,0")
    for extra, code in (((), 0), (("-o", "there"), 2)):
        for compare in ((), ("--compare",)):
            done = trundle("plan", room_map, *ends, *extra, *compare, "--json")
            assert done.code == code
            answer = done.json["planners"][0] if compare else done.json
            assert answer["length_m"] > 5.0
            assert done.json["overlay"] is None
            assert done.err.count("\n") == 1
            assert "Permission denied; give another place with -o" in done.err
    assert "not written" in trundle("plan", room_map, *ends).out


def test_movingai_maps_are_planned_on(trundle: Trundle, tmp_path: Path) -> None:
    rows = "\n".join(["@" * 24, *["@" + "." * 22 + "@"] * 12, "@" * 24])
    (tmp_path / "small.map").write_text(f"type octile\nheight 14\nwidth 24\nmap\n{rows}\n")
    grid = OccupancyGrid.load(tmp_path / "small.map")
    x, y = grid.cell_to_world(7, 4)
    far, _ = grid.cell_to_world(7, 18)
    done = trundle("plan", "small.map", "--start", f"{x},{y}", "--goal", f"{far},{y}", "--json")
    assert done.code == 0, done.err


def test_all_planners_are_compared_on_one_query(trundle: Trundle, room_map: Path, tmp_path: Path) -> None:
    ends = ["--start", "0,0,0", "--goal", "5,2,1.57"]
    done = trundle("plan", room_map, *ends, "--compare", "-o", tmp_path / "all.png", "--json")
    assert done.code == 0, done.err
    rows = {row["planner"]: row for row in done.json["planners"]}
    assert set(rows) == set(planner_names())
    assert all(row["length_m"] >= 5.38 and row["planning_ms"] > 0.0 for row in rows.values())
    assert rows["manhattan_astar"]["length_m"] > rows["astar"]["length_m"] > rows["any_angle"]["length_m"] - 1e-6
    with Image.open(tmp_path / "all.png") as picture:
        assert picture.width > 800
    table = trundle("plan", room_map, *ends, "--compare", "-o", tmp_path / "all.png").out
    assert [line.split()[0] for line in table.splitlines()[1:-1]] == sorted(planner_names())


def test_a_comparison_leaves_the_yaw_open_of_a_goal_without_one(trundle: Trundle, room_map: Path) -> None:
    turning = []
    for goal in ("5,2", "5,2,0"):
        done = trundle("plan", room_map, "--start", "0,0,0", "--goal", goal, "--compare", "--json")
        turning.append({row["planner"]: row["turning_rad"] for row in done.json["planners"]}["least_cost"])
    assert turning[0] < turning[1] - 0.1


def test_a_comparison_without_any_path_says_why_and_leaves_no_picture(trundle: Trundle, tmp_path: Path) -> None:
    room(door_m=0.0).save(tmp_path / "halves.yaml")
    options = ["--start", "0,0,0", "--goal", "5,2,1.57", "--compare", "-o", tmp_path / "all.png"]
    done = trundle("plan", tmp_path / "halves.yaml", *options)
    assert done.code == 1
    assert "separated by occupied" in done.out
    assert not (tmp_path / "all.png").exists()


@pytest.mark.slow
def test_masks_turn_the_path_aside_and_are_drawn(trundle: Trundle, room_map: Path, tmp_path: Path) -> None:
    ends = ("--start", "0,0.5,0", "--goal", "6,0.5,0", "--robot", "turtlebot3_burger", "--json")
    zone = OccupancyGrid(np.full((10, 10), 100, dtype=np.int8), 0.1, Pose2D(2.5, 0.0))
    zone.save(tmp_path / "zones.yaml")
    OccupancyGrid(np.full((5, 5), 50, dtype=np.int8), 0.2, Pose2D(4.5, 1.5)).save(tmp_path / "limits.yaml", mode="raw")
    straight = trundle("plan", room_map, *ends).json
    done = trundle("plan", room_map, *ends, "--keepout", "zones.yaml", "--speed-mask", "limits.yaml")
    assert done.code == 0, done.err
    assert done.json["length_m"] > straight["length_m"] + 0.05
    with Image.open(tmp_path / "overlay.png") as picture:
        assert KEPT_OUT in {color for _, color in picture.getcolors(1 << 24) or ()}
    limit = SpeedMask.load(tmp_path / "limits.yaml")
    slow = SpeedZones(limit, Robot.load("turtlebot3_burger").limits.linear_speed).marks()[0].color
    done = trundle("plan", room_map, *ends, "--keepout", "zones.yaml", "--speed-mask", "limits.yaml", "--compare")
    assert done.code == 0, done.err
    with Image.open(tmp_path / "overlay.png") as picture:
        assert {KEPT_OUT, slow} <= {color for _, color in picture.getcolors(1 << 24) or ()}
    bad = trundle("plan", room_map, *ends, "--speed-mask", "zones.yaml", "--keepout", "none.yaml")
    assert (bad.code, "none.yaml" in bad.err) == (2, True)


def test_a_partial_path_through_costly_unknown_space(trundle: Trundle, tmp_path: Path) -> None:
    data = np.zeros((60, 140), np.int8)
    data[:, 60:70] = -1
    data[:, 110:112] = 100
    OccupancyGrid(data, 0.05).save(tmp_path / "hall.yaml")
    query = ("plan", "hall.yaml", "--start", "1,1.5,0", "--goal", "6.4,1.5", "--robot", "turtlebot3_burger", "--json")
    assert trundle(*query).code == 1
    assert trundle(*query, "--unknown", "costly").code == 1
    done = trundle(*query, "--unknown", "costly", "--unknown-cost", 50, "--partial")
    assert (done.code, done.json["status"]) == (0, "partial")
    assert 0.9 < done.json["remaining_m"] < 1.2
    assert done.json["poses"][-1][0] > 5.0
    short = trundle(*query, "--partial", "--planner-option", "spacing=0.02")
    assert short.json["poses"][-1][0] < 3.0
    late = trundle(*query, "--unknown", "free", "--deadline", "1e-9")
    assert late.code == 1
    assert "deadline of 1e-09 s" in late.err
    for wrong in (
        ("--deadline", 0),
        ("--planner-option", "speed=3"),
        ("--planner-option", "x"),
        ("--unknown-cost", 300),
    ):
        assert trundle(*query, "--unknown", "costly", *wrong).code == 2
    assert trundle(*query, "--compare", "--partial").code == 2


def test_a_smoothed_plan_is_drawn_with_the_planned_one(trundle: Trundle, room_map: Path, tmp_path: Path) -> None:
    ends = ["--start", "0,0,0", "--goal", "5,2,1.57", "--planner", "astar", "--json"]
    planned = trundle("plan", room_map, *ends).json
    done = trundle("plan", room_map, *ends, "--smoother", "constrained")
    assert done.code == 0, done.err
    assert (planned["smoother"], done.json["smoother"]) == (None, "constrained")
    assert done.json["poses"] != planned["poses"]
    assert done.json["poses"][-1] == planned["poses"][-1]
    with Image.open(tmp_path / "overlay.png") as picture:
        assert {PLANNED, BAD} <= {color for _, color in picture.getcolors(1 << 24) or ()}
    compared = trundle("plan", room_map, *ends[:4], "--smoother", "constrained", "--compare", "--json")
    rows = {row["planner"]: row for row in compared.json["planners"]}
    assert rows["astar"]["length_m"] != pytest.approx(planned["length_m"])
    unknown = trundle("plan", room_map, *ends, "--smoother", "constraint")
    assert (unknown.code, "Did you mean 'constrained'?" in unknown.err) == (2, True)


def test_a_path_that_touches_something_is_no_success(
    trundle: Trundle, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(PLANNERS._builtin, "straight", "support.planners:StraightPlanner")
    room(door_m=1.5).save(tmp_path / "door.yaml")
    ends = ("--start", "0.5,0", "--goal", "5.5,0")
    done = trundle("plan", "door.yaml", "--planner", "straight", *ends, "--json")
    assert done.code == 1
    assert done.json["touches"][0] == pytest.approx(2.8, abs=0.2)
    assert "the path of planner 'straight' collides at (2." in done.err
    free = trundle("plan", "door.yaml", "--planner", "straight", *ends[:3], "1.5,0", "--json")
    assert (free.code, free.json["touches"]) == (0, None)
