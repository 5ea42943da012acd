from importlib import resources
from pathlib import Path

from support.command_line import Trundle

INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
URDF = f"""<robot name="cart">
  <link name="base">{INERTIAL}</link>
  <link name="wheel">{INERTIAL}</link>
  <joint name="left" type="continuous"><parent link="base"/><child link="wheel"/><axis xyz="0 1 0"/></joint>
</robot>"""


def test_the_wheels_of_nova_carter_drive_it(trundle: Trundle) -> None:
    done = trundle("joints", "nova_carter", "--json")
    assert done.code == 0
    assert all({"name", "type", "axis", "limits", "drives", "parent", "child"} <= set(joint) for joint in done.json)
    driven = {joint["name"] for joint in done.json if joint["drives"]}
    assert driven == {"joint_wheel_left", "joint_wheel_right"}
    assert {"joint_swing_left", "joint_caster_right"} <= {joint["name"] for joint in done.json}


def test_the_table_has_a_line_for_each_joint(trundle: Trundle) -> None:
    lines = trundle("joints", "nova_carter").out.splitlines()
    assert lines[0].split() == ["name", "type", "axis", "limits", "parent", "child", "drives"]
    assert len(lines) - 1 == len(trundle("joints", "nova_carter", "--json").json)


def test_a_urdf_is_taken_by_its_path(trundle: Trundle, tmp_path: Path) -> None:
    (tmp_path / "cart.urdf").write_text(URDF)
    done = trundle("joints", tmp_path / "cart.urdf", "--json")
    assert done.code == 0, done.err
    assert [joint["name"] for joint in done.json] == ["left"]


def test_a_usd_file_is_taken_by_its_path(trundle: Trundle, tmp_path: Path) -> None:
    (tmp_path / "cart.usda").write_text(
        '#usda 1.0\ndef PhysicsRevoluteJoint "left" (prepend apiSchemas = ["PhysicsDriveAPI:angular"]) {}\n'
    )
    done = trundle("joints", tmp_path / "cart.usda", "--json")
    assert done.code == 0, done.err
    assert done.json[0] == {
        "name": "/left",
        "type": "continuous",
        "axis": [1.0, 0.0, 0.0],
        "limits": None,
        "parent": "world",
        "child": "world",
        "drives": True,
    }


def test_an_unknown_robot_offers_the_nearest(trundle: Trundle) -> None:
    done = trundle("joints", "nova_cater")
    assert done.code == 2
    assert "Did you mean 'nova_carter'?" in done.err


def test_a_file_that_is_not_there(trundle: Trundle) -> None:
    done = trundle("joints", "none.urdf")
    assert done.code == 2
    assert "none.urdf" in done.err
    assert "Traceback" not in done.err


def test_a_robot_that_tips_over_is_refused_as_by_a_run(trundle: Trundle, tmp_path: Path) -> None:
    text = Path(str(resources.files("trundle.robots") / "catalogue" / "nova_carter.yaml")).read_text()
    begin, end = text.index("casters:"), text.index("lidars:")
    (tmp_path / "bare.yaml").write_text(text[:begin] + text[end:])
    listed = trundle("joints", "bare.yaml")
    assert listed.code == 2
    assert "is behind all of its wheels, and it has no casters. Add one there, for example casters: [" in listed.err
    assert trundle("drive", "bare.yaml", "--command", "0.3,0,1").err == listed.err
    advice = listed.err[listed.err.index("casters: [") :].strip()
    (tmp_path / "carried.yaml").write_text(text[:begin] + advice + "\n" + text[end:])
    assert trundle("joints", "carried.yaml").code == 0
