import json

import pytest

from support.faulty_planner import FaultyPlanner
from trundle.evaluation.row import MEASURED


@pytest.fixture
def suite(room_map, tmp_path):
    (tmp_path / "suite.yaml").write_text(
        f"name: rooms\nworlds: [{room_map}]\nbackends: kinematic\nplanners: [auto, astar]\nmissions: 2\n"
    )
    return tmp_path / "suite.yaml"


@pytest.mark.slow
def test_maps_and_worlds_need_no_file(trundle, room_map):
    done = trundle(
        "evaluate", room_map, "--planners", "auto,astar", "--backends", "kinematic", "--seeds", "0:2", "-o", "a"
    )
    assert done.code == 0, done.err
    assert "4" in done.out.splitlines()[0]
    assert "100.0 %" in done.out
    assert "4/4" in done.err


def test_seeds_on_the_command_line_are_those_of_worlds_with_missions_of_their_own(trundle, room_map, tmp_path):
    (tmp_path / "own.yaml").write_text(
        f"worlds:\n  - {room_map}\n  - {{name: {room_map}, label: tight, missions: {{seeds: 50, ends: tight}}}}\n"
        "backends: kinematic\nmissions: 60\n"
    )
    assert trundle("evaluate", "own.yaml", "--seeds", "3:5", "-o", "a", "--quiet").code == 0
    rows = trundle("evaluate", "show", "a", "--json").json
    assert sorted((row["world"], row["seed"]) for row in rows) == [("room", 3), ("room", 4), ("tight", 3), ("tight", 4)]


@pytest.mark.slow
def test_a_suite_drives_in_maps_that_are_given_besides(trundle, suite, room_map, tmp_path):
    (tmp_path / "maze.yaml").write_text("worlds: {name: cylinders, seed: 3}\nbackends: kinematic\nmissions: 9\n")
    assert trundle("evaluate", "maze.yaml", room_map, "--seeds", "2", "-o", "a", "--quiet").code == 0
    rows = trundle("evaluate", "show", "a", "--json").json
    assert [(row["world"], row["seed"]) for row in rows] == [
        (name, k) for name in ("cylinders", "room") for k in (0, 1)
    ]
    done = trundle("evaluate", "maze.yaml", suite, "-o", "b")
    assert done.code == 2
    assert "give one suite, with maps and worlds" in done.err
    done = trundle("evaluate", "maze.yaml", "ofice", "-o", "b")
    assert done.code == 2
    assert "office" in done.err


@pytest.mark.slow
def test_the_errors_of_a_localizer_are_columns_and_can_be_required(trundle, room_map, tmp_path):
    (tmp_path / "start.yaml").write_text(
        f"worlds: [{room_map}]\nbackends: kinematic\nmissions: 2\nlocalizer: odometry\n"
        "start_error: [null, {distance: 0.1}]\n"
    )
    assert trundle("evaluate", "start.yaml", "-o", "a", "--quiet").code == 0
    for row in trundle("evaluate", "show", "a", "--json").json:
        error = 0.1 if "distance" in row["settings"] else 0.0
        assert row["localization_error_m"] == pytest.approx(error, abs=1e-6)
        assert row["localization_error_p95_m"] == pytest.approx(error, abs=1e-6)
        assert row["lost_s"] == 0.0
    assert trundle("evaluate", "report", "a", "--require", "localization_error_p95_m<=0.2").code == 0
    assert trundle("evaluate", "report", "a", "--require", "localization_error_m<=0.01").code == 1
    assert "mean error of the estimate" in (tmp_path / "a" / "report.html").read_text()


def test_a_localizer_that_sees_needs_no_file_of_a_suite(trundle, room_map):
    given = ("evaluate", room_map, "--backend", "kinematic", "--seed", "0:1", "--localizer", "amcl", "--lidar")
    done = trundle(*given, "-o", "a", "--quiet", "--json")
    assert done.code == 0, done.err
    (row,) = trundle("evaluate", "show", "a", "--json").json
    assert row["outcome"] == "arrived"
    assert 0.0 < row["localization_error_m"] < 0.1


