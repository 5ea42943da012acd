import pytest

from support.command_line import Trundle


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
    assert passed[-5:] == ["start", "step", "drive", "mission", "close"]


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
