"""A real ROS 2 reads what `trundle export --to nav2` writes, with the values that trundle wrote."""

import json

import pytest
import yaml

from trundle.mission import Scenario
from trundle.nav2 import export_nav2

READER = """
import json, sys
import rclpy
from rclpy.node import Node

rclpy.init(args=["x", "--ros-args", "--params-file", sys.argv[1]])
read = {}
for name in sys.argv[2].split(","):
    space = "/" + name if name.endswith("_costmap") else "/"
    node = Node(name, namespace=space, automatically_declare_parameters_from_overrides=True)
    values = {key: one.value for key, one in node.get_parameters_by_prefix("").items()}
    read[name] = {key: list(value) if hasattr(value, "tolist") else value for key, value in values.items()}
    node.destroy_node()
print(json.dumps(read))
rclpy.shutdown()
"""


def flatten(parameters, prefix=""):
    found = {}
    for key, value in parameters.items():
        found |= flatten(value, f"{prefix}{key}.") if isinstance(value, dict) else {f"{prefix}{key}": value}
    return found


@pytest.mark.parametrize("controller", ["regulated_pure_pursuit", "mppi"])
def test_ros_reads_every_parameter_with_its_value_and_its_type(ros, controller, tmp_path):
    scenario = Scenario.make(
        world={"name": "corridors", "seed": 1}, lidar=True, controller=controller, start=(1.0, 2.0, 0.5)
    )
    done = export_nav2(scenario, tmp_path, distro=ros.distro)
    nodes = yaml.safe_load((done.folder / "nav2_params.yaml").read_text(encoding="utf-8"))
    nodes = {name: block.get(name, block)["ros__parameters"] for name, block in nodes.items()}
    process = ros.script(READER, done.folder / "nav2_params.yaml", ",".join(nodes))
    out, err = process.communicate(timeout=120)
    assert process.returncode == 0, err
    read = json.loads(out.strip().splitlines()[-1])
    for name, parameters in nodes.items():
        wanted = flatten(parameters)
        got = {key: value for key, value in read[name].items() if key in wanted}
        assert got == wanted
        assert {key: type(value) for key, value in got.items()} == {key: type(value) for key, value in wanted.items()}