def test_a_suite_is_run_shown_reported_and_compared(trundle, suite, tmp_path):
    assert trundle("evaluate", suite, "-o", "a", "--quiet").code == 0
    assert trundle("evaluate", suite, "-o", "b", "--planners", "astar", "--quiet").code == 0
    shown = trundle("evaluate", "show", "a", "--json")
    assert [row["planner"] for row in shown.json] == ["auto", "astar"] * 2
    assert trundle("evaluate", "show", "a", "--failed").out == "no such episode\n"
    assert trundle("evaluate", "report", "a", "--require", "success>=0.3").code == 0
    failed = trundle("evaluate", "report", "a", "--require", "success>=0.99")
    assert failed.code == 1
    assert "more" in failed.out
    compared = trundle("evaluate", "compare", "a", "b", "--json")
    assert compared.code == 0
    assert compared.json["worse"] is False
    assert {path.name for path in (tmp_path / "a").iterdir()} >= {
        "suite.yaml",
        "journal.jsonl",
        "parts",
        "report.html",
        "junit.xml",
        "summary.json",
    }


def test_a_finished_evaluation_is_not_run_again(trundle, suite):
    trundle("evaluate", suite, "-o", "a", "--quiet")
    lines = trundle("evaluate", suite, "-o", "a", "--json").out.splitlines()
    assert json.loads(lines[0])["resumed"] == json.loads(lines[0])["total"] == 4
    assert json.loads(lines[-1])["episodes"] == 4


@pytest.mark.slow
def test_an_episode_is_run_again_with_its_pictures(trundle, suite, tmp_path):
    trundle("evaluate", suite, "-o", "a", "--quiet")
    row = trundle("evaluate", "show", "a", "--json").json[1]
    done = trundle("run", "--from", f"a:{row['id'][:6]}", "-o", "again", "--no-video", "--json")
    assert done.code == 0, done.err
    assert done.json["time_s"] == row["time_s"]
    assert done.json["planner"] == "astar"
    assert (tmp_path / "again" / "overlay.png").exists()


@pytest.mark.slow
def test_failed_episodes_are_listed_with_the_command_that_repeats_them(trundle, room_map, tmp_path):
    (tmp_path / "suite.yaml").write_text(
        f"worlds: [{room_map}]\nbackends: kinematic\n"
        f"planners: [{{name: '{FaultyPlanner.__module__}:FaultyPlanner', label: faulty}}]\n"
        "missions: [{start: [2.5, 0.0], goal: [5.0, 1.0]}]\n"
    )
    trundle("evaluate", "suite.yaml", "-o", "a", "--quiet")
    shown = trundle("evaluate", "show", "a", "--failed").out
    assert "error" in shown
    assert "trundle run --from a:" in shown
    assert "planted" in shown


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "give a suite"),
        (["smok"], "Did you mean 'smoke'"),
        (["room.yaml", "--planners", "astr"], "astar"),
        (["room.yaml", "--planners", ""], "planners"),
        (["room.yaml", "--require", "sucess>=0.9"], "success"),
        (["room.yaml", "--require", "success[planner=astar]>=0.9"], "astar"),
        (["room.yaml", "--seeds", "0:1000000000"], "1,000,000,000 episodes"),
        (["room.yaml", "--workers", "0"], "workers"),
        (["room.yaml", "--localizers", "amcl"], "by the scans of its lidars: give lidar: true, or --lidar"),
        (["smoke", "tight"], "give one suite, with maps"),
        (["room.yaml", "--controllers", "lookahed"], "'lookahead'"),
        (["room.yaml", "--robots", "nova_cater"], "'nova_carter'"),
        (["room.yaml", "--seeds", "5:5"], "no episodes"),
        (["room.yaml", "--require", "success=>0.9"], "'success>=0.99'"),
        (["room.yaml", "--require", "success[planer=auto]>=0.9"], "'planner'"),
        (["missing.yaml"], "missing.yaml: no such file"),
        (["report", "room.yaml"], "this is a map"),
        (["show", "nowhere"], "no such folder"),
        (["compare", "nowhere", "nowhere"], "no such folder"),
    ],
)
def test_bad_input_is_named(trundle, room_map, tmp_path, arguments, words):
    room_map.rename(tmp_path / "room.yaml")
    for image in room_map.parent.iterdir():
        image.rename(tmp_path / image.name)
    done = trundle("evaluate", *arguments)
    assert done.code == 2
    assert words in done.err, done.err
    assert "Traceback" not in done.err
    assert not (tmp_path / "runs").exists()


