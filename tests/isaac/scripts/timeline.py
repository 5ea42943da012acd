"""No World: a scene by USD's own classes, the timeline, the application's loop, and WheelBasePoseController."""

from isaacsim import SimulationApp

kit = SimulationApp({"headless": True, "renderer": "RayTracedLighting"})

import numpy as np
import omni
import omni.kit.app
from isaacsim.core.prims import SingleArticulation, SingleXFormPrim
from isaacsim.core.utils.prims import create_prim
from isaacsim.core.utils.stage import create_new_stage
from isaacsim.core.utils.types import ArticulationAction
from isaacsim.robot.wheeled_robots.controllers.differential_controller import DifferentialController
from isaacsim.robot.wheeled_robots.controllers.wheel_base_pose_controller import WheelBasePoseController
from isaacsim.storage.native import get_assets_root_path
from pxr import Gf, PhysicsSchemaTools, PhysxSchema, Sdf, Usd, UsdLux, UsdPhysics

stage = omni.usd.get_context().get_stage()
scene = UsdPhysics.Scene.Define(stage, Sdf.Path("/physicsScene"))
scene.CreateGravityDirectionAttr().Set(Gf.Vec3f(0.0, 0.0, -1.0))
scene.CreateGravityMagnitudeAttr().Set(9.81)
PhysxSchema.PhysxSceneAPI.Apply(stage.GetPrimAtPath("/physicsScene"))
physx_scene = PhysxSchema.PhysxSceneAPI.Get(stage, "/physicsScene")
physx_scene.CreateEnableCCDAttr(True)
physx_scene.CreateSolverTypeAttr("TGS")
assert stage.GetPrimAtPath("/physicsScene").HasAPI(PhysxSchema.PhysxSceneAPI)
UsdLux.DistantLight.Define(stage, Sdf.Path("/DistantLight")).CreateIntensityAttr(500)
PhysicsSchemaTools.addGroundPlane(stage, "/World/groundPlane", "Z", 1500, Gf.Vec3f(0, 0, 0), Gf.Vec3f(0.5))
create_prim(
    "/World/Robot", "Xform", position=np.array([1.0, 0.0, 0.05]),
    usd_path=get_assets_root_path() + "/Isaac/Robots/NVIDIA/NovaCarter/nova_carter.usd",
)  # fmt: skip
kit.update()

timeline = omni.timeline.get_timeline_interface()
events = []
kept = [
    timeline.get_timeline_event_stream().create_subscription_to_pop(lambda event: events.append(event.type)),
    omni.kit.app.get_app().get_update_event_stream().create_subscription_to_pop(lambda event: events.append("update")),
]
timeline.play()
kit.update()
carter = SingleArticulation("/World/Robot")
carter.initialize()
wheels = np.array([carter.get_dof_index(f"joint_wheel_{side}") for side in ("left", "right")])
controller = WheelBasePoseController(
    name="pose", open_loop_wheel_controller=DifferentialController("open", wheel_radius=0.14, wheel_base=0.4132)
)
for _ in range(600):
    position, orientation = carter.get_world_pose()
    action = controller.forward(
        start_position=position, start_orientation=orientation, goal_position=np.array([3.0, 0.5]),
        lateral_velocity=0.5, yaw_velocity=0.5, position_tol=0.1,
    )  # fmt: skip
    carter.apply_action(ArticulationAction(joint_velocities=action.joint_velocities, joint_indices=wheels))
    kit.update()
assert np.linalg.norm(carter.get_world_pose()[0][:2] - [3.0, 0.5]) < 0.12
assert abs(timeline.get_current_time() - 10.0) < 0.1
assert events.count("update") >= 600

# Wheels are driven by USD's attributes as well, in degrees.
controller.reset()
before = carter.get_world_pose()[0][:2]
for prim in Usd.PrimRange(stage.GetPrimAtPath("/World/Robot")):
    if prim.GetName() in ("joint_wheel_left", "joint_wheel_right"):
        UsdPhysics.DriveAPI.Apply(prim, "angular").GetTargetVelocityAttr().Set(float(np.degrees(2.0)))
for _ in range(120):
    kit.update()
assert 0.4 < np.linalg.norm(carter.get_world_pose()[0][:2] - before) < 0.6

timeline.pause()
kit.update()
paused = carter.get_world_pose()[0]
kit.update()
assert np.array_equal(carter.get_world_pose()[0], paused)
timeline.stop()
kit.update()
assert np.allclose(SingleXFormPrim("/World/Robot/chassis_link").get_world_pose()[0][:2], [1.0, 0.0], atol=1e-3)
create_new_stage()
assert not omni.usd.get_context().get_stage().GetPrimAtPath("/World/Robot")
print("done")
kit.close()
