"""trundle evaluate barn, and dynabarn."""

import json
from pathlib import Path

import numpy as np
import pytest

from support.public_worlds import write_barn, write_dynabarn
from trundle.cli.evaluate.public import DriveOptions

QUICK = ("--backend", "kinematic", "--quiet", "--workers", "1")


@pytest.fixture
def barn(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for number in (0, 7):
        write_barn(tmp_path / "BARN", number)
    return tmp_path / "BARN"


@pytest.fixture
def dynabarn(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_dynabarn(tmp_path / "worlds.json")
    return tmp_path / "worlds.json"


@pytest.mark.slow
def test_barn_prints_its_score_and_writes_the_column(trundle, barn):
    done = trundle("evaluate", "barn", "--worlds", str(barn), "--seeds", "2", "-o", "runs/b", *QUICK)
    assert done.code == 0
    assert "barn score" in done.out
    assert "4 arrived" in done.out
    rows = trundle("evaluate", "show", "runs/b", "--json").json
    assert {row["world"] for row in rows} == {"world_0", "world_7"}
    assert {row["robot"] for row in rows} == {"jackal_2mps"}
    assert all(0.125 <= row["barn_score"] <= 0.5 for row in rows)
    assert all(row["shortest_time_s"] < row["time_s"] for row in rows)


@pytest.mark.slow
def test_the_same_command_continues_and_judges_the_score(trundle, barn):
    command = ("evaluate", "barn", "--worlds", str(barn), "--seeds", "1", "-o", "runs/b", *QUICK)
    assert trundle(*command, "--require", "barn_score>=0.125").code == 0
    assert trundle(*command, "--require", "barn_score>=0.501").code == 1
    progress, last = map(json.loads, trundle(*command, "--json").out.splitlines())
    assert progress["resumed"] == 2
    assert 0.125 <= last["barn_score"] <= 0.5
    assert last["mean_time_s"] > last["mean_shortest_time_s"]


@pytest.mark.slow
def test_every_failure_has_the_command_that_runs_it_again(trundle, barn):
    write_barn(barn, 9, [(x, 6.0) for x in np.arange(-2.5, -1.9, 0.15)] + [(-2.25, 3.0)])  # one on the start
    done = trundle("evaluate", "barn", "--worlds", str(barn), "--only", "9", "--seeds", "1", "-o", "runs/b", *QUICK)
    assert done.code == 0
    (line,) = [line for line in done.out.splitlines() if "trundle run --from" in line]
    again = trundle(*line.split()[1:], "-o", "again", "--quiet", "--no-video")
    assert again.code == 1
    assert json.loads(Path("again/episode.json").read_text())["outcome"] != "arrived"


def test_speeds_are_crossed():
    robots = DriveOptions(speed="1,2.5").robots()
    assert [robot["name"] for robot in robots] == ["jackal_1mps", "jackal_2.5mps"]


@pytest.mark.slow
def test_dynabarn_prints_the_success_of_each_level(trundle, dynabarn):
    command = ("evaluate", "dynabarn", "--worlds", str(dynabarn), "--phases", "1", "-o", "runs/d")
    done = trundle(*command, *QUICK)
    assert done.code == 0
    assert "success easy" in done.out
    assert "success hard" in done.out


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--worlds", "nowhere"), "no such folder"),
        (("--worlds", "BARN", "--only", "3"), "no world_3.world"),
        (("--worlds", "BARN", "--only", "0:x"), "give numbers of worlds"),
        (("--worlds", "BARN", "--only", "0,0"), "a world is there twice"),
        (("--worlds", "BARN", "--only", "5:5"), "names no world"),
        (("--worlds", "BARN", "--seeds", "0"), "no seeds"),
        (("--worlds", "BARN", "--speed", "fast"), "--speed 'fast'"),
        (("--worlds", "BARN", "--speed=-1"), "linear_speed"),
        (("--worlds", "BARN", "--noise=-1"), "noise"),
        (("--worlds", "BARN", "--scan-age", "9"), "scan_age_s"),
        (("--worlds", "BARN", "--controller", "mpppi"), "unknown controller"),
        (("--worlds", "BARN", "--planner", "auto,astar", "--planner-option", "a=1"), "several planners"),
        (("--worlds", "BARN", "--robot", "jakal"), "Did you mean 'jackal'"),
        (("--worlds", "BARN", "-o", "BARN/world_0.world"), "BARN/world_0.world"),
    ],
)
def test_mistakes_are_named_before_a_folder_is_made(trundle, barn, options, message):
    failed = trundle("evaluate", "barn", *options, "--quiet")
    assert failed.code == 2
    assert message in failed.err
    assert not (barn.parent / "runs").exists()


def test_mistakes_in_the_file_of_dynabarn_are_named(trundle, dynabarn):
    dynabarn.write_text(dynabarn.read_text()[:-40])
    failed = trundle("evaluate", "dynabarn", "--worlds", str(dynabarn), "--quiet")
    assert failed.code == 2
    assert "not JSON" in failed.err
    write_dynabarn(dynabarn)
    failed = trundle("evaluate", "dynabarn", "--worlds", str(dynabarn), "--levels", "hardest", "--quiet")
    assert "Did you mean 'hard'" in failed.err
    assert not (dynabarn.parent / "runs").exists()


def test_the_folder_of_a_run_is_not_written_into(trundle, barn, tmp_path):
    (tmp_path / "r").mkdir()
    (tmp_path / "r" / "episode.json").write_text("{}")
    failed = trundle("evaluate", "barn", "--worlds", str(barn), "-o", "r", *QUICK)
    assert failed.code == 2
    assert "give another folder with -o" in failed.err
    assert [path.name for path in (tmp_path / "r").iterdir()] == ["episode.json"]


@pytest.mark.slow
def test_both_spellings_of_what_is_crossed_are_taken(trundle, barn, room_map):
    given = ("--controllers", "regulated_pure_pursuit", "--planners", "auto", "--backends", "kinematic", "--seed", "1")
    done = trundle("evaluate", "barn", "--worlds", str(barn), "--only", "7", *given, "-o", "runs/b", "--quiet")
    assert done.code == 0, done.err
    given = ("--controller", "regulated_pure_pursuit", "--planner", "auto", "--backend", "kinematic", "--seed", "1")
    done = trundle("evaluate", room_map, "--robot", "nova_carter", *given, "-o", "runs/room", "--quiet")
    assert done.code == 0, done.err


@pytest.mark.parametrize("text", ["10", "m", "-5s", "1d", "0s", "2000h", "1.5h"])
def test_a_time_budget_that_is_no_time_is_refused(trundle, text):
    done = trundle("evaluate", "smoke", f"--time-budget={text}")
    assert done.code == 2
    assert f"--time-budget {text}: give a time" in done.err
