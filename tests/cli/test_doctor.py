import importlib.metadata
from pathlib import Path

import pytest

from support.command_line import Trundle
from trundle.doctor import check_machine, machine
from trundle.errors import RobotWarning
from trundle.extras import EXTRAS, install_line
from trundle.robots import Robot
from trundle.robots.file_format import describe_robot


@pytest.fixture
def without_usd_core(monkeypatch: pytest.MonkeyPatch) -> None:
    """Isaac Sim's Python, where usd-core is not installed."""
    version = importlib.metadata.version

    def hidden(name: str) -> str:
        if name == "usd-core":
            raise importlib.metadata.PackageNotFoundError(name)
        return version(name)

    monkeypatch.setattr(importlib.metadata, "version", hidden)


def test_this_machine_passes(trundle: Trundle) -> None:
    done = trundle("doctor", "--json")
    assert done.code == 0
    assert done.json["passed"] is True
    assert {"python", "kernels", "mujoco"} <= {check["name"] for check in done.json["checks"]}


def test_a_missing_library_is_named_with_its_installation(trundle: Trundle, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "trimesh", None)
    done = trundle("doctor")
    assert done.code == 0
    (line,) = [line for line in done.out.splitlines() if " mesh " in line]
    assert line.startswith("missing")
    assert "no trimesh" in line
    assert install_line("mesh") in line


def test_every_extra_is_listed_with_its_state(trundle: Trundle) -> None:
    checks = {check["name"]: check for check in trundle("doctor", "--json").json["checks"]}
    for extra, has in EXTRAS.items():
        assert checks[extra]["status"] in ("pass", "missing")
        assert any(library in checks[extra]["detail"] for library in has.modules)


@pytest.mark.parametrize("backend", ["mujoco", "kinematic"])
def test_a_backend_is_tried_from_start_to_end(trundle: Trundle, backend: str) -> None:
    done = trundle("doctor", "--backend", backend)
    assert done.code == 0
    passed = [line.split()[1] for line in done.out.splitlines() if line.startswith("pass")]
    assert passed[-5:] == ["drive", "step", "mission", "contact", "close"]


def test_an_unknown_backend_fails_and_lists_those_there_are(trundle: Trundle) -> None:
    done = trundle("doctor", "--backend", "mujoko")
    assert done.code == 1
    assert "fail     start" in done.out
    assert "Did you mean 'mujoco'?" in done.out


def test_a_robot_as_configured_is_said_to_be(trundle: Trundle) -> None:
    done = trundle("doctor", "robot", "nova_carter", "--json")
    assert done.code == 0
    assert {"wheel_radius", "track_width", "slip", "findings"} <= set(done.json)
    assert done.json["findings"] == []
    assert "drives as configured" in trundle("doctor", "robot", "nova_carter").out


@pytest.mark.parametrize("suffix", [".urdf", ".xml"])
def test_a_robot_of_a_file_is_driven_too(trundle: Trundle, tmp_path, suffix: str) -> None:
    file = tmp_path / f"jackal{suffix}"
    assert trundle("export", "jackal", "--to", "urdf" if suffix == ".urdf" else "mjcf", "-o", file).code == 0
    with pytest.warns(RobotWarning, match="maximum speeds"):
        done = trundle("doctor", "robot", file, "--json")
    assert done.code == 0
    assert done.json["wheel_radius"] == pytest.approx(0.098, rel=0.01)


def test_a_wrong_track_is_said_with_the_right_one(trundle: Trundle) -> None:
    done = trundle("doctor", "robot", "nova_carter", "--track-width", "0.54", "--json")
    assert done.code == 1
    (finding,) = done.json["findings"]
    assert finding["kind"] == "track_width"
    assert finding["configured"] == 0.54
    assert finding["measured"] == pytest.approx(0.4132, rel=0.01)
    assert "the robot turns 31% too far" in trundle("doctor", "robot", "nova_carter", "--track-width", "0.54").out


@pytest.mark.parametrize("value", ["0", "-1", "nan", "inf"])
def test_a_width_that_is_none_is_refused(trundle: Trundle, value: str) -> None:
    done = trundle("doctor", "robot", "nova_carter", f"--wheel-radius={value}")
    assert done.code == 2
    assert "give a positive number of metres" in done.err


