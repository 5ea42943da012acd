import csv
import math
import signal
import subprocess
from pathlib import Path

import pytest

from support.command_line import Trundle, stopped

COMMANDS = ("--command", "0.4,0,2", "--command", "0,0.5,2", "--command", "-0.2,-0.3,1.02")


@pytest.mark.parametrize("backend", ["kinematic", "mujoco"])
def test_commands_end_where_the_twists_lead(trundle: Trundle, tmp_path: Path, backend: str) -> None:
    done = trundle("drive", "nova_carter", *COMMANDS, "--backend", backend, "--json", "--out", "drive")
    assert done.code == 0, done.err
    first, second, third = done.json
    assert (first["v"], first["w"], first["seconds"]) == (0.4, 0.0, 2.0)
    # 0.4 m/s for 2 s less half of the 0.16 s that 2.5 m/s² takes.
    assert first["x"] == pytest.approx(0.4 * (2.0 - 0.08), abs=0.02)
    assert first["y"] == pytest.approx(0.0, abs=0.01)
    assert first["twist"]["v"] == pytest.approx(0.4, abs=0.01)
    assert first["wheel_speeds"]["left"] == pytest.approx(0.4 / 0.14, abs=0.1)
    assert second["yaw"] - first["yaw"] == pytest.approx(0.5 * (2.0 - 0.08), abs=0.05)
    assert third["twist"]["v"] < 0.0
    with (tmp_path / "drive" / "drive.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    assert float(rows[0]["time_s"]) == 0.0
    assert float(rows[-1]["time_s"]) == pytest.approx(5.02)
    assert math.isclose(float(rows[-1]["x"]), third["x"], abs_tol=1e-6)
    assert float(rows[-1]["command_v"]) == -0.2
    assert float(rows[40]["wheel_right"]) == pytest.approx(first["wheel_speeds"]["right"], abs=1e-6)


def test_the_table_names_the_record(trundle: Trundle) -> None:
    done = trundle("drive", "nova_carter", "--command", "0.4,0,1", "--backend", "kinematic")
    assert done.code == 0
    lines = done.out.splitlines()
    assert lines[0].split()[:6] == ["v", "w", "seconds", "x", "y", "yaw"]
    record = Path(lines[-1].split(maxsplit=1)[1])
    assert record.is_file()
    assert record.parts[0] == "runs"


def test_a_wall_is_touched_and_named(trundle: Trundle, room_map: Path) -> None:
    done = trundle("drive", "nova_carter", "--command", "0.8,0,10", "--world", room_map, "--start", "0.5,0.5", "--json")
    assert done.code == 0, done.err
    assert done.json[0]["contacts"]
    assert done.json[0]["x"] < 7.0


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((), "give one of: --command"),
        (("--command", "1,0,1", "--teleop"), "give one of: --command"),
        (("--command", "1,0"), "V,W,SECONDS"),
        (("--command", "1,0,0"), "SECONDS must be above 0"),
        (("--command", "1,0,0.333"), "multiple of 0.005"),
        (("--command", "nan,0,1"), "finite numbers"),
        (("--command", "1,0,1", "--start", "1"), "--start '1'"),
        (("--command", "1,0,1", "--backend", "mujco"), "Did you mean 'mujoco'?"),
        (("--command", "1,0,1", "--world", "warehose"), "Did you mean 'warehouse'?"),
        (("--command", "1,0,1", "--world", "none.yaml"), "none.yaml: no such file"),
        (("--command", "1,0,1", "--set", "a=1"), "give --world as well"),
        (("--teleop",), "standard input is not a terminal"),
    ],
)
def test_bad_input_leaves_nothing(
    trundle: Trundle, tmp_path: Path, arguments: tuple[str, ...], words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    done = trundle("drive", "nova_carter", *arguments)
    assert done.code == 2
    assert words in done.err
    assert done.out == ""
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_ctrl_c_keeps_what_was_driven(tmp_path: Path) -> None:
    command = stopped(signal.SIGINT, "drive", "nova_carter", "--command=0.4,0,3600", "--out=out")
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "interrupted\n")
    assert 90 < len((tmp_path / "out" / "drive.csv").read_text().splitlines()) < 110