def unmeasured(row):
    return {name: value for name, value in row.items() if name not in MEASURED}


@pytest.mark.slow
def test_what_was_damaged_is_named_and_runs_again(trundle, suite, tmp_path):
    trundle("evaluate", suite, "-o", "a", "--quiet")
    rows = trundle("evaluate", "show", "a", "--json").json
    (part,) = (tmp_path / "a" / "parts").glob("*.parquet")
    part.write_bytes(part.read_bytes()[:2000])
    with (tmp_path / "a" / "journal.jsonl").open("a") as journal:
        journal.write('{"id": \n')
    again = trundle("evaluate", suite, "-o", "a", "--quiet")
    assert again.code == 0, again.err
    damage = again.err.splitlines()
    assert len(damage) == 2
    assert "parquet: it is damaged" in damage[0]
    assert "journal.jsonl:1: this line holds no row" in damage[1]
    assert all("again" in line for line in damage)
    shown = trundle("evaluate", "show", "a", "--json").json
    assert [unmeasured(row) for row in shown] == [unmeasured(row) for row in rows]


@pytest.mark.slow
def test_a_map_that_is_gone_when_an_evaluation_is_continued_is_named_and_no_row_is_lost(trundle, suite, room_map):
    trundle("evaluate", suite, "-o", "a", "--quiet")
    image = room_map.with_suffix(".png")
    aside = image.rename(image.with_suffix(".aside"))
    gone = trundle("evaluate", suite, "-o", "a")
    assert gone.code == 2
    assert gone.err.count("\n") == 1
    assert "room.png: no such file" in gone.err
    assert trundle("evaluate", "report", "a").code == 0
    aside.rename(image)
    assert json.loads(trundle("evaluate", suite, "-o", "a", "--json").out.splitlines()[0])["resumed"] == 4


@pytest.mark.slow
def test_the_other_kind_of_folder_is_answered_with_the_right_verb(trundle, suite, room_map):
    trundle("evaluate", suite, "-o", "a", "--quiet")
    ends = ["--start", "2.5,0", "--goal", "5,1"]
    run = trundle("run", room_map, *ends, "--backend", "kinematic", "--no-video", "-o", "r", "--quiet")
    assert run.code == 0, run.err
    for arguments, words in [
        (["evaluate", "report", "r"], "trundle compare"),
        (["evaluate", "compare", "a", "r"], "trundle compare"),
        (["evaluate", "show", "r"], "trundle compare"),
        (["compare", "a", "a"], "trundle evaluate compare"),
        (["evaluate", "a"], "trundle evaluate a/suite.yaml -o a"),
        (["run", "a"], "trundle run --from a:ID"),
        (["run", suite], "trundle evaluate"),
        (["evaluate", "report", suite], "trundle evaluate"),
        (["evaluate", suite, "-o", "r"], "another folder with -o"),
        (["evaluate", "smoke", "-o", "a"], "another suite, 'rooms'"),
    ]:
        done = trundle(*arguments)
        assert done.code == 2, arguments
        assert words in done.err, done.err


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--from", "a"], "FOLDER:ID"),
        (["--from", "a:000000000000"], "no episode"),
        (["--from", "a:1", "--seed", "3"], "exactly"),
        ([], "--from"),
    ],
)
def test_what_cannot_be_repeated_is_named(trundle, suite, arguments, words):
    trundle("evaluate", suite, "-o", "a", "--quiet")
    done = trundle("run", *arguments)
    assert done.code == 2
    assert words in done.err, done.err
