"""Drive Nova Carter by DifferentialController: straight, in place, and in a curve."""

from isaacsim import SimulationApp

simulation_app = SimulationApp({"headless": True})

import numpy as np
from isaacsim.core.api import World
from isaacsim.core.utils.rotations import quat_to_euler_angles
from isaacsim.robot.wheeled_robots.controllers.differential_controller import DifferentialController
from isaacsim.robot.wheeled_robots.robots import WheeledRobot
from isaacsim.storage.native import get_assets_root_path

my_world = World(stage_units_in_meters=1.0, physics_dt=1.0 / 60.0, rendering_dt=1.0 / 60.0)
my_world.scene.add_default_ground_plane()
my_carter = my_world.scene.add(
    WheeledRobot(
        prim_path="/World/Nova_Carter",
        name="my_carter",
        wheel_dof_names=["joint_wheel_left", "joint_wheel_right"],
        create_robot=True,
        usd_path=get_assets_root_path() + "/Isaac/Robots/NVIDIA/NovaCarter/nova_carter.usd",
        position=np.array([0.0, 0.0, 0.05]),
    )
)
my_controller = DifferentialController(name="simple_control", wheel_radius=0.14, wheel_base=0.4132)
for command in ([0.4, 0.0], [0.0, 0.8], [0.25, -0.5]):
    my_world.reset()
    my_controller.reset()
    for _ in range(300):
        my_carter.apply_wheel_actions(my_controller.forward(command=command))
        my_world.step(render=True)
    position, orientation = my_carter.get_world_pose()
    yaw = quat_to_euler_angles(orientation)[2]
    print("pose", *command, *(float(value) for value in position[:2]), float(yaw))
simulation_app.close()