@pytest.fixture
def nvidia_smi(tmp_path, monkeypatch: pytest.MonkeyPatch):
    """A stand-in on the path, which says what it is given."""

    def put(said: str, code: int = 0) -> None:
        script = tmp_path / "nvidia-smi"
        script.write_text(f"#!/bin/sh\nprintf '%s\\n' '{said}'\nexit {code}\n")
        script.chmod(0o755)
        monkeypatch.setenv("PATH", str(tmp_path))

    return put


@pytest.mark.parametrize(
    ("said", "code", "status", "detail"),
    [
        ("NVIDIA L40S, 570.1", 0, "pass", "NVIDIA L40S, driver 570.1"),
        ("NVIDIA RTX A6000, 570.1\nNVIDIA A100-SXM4-80GB, 570.1", 0, "pass", "RTX A6000"),
        ("NVIDIA A100-SXM4-80GB, 570.1", 0, "missing", "no RT cores"),
        ("No devices were found", 6, "fail", "no NVIDIA GPU: No devices were found"),
    ],
)
def test_the_gpu_is_looked_at(nvidia_smi, said: str, code: int, status: str, detail: str) -> None:
    nvidia_smi(said, code)
    found = next(check for check in check_machine("isaac") if check.name == "gpu")
    assert found.status == status
    assert detail in found.detail


def test_a_gpu_that_cannot_be_asked_for_fails_nothing(monkeypatch: pytest.MonkeyPatch, tmp_path) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    found = next(check for check in check_machine("isaac") if check.name == "gpu")
    assert found.status == "missing"


def test_the_checklist_of_isaac_sim_passes_on_the_stand_in(
    trundle: Trundle, fake, without_usd_core: None, nvidia_smi
) -> None:
    nvidia_smi("NVIDIA L40S, 570.1")
    done = trundle("doctor", "--backend", "isaac", "--headless", "--json")
    assert done.code == 0, done.out
    names = [check["name"] for check in done.json["checks"]]
    assert names[2:5] == ["isaac sim", "usd", "gpu"]
    assert names[5:] == ["start", "drive", "interface", "step", "mission", "contact", "picture", "close"]
    assert {check["status"] for check in done.json["checks"]} == {"pass"}
    page = (Path(__file__).parents[2] / "docs" / "isaac.md").read_text()
    assert [name for name in names if f"\npass     {name}  " not in page or f"`{name}`" not in page] == []
    assert fake.app_starts == fake.app_closes == 1


def test_another_usd_beside_isaac_sims_own_is_named(trundle: Trundle, fake) -> None:
    done = trundle("doctor", "--backend", "isaac", "--headless")
    assert done.code == 1
    (line,) = [line for line in done.out.splitlines() if line.startswith("fail")]
    assert "pip uninstall usd-core" in line


def test_a_robot_with_other_wheels_in_isaac_sim_is_identified(trundle: Trundle, make_fake) -> None:
    robot = Robot.load("nova_carter")
    wide = robot.model_copy(
        update={"drive": robot.drive.model_copy(update={"track_width": 0.54, "wheel_radius": 0.12})}
    )
    make_fake(6, robot=wide)
    done = trundle("doctor", "robot", "nova_carter", "--backend", "isaac", "--headless", "--json")
    assert done.code == 1, done.err
    assert done.json["wheel_radius"] == pytest.approx(0.12, rel=0.01)
    assert done.json["track_width"] == pytest.approx(0.54, rel=0.01)
    assert [finding["kind"] for finding in done.json["findings"]] == ["wheel_radius", "track_width"]


def test_without_isaac_sim_its_checklist_ends_there(trundle: Trundle) -> None:
    done = trundle("doctor", "--backend", "isaac", "--headless", "--json")
    assert done.code == 1
    assert [check["name"] for check in done.json["checks"]] == ["python", "kernels", "isaac sim"]


def test_a_mere_folder_called_isaacsim_is_none(trundle: Trundle, monkeypatch: pytest.MonkeyPatch, tmp_path) -> None:
    (tmp_path / "isaacsim").mkdir()
    monkeypatch.syspath_prepend(tmp_path)
    done = trundle("doctor", "--backend", "isaac", "--headless", "--json")
    assert done.code == 1
    assert done.json["checks"][-1]["name"] == "isaac sim"


