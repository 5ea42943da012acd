from pathlib import Path

import pytest
from PIL import Image

from support.command_line import Trundle


@pytest.fixture
def two_drives(trundle: Trundle, tmp_path: Path) -> tuple[Path, Path]:
    one, other = tmp_path / "one", tmp_path / "other"
    options = ["--start", "1,2,0.5", "--command", "0.4,0.3,3", "--command", "0,-0.5,1.5"]
    assert trundle("drive", "nova_carter", *options, "-o", one).code == 0
    assert trundle("drive", "nova_carter", "--like", one, "--backend", "kinematic", "-o", other).code == 0
    return one, other


def test_one_log_by_two_simulators_stays_close(trundle: Trundle, two_drives: tuple[Path, Path], tmp_path: Path) -> None:
    done = trundle("compare", two_drives[1], two_drives[0], "-o", tmp_path / "both.png", "--json")
    assert done.code == 0, done.err
    assert done.err == ""
    assert 0.0 < done.json["max_position_error_m"] < 0.02
    assert 0.0 < done.json["max_yaw_error_rad"] < 0.02
    assert done.json["max_command_difference"] == 0.0
    assert done.json["duration_s"] == pytest.approx(4.5)
    with Image.open(tmp_path / "both.png") as picture:
        assert picture.width > 1000


def test_a_drive_equals_itself(trundle: Trundle, two_drives: tuple[Path, Path], tmp_path: Path) -> None:
    done = trundle("compare", two_drives[0], two_drives[0], "-o", tmp_path)
    assert done.code == 0
    assert "largest distance           0.0 mm" in done.out
    assert (tmp_path / "compare.png").is_file()


def test_other_commands_are_remarked_on(trundle: Trundle, two_drives: tuple[Path, Path], tmp_path: Path) -> None:
    third = tmp_path / "third"
    trundle("drive", "nova_carter", "--start", "1,2,0.5", "--command", "0.1,0,4.5", "-o", third)
    done = trundle("compare", two_drives[0], third, "-o", tmp_path)
    assert "not driven by the same commands" in done.err
    assert "the runs end" not in done.err


def test_a_run_that_ended_early_is_remarked_on(trundle: Trundle, two_drives: tuple[Path, Path], tmp_path: Path) -> None:
    rows = (two_drives[1] / "drive.csv").read_text().splitlines()
    (two_drives[1] / "drive.csv").write_text("\n".join(rows[:42]) + "\n")
    done = trundle("compare", *two_drives, "-o", tmp_path, "--json")
    assert done.code == 0
    assert "the runs end after 4.50 and 2.00 s, and are compared up to 2.00 s" in done.err
    assert done.json["duration_s"] == pytest.approx(2.0)


def test_a_run_is_compared_with_a_drive_of_its_commands(trundle: Trundle, tmp_path: Path) -> None:
    ends = ["--start", "-13,0,0", "--goal", "-11,0", "--seed", "7"]
    run = trundle("run", "warehouse", *ends, "--backend", "kinematic", "--no-video", "-o", tmp_path / "run", "--quiet")
    assert run.code == 0, run.err
    options = ["--world", "warehouse", "--seed", "7", "--backend", "kinematic", "-o", tmp_path / "drive"]
    assert trundle("drive", "nova_carter", "--like", tmp_path / "run", *options).code == 0
    done = trundle("compare", tmp_path / "run", tmp_path / "drive", "-o", tmp_path, "--json")
    assert done.code == 0, done.err
    assert done.json["max_position_error_m"] < 1e-5


def test_bad_input_is_refused(trundle: Trundle, tmp_path: Path) -> None:
    assert trundle("compare", tmp_path, tmp_path).code == 2
    done = trundle("drive", "nova_carter", "--like", tmp_path / "none", "-o", tmp_path / "x")
    assert done.code == 2
    assert not (tmp_path / "x").exists()
    assert trundle("drive", "nova_carter", "--like", tmp_path, "--teleop").code == 2


def test_a_run_whose_periods_cannot_be_repeated_is_refused(trundle: Trundle, tmp_path: Path) -> None:
    columns = "time_s,x,y,yaw,command_v,command_w,v,w"
    rows = "".join(f"{step / 30.0:.6f},0,0,0,0.4,0,0.4,0\n" for step in range(4))
    (tmp_path / "drive.csv").write_text(f"{columns}\n{rows}")
    done = trundle("drive", "nova_carter", "--like", tmp_path, "--backend", "kinematic", "-o", tmp_path / "x")
    assert done.code == 2
    assert "a control period of 0.033333 s, which is not a multiple of 0.005 s" in done.err
    assert not (tmp_path / "x").exists()


def test_a_run_is_named_after_its_folder_wherever_one_stands(
    trundle: Trundle, two_drives: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    named = []
    monkeypatch.setattr(
        "trundle.record.compare.draw_comparison",
        lambda _, names: named.append(names) or Image.new("RGB", (8, 8)),
    )
    monkeypatch.chdir(two_drives[0])
    assert trundle("compare", ".", "../other", "-o", tmp_path).code == 0
    assert named == [("one", "other")]
