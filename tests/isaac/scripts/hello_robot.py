"""The docs' Hello Robot by the names of Isaac Sim 4: an asynchronous sample, a keyboard, a camera, the app's loop."""

from isaacsim import SimulationApp

simulation_app = SimulationApp({"headless": True})

import asyncio

import carb.input
import numpy as np
import omni.appwindow
import omni.isaac.core.utils.numpy.rotations as rot_utils
import omni.timeline
from omni.isaac.core import World
from omni.isaac.core.robots import Robot
from omni.isaac.core.utils.nucleus import get_assets_root_path
from omni.isaac.core.utils.prims import delete_prim, get_prim_at_path, is_prim_path_valid
from omni.isaac.core.utils.semantics import add_update_semantics
from omni.isaac.core.utils.stage import add_reference_to_stage
from omni.isaac.core.utils.types import ArticulationAction
from omni.isaac.sensor import Camera
from omni.isaac.wheeled_robots.controllers import DifferentialController


class HelloRobot:
    def setup_scene(self):
        world = World.instance()
        world.scene.add_default_ground_plane(static_friction=0.8, dynamic_friction=0.8, restitution=0.0)
        usd_path = get_assets_root_path() + "/Isaac/Robots/NVIDIA/NovaCarter/nova_carter.usd"
        add_reference_to_stage(usd_path=usd_path, prim_path="/World/Fancy_Robot")
        turned = rot_utils.euler_angles_to_quats(np.array([0, 0, 90]), degrees=True)
        world.scene.add(
            Robot("/World/Fancy_Robot", "fancy_robot", position=np.array([1.0, 2.0, 0.05]), orientation=turned)
        )

    async def setup_post_load(self):
        world = World.instance()
        await world.reset_async()
        self.robot = world.scene.get_object("fancy_robot")
        self.controller = self.robot.get_articulation_controller()
        self.drive = DifferentialController(name="drive", wheel_radius=0.14, wheel_base=0.4132)
        self.wheels = [self.robot.get_dof_index(f"joint_wheel_{side}") for side in ("left", "right")]
        self.command, self.events = [0.0, 0.0], []
        world.add_physics_callback("sending_actions", callback_fn=self.send_robot_actions)
        world.add_timeline_callback("timeline", lambda event: self.events.append(event.type))
        await world.play_async()

    def send_robot_actions(self, step_size):
        speeds = self.drive.forward(self.command).joint_velocities
        self.controller.apply_action(
            ArticulationAction(
                joint_positions=None, joint_efforts=None, joint_velocities=speeds, joint_indices=np.array(self.wheels)
            )
        )


world = World(stage_units_in_meters=1.0, physics_dt=1 / 60, rendering_dt=1 / 60, backend="numpy", device="cpu")
sample = HelloRobot()
sample.setup_scene()
asyncio.run(sample.setup_post_load())
add_update_semantics(get_prim_at_path("/World/Fancy_Robot"), "robot")
keyboard = omni.appwindow.get_default_app_window().get_keyboard()
carb.input.acquire_input_interface().subscribe_to_keyboard_events(keyboard, lambda event: True)
for command in ([0.4, 0.0], [0.0, 0.8], [0.25, -0.5]):
    sample.command = command
    before = sample.robot.get_world_pose()[0]
    for _ in range(300):
        simulation_app.update()
    v, w = command
    assert abs(sample.robot.get_angular_velocity()[2] - w) < 0.15, sample.robot.get_angular_velocity()
    far = np.linalg.norm(sample.robot.get_world_pose()[0] - before)
    assert abs(far - (5.0 * v if w == 0.0 else 2.0 * abs(v / w * np.sin(2.5 * w)))) < 0.05, (command, far)
timeline = omni.timeline.get_timeline_interface()
assert timeline.is_playing()
camera = Camera(prim_path="/World/Fancy_Robot/camera", frequency=20, resolution=(256, 256))
camera.initialize()
timeline.pause()
simulation_app.update()
timeline.stop()
simulation_app.update()
assert sample.events == [1, 2], sample.events
world.clear_physics_callbacks()
delete_prim("/World/Fancy_Robot")
assert not is_prim_path_valid("/World/Fancy_Robot")
World.clear_instance()
print("done")
simulation_app.close()
