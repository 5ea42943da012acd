import json

import pytest

from trundle.cli.entry import run_command
from trundle.cli.shared.termination import BAD_INPUT, DONE, NOT_THERE
from trundle.extras import install_line

RUN = ["run", "warehouse", "--seed", "4", "--backend", "kinematic", "--time-limit", "2", "--no-video", "--quiet"]


def test_a_run_is_recorded_listed_and_made_a_run_again(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run_command([*RUN, "--record", "--distro", "kilted", "-o", "recorded"]) == NOT_THERE
    assert "record: {name: mcap, distro: kilted}" in (tmp_path / "recorded/scenario.yaml").read_text()
    assert "run.mcap" in json.loads((tmp_path / "recorded/episode.json").read_text())["files"]
    assert not (tmp_path / "recorded/run.partial.mcap").exists()
    capsys.readouterr()
    assert run_command(["record", "info", "recorded/run.mcap", "--json"]) == DONE
    facts = json.loads(capsys.readouterr().out)
    assert facts["complete"]
    assert facts["distro"] == "kilted"
    assert facts["outcome"] == "timed_out"
    assert run_command(["record", "info", "recorded/run.mcap"]) == DONE
    assert "/ground_truth/odom" in capsys.readouterr().out
    assert run_command(["record", "to-run", "recorded/run.mcap", "-o", "again", "--json", "--quiet"]) == DONE
    again = json.loads(capsys.readouterr().out)
    assert again["outcome"] == "timed_out"
    assert {"map.yaml", "map.png", "scenario.yaml", "trajectory.npz"} <= {
        one.name for one in (tmp_path / "again").iterdir()
    }
    assert run_command(["record", "recover", "recorded/run.mcap", "-o", "copy.mcap", "--json"]) == DONE
    assert json.loads(capsys.readouterr().out)["damage"] is None


def test_what_a_killed_run_left_is_not_overwritten_unasked(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "recorded").mkdir()
    (tmp_path / "recorded/run.partial.mcap").write_bytes(b"")
    assert run_command([*RUN, "--record", "-o", "recorded"]) == BAD_INPUT
    assert "trundle record recover" in capsys.readouterr().err


def test_a_drive_is_recorded_too(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    drive = ["drive", "nova_carter", "--command", "0.4,0,1", "--backend", "kinematic", "--record", "-o", "driven"]
    assert run_command(drive) == DONE
    assert sorted(one.name for one in (tmp_path / "driven").iterdir() if one.name[0] != ".") == [
        "drive.csv",
        "run.mcap",
    ]
    capsys.readouterr()
    assert run_command(["record", "to-run", "driven/run.mcap"]) == BAD_INPUT
    assert "no map" in capsys.readouterr().err


def test_a_distribution_needs_a_recording(tmp_path, capsys):
    assert run_command([*RUN, "--distro", "humble", "-o", str(tmp_path / "x")]) == BAD_INPUT
    assert "give --record with it" in capsys.readouterr().err


def test_without_the_extra_one_message_names_the_install_line(tmp_path, capsys, monkeypatch):
    import importlib.util

    find = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda name, *more: None if name == "rosbags" else find(name, *more)
    )
    for command in ([*RUN, "--record", "-o", str(tmp_path / "x")], ["record", "info", str(tmp_path / "x.mcap")]):
        assert run_command(command) == BAD_INPUT
        message = capsys.readouterr().err
        assert f"needs rosbags, which is not installed. Install it with: {install_line('record')}" in message


@pytest.mark.parametrize("verb", ["info", "recover", "to-run"])
def test_a_bag_that_is_not_there_is_one_message(verb, tmp_path, capsys):
    assert run_command(["record", verb, str(tmp_path / "none.mcap")]) == BAD_INPUT
    message = capsys.readouterr().err
    assert "none.mcap" in message
    assert "Traceback" not in message
