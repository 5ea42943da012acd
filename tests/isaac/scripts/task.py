"""A task with its own controller, a callback, a log of data, and a stage that is saved and cleared."""

import sys

from isaacsim import SimulationApp

simulation_app = SimulationApp({"headless": True})

import json

import numpy as np
import omni.usd
from isaacsim.core.api import World
from isaacsim.core.api.controllers import BaseController
from isaacsim.core.api.objects import DynamicCuboid
from isaacsim.core.api.tasks import BaseTask
from isaacsim.core.utils.types import ArticulationAction
from isaacsim.robot.wheeled_robots.robots import WheeledRobot
from isaacsim.storage.native import get_assets_root_path
from pxr import Usd

folder = sys.argv[1]


class Unicycle(BaseController):
    def __init__(self):
        super().__init__(name="unicycle")

    def forward(self, command):
        v, w = command
        return ArticulationAction(joint_velocities=[(v - w * 0.2066) / 0.14, (v + w * 0.2066) / 0.14])


class Push(BaseTask):
    def set_up_scene(self, scene):
        super().set_up_scene(scene)
        scene.add_default_ground_plane()
        self.box = scene.add(DynamicCuboid("/World/box", "box", position=np.array([1.2, 0, 0.15]), size=0.3, mass=1.0))
        self.robot = scene.add(
            WheeledRobot(
                "/World/robot",
                "robot",
                wheel_dof_names=["joint_wheel_left", "joint_wheel_right"],
                create_robot=True,
                usd_path=get_assets_root_path() + "/Isaac/Robots/NVIDIA/NovaCarter/nova_carter.usd",
            )
        )

    def get_observations(self):
        return {"robot": self.robot.get_world_pose()[0], "box": self.box.get_world_pose()[0]}


world = World(stage_units_in_meters=1.0)
world.add_task(Push(name="push"))
world.reset()
robot, controller = world.scene.get_object("robot"), Unicycle()
assert robot.get_joints_state().positions.shape == (robot.num_dof,) == (len(robot.dof_names),)
world.add_physics_callback("drive", lambda step_size: robot.apply_wheel_actions(controller.forward([0.4, 0.0])))
logger = world.get_data_logger()
logger.add_data_frame_logging_func(lambda tasks, scene: {"x": float(scene.get_object("robot").get_world_pose()[0][0])})
logger.start()
for _ in range(240):
    world.step(render=False)
logger.save(log_path=f"{folder}/log.json")
with open(f"{folder}/log.json") as file:
    assert len(json.load(file)["Isaac Sim Data"]) == 240
seen = world.get_observations()
assert 1.4 < seen["robot"][0] < 1.65, seen
assert np.hypot(*(seen["box"][:2] - [1.2, 0.0])) > 0.3, seen  # pushed, and out of the way
world.remove_physics_callback("drive")

assert omni.usd.get_context().save_as_stage(f"{folder}/saved.usd")
saved = Usd.Stage.Open(f"{folder}/saved.usd")
assert saved.GetPrimAtPath("/World/robot/chassis_link").IsValid()

world.stop()
world.reset()
assert abs(world.get_observations()["robot"][0]) < 0.01
world.step()
world.scene.remove_object("box")
world.clear()
print("done")
simulation_app.close()