def test_the_checklist_has_a_floor_of_its_own(trundle: Trundle, fake) -> None:
    done = trundle("doctor", "--backend", "isaac", "--headless", "--environment", "warehouse")
    assert done.code == 2
    assert "leave out --environment" in done.err
    assert "trundle view nova_carter --backend isaac --environment warehouse" in done.err


def test_a_point_that_breaks_down_fails_and_the_next_ones_follow(
    trundle: Trundle, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(*_: object, **__: object) -> None:
        raise AttributeError("no such thing in this version")

    monkeypatch.setattr("trundle.doctor.drive_check.check_drive", broken)
    done = trundle("doctor", "--backend", "kinematic", "--json")
    assert done.code == 1
    found = {check["name"]: check for check in done.json["checks"]}
    assert found["drive"]["detail"] == "AttributeError: no such thing in this version"
    assert [name for name, check in found.items() if check["status"] == "fail"] == ["drive"]
    assert found["close"]["status"] == "pass"


@pytest.mark.slow
@pytest.mark.parametrize(("start", "kinds"), [("-2.5,-1,0", []), ("2.5,-1,0", ["contact"])])
def test_the_robot_check_begins_at_the_given_start_in_an_environment(
    trundle: Trundle, fake, start: str, kinds: list[str]
) -> None:
    options = ["--backend", "isaac", "--headless", "--environment", "warehouse", "--start", start, "--json"]
    done = trundle("doctor", "robot", "nova_carter", *options)
    assert [finding["kind"] for finding in done.json["findings"]] == kinds
    assert done.code == (1 if kinds else 0)


def test_options_of_isaac_sim_are_refused_elsewhere(trundle: Trundle) -> None:
    done = trundle("doctor", "--backend", "mujoco", "--headless")
    assert done.code == 2
    assert "--headless is for --backend isaac" in done.err


def test_the_robot_check_says_what_lidars_miss(trundle: Trundle) -> None:
    done = trundle("doctor", "robot", "nova_carter", "--backend", "kinematic")
    assert "lidar front: its beams are 0.418 m above the floor" in done.out
    shown = trundle("doctor", "robot", "nova_carter", "--backend", "kinematic", "--json").json["lidars"]
    assert [view["lidar"] for view in shown] == ["front", "back"]
    assert shown[0]["below"] == [0.06, 0.418]
    assert "a EUR pallet" in shown[0]["missed"]


def test_the_robot_check_says_how_exact_odometry_must_be(trundle: Trundle) -> None:
    done = trundle("doctor", "robot", "nova_carter", "--backend", "kinematic")
    assert "after 10 m it is within 0.25 m of its goal if the odometry is wrong by at most 2.5 % of the" in done.out
    assert "--localizer amcl bears odometry that is wrong by 5 % of the distance and 5° per metre" in done.out
    shown = trundle("doctor", "robot", "nova_carter", "--backend", "kinematic", "--json").json
    assert [need["distance"] for need in shown["odometry_needed"]] == [10.0, 30.0]
    assert shown["localizer"] == "amcl"


def test_a_robot_without_lidars_is_said_to_sense_nothing(trundle: Trundle, tmp_path: Path) -> None:
    robot = tmp_path / "blind.yaml"
    robot.write_text(describe_robot(Robot.load("nova_carter").model_copy(update={"lidars": {}})))
    done = trundle("doctor", "robot", str(robot), "--backend", "kinematic")
    assert "no lidar: it does not sense obstacles" in done.out


@pytest.mark.parametrize(("installed", "status"), [((), "missing"), (("isaacsim-extscache-kit",), "missing")])
def test_an_isaac_sim_of_pypi_alone_lacks_two_packages(
    monkeypatch: pytest.MonkeyPatch, installed: tuple[str, ...], status: str
) -> None:
    there = {"isaacsim-kernel", *installed}
    monkeypatch.setattr(machine, "_version", lambda name: "6.2.0.0" if name in there else "")
    checks = {check.name: check for check in check_machine("isaac")}
    assert checks["packages"].status == status
    for name in ("isaacsim-extscache-kit", "isaacsim-extscache-kit-sdk"):
        assert (f"no {name}," in checks["packages"].detail.replace(" and no ", ", no ") + ",") == (name not in there)


def test_an_isaac_sim_in_a_folder_is_not_asked_for_packages(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(machine, "_version", lambda _: "")
    assert "packages" not in {check.name for check in check_machine("isaac")}
