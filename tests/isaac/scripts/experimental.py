"""The classes of Isaac Sim 6: the experimental WheeledRobot and SimulationManager."""

from isaacsim import SimulationApp

simulation_app = SimulationApp({"headless": True})

import isaacsim.core.experimental.utils.app as app_utils
import isaacsim.core.experimental.utils.stage as stage_utils
import numpy as np
from isaacsim.core.experimental.objects import GroundPlane
from isaacsim.core.experimental.prims import RigidPrim
from isaacsim.core.simulation_manager import SimulationEvent, SimulationManager
from isaacsim.robot.experimental.wheeled_robots.controllers import DifferentialController
from isaacsim.robot.experimental.wheeled_robots.robots import WheeledRobot
from isaacsim.storage.native import get_assets_root_path

stage_utils.create_new_stage()
GroundPlane("/World/ground")
robot = WheeledRobot(
    "/World/Carter",
    wheel_dof_names=["joint_wheel_left", "joint_wheel_right"],
    usd_path=get_assets_root_path() + "/Isaac/Robots/NVIDIA/NovaCarter/nova_carter.usd",
    positions=[[0.0, 0.0, 0.05]],
)
names = list(robot.dof_names)
controller = DifferentialController(wheel_radius=0.14, wheel_base=0.4132)
SimulationManager.setup_simulation(dt=0.01, device="cpu")
steps = []
SimulationManager.register_callback(lambda dt, context: steps.append(dt), event=SimulationEvent.PHYSICS_POST_STEP)
app_utils.play()
steps.clear()
for _ in range(300):
    robot.apply_wheel_actions(controller.forward([0.4, 0.0]))
    SimulationManager.step()
assert len(steps) == 300
position = robot.get_world_poses()[0].numpy()[0]
assert 1.1 < position[0] < 1.2
assert abs(position[1]) < 0.02
# The order of joints that USD tells is the one that PhysX has.
assert list(robot.dof_names) == names
chassis = RigidPrim("/World/Carter/chassis_link")
assert np.allclose(chassis.get_world_poses()[0].numpy()[0], position, atol=1e-5)
simulation_app.update()
assert robot.get_world_poses()[0].numpy()[0][0] > position[0]
app_utils.stop()
print("done")
simulation_app.close()
