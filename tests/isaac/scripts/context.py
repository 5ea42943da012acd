"""SimulationContext instead of World, in the warehouse: a view of articulations, callbacks, pause and stop."""

from isaacsim import SimulationApp

kit = SimulationApp(launch_config={"headless": True, "sync_loads": True, "renderer": "RaytracedLighting"})

import numpy as np
from isaacsim.core.api import SimulationContext
from isaacsim.core.prims import Articulation, XFormPrim
from isaacsim.core.utils.prims import create_prim
from isaacsim.core.utils.rotations import euler_angles_to_quat, quat_to_euler_angles
from isaacsim.core.utils.stage import get_current_stage, is_stage_loading, open_stage
from isaacsim.core.utils.types import ArticulationActions
from isaacsim.core.utils.viewports import set_camera_view
from isaacsim.robot.wheeled_robots.controllers import DifferentialController
from isaacsim.storage.native import get_assets_root_path, is_file
from pxr import Usd, UsdPhysics

usd_path = get_assets_root_path() + "/Isaac/Environments/Simple_Warehouse/warehouse_with_forklifts.usd"
assert is_file(usd_path)
open_stage(usd_path)
kit.update()
while is_stage_loading():
    kit.update()
create_prim(
    prim_path="/Root/Nova_Carter", prim_type="Xform", translation=(12.9, 0.0, 0.05),
    usd_path=get_assets_root_path() + "/Isaac/Robots/NVIDIA/NovaCarter/nova_carter.usd",
    orientation=euler_angles_to_quat(np.array([0, 0, 180]), degrees=True),
)  # fmt: skip
set_camera_view(eye=[8.0, 8.0, 6.0], target=[0, 0, 0], camera_prim_path="/OmniverseKit_Persp")
robot = get_current_stage().GetPrimAtPath("/Root/Nova_Carter")
joints = [prim.GetName() for prim in Usd.PrimRange(robot) if prim.IsA(UsdPhysics.RevoluteJoint)]

context = SimulationContext(physics_dt=1.0 / 60.0, rendering_dt=1.0 / 60.0, stage_units_in_meters=1.0)
assert context.get_physics_context().get_solver_type() == "TGS"
carters = Articulation(prim_paths_expr="/Root/Nova_Carter", name="carters")
context.initialize_physics()
context.play()
carters.initialize()
assert (carters.count, sorted(carters.dof_names)) == (1, sorted(joints))
wheels = np.array([carters.get_dof_index(f"joint_wheel_{side}") for side in ("left", "right")])
controller = DifferentialController(name="simple_control", wheel_radius=0.14, wheel_base=0.4132)
times = []
context.add_physics_callback("log", callback_fn=lambda step_size: times.append(context.current_time))
for command, far, turned in (([0.4, 0.0], 1.96, 0.0), ([0.0, 0.8], 0.0, 3.92), ([0.25, -0.5], 0.94, -2.45)):
    before = [values[0] for values in carters.get_world_poses()]
    for _ in range(300):
        speeds = controller.forward(command=command).joint_velocities
        carters.apply_action(ArticulationActions(joint_velocities=np.array([speeds]), joint_indices=wheels))
        context.step(render=True)
    after = [values[0] for values in carters.get_world_poses()]
    turn = quat_to_euler_angles(after[1])[2] - quat_to_euler_angles(before[1])[2] - turned
    assert abs(np.linalg.norm(after[0][:2] - before[0][:2]) - far) < 0.03, (command, before, after)
    assert abs(np.arctan2(np.sin(turn), np.cos(turn))) < 0.15, (command, turn)
assert len(times) == 900
carters.set_joint_velocity_targets(np.zeros((1, 2)), joint_indices=wheels)
for _ in range(60):
    context.step(render=False)
assert np.abs(carters.get_velocities()).max() < 0.01
context.pause()
assert (context.is_playing(), context.is_stopped()) == (False, False)
context.play()
context.stop()
kit.update()
assert np.allclose(XFormPrim("/Root/Nova_Carter").get_world_poses()[0], [[12.9, 0.0, 0.05]], atol=1e-6)
print("done")
kit.close()
