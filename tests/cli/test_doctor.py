import importlib.metadata

import pytest

from support.command_line import Trundle
from trundle.robots import Robot


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
    (line,) = [line for line in done.out.splitlines() if " trimesh " in line]
    assert line.startswith("missing")
    assert 'pip install "trundle[mesh]"' in line


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


def test_a_wrong_track_is_said_with_the_right_one(trundle: Trundle) -> None:
    done = trundle("doctor", "robot", "nova_carter", "--track-width", "0.54", "--json")
    assert done.code == 1
    (finding,) = done.json["findings"]
    assert finding["kind"] == "track_width"
    assert finding["configured"] == 0.54
    assert finding["measured"] == pytest.approx(0.4132, rel=0.01)
    assert "it turns 31% too far" in trundle("doctor", "robot", "nova_carter", "--track-width", "0.54").out


@pytest.mark.parametrize("value", ["0", "-1", "nan", "inf"])
def test_a_width_that_is_none_is_refused(trundle: Trundle, value: str) -> None:
    done = trundle("doctor", "robot", "nova_carter", f"--wheel-radius={value}")
    assert done.code == 2
    assert "give a positive number of metres" in done.err


def test_the_checklist_of_isaac_sim_passes_on_the_stand_in(trundle: Trundle, fake, without_usd_core: None) -> None:
    done = trundle("doctor", "--backend", "isaac", "--headless", "--json")
    assert done.code == 0, done.out
    names = [check["name"] for check in done.json["checks"]]
    assert names[2:4] == ["isaac sim", "usd"]
    assert names[4:] == ["start", "interface", "drive", "step", "mission", "contact", "picture", "close"]
    assert {check["status"] for check in done.json["checks"]} == {"pass"}
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


def test_options_of_isaac_sim_are_refused_elsewhere(trundle: Trundle) -> None:
    done = trundle("doctor", "--backend", "mujoco", "--headless")
    assert done.code == 2
    assert "--headless is for --backend isaac" in done.err
