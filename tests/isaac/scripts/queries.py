"""In the style of a forum: commands, omni.physx.scripts, rays and overlaps, contacts, the timeline; no World."""

from isaacsim import SimulationApp

simulation_app = SimulationApp({"headless": True})

import numpy as np
import omni.kit.commands
import omni.timeline
import omni.usd
from isaacsim.core.prims import SingleArticulation
from isaacsim.core.utils.semantics import add_update_semantics
from isaacsim.core.utils.stage import add_reference_to_stage, create_new_stage
from isaacsim.core.utils.types import ArticulationAction
from isaacsim.robot.wheeled_robots.controllers.differential_controller import DifferentialController
from isaacsim.storage.native import get_assets_root_path
from omni.physx import get_physx_scene_query_interface, get_physx_simulation_interface
from omni.physx.scripts import utils
from pxr import Gf, PhysicsSchemaTools, PhysxSchema, Usd, UsdGeom, UsdPhysics

create_new_stage()
stage = omni.usd.get_context().get_stage()
UsdPhysics.Scene.Define(stage, "/physicsScene")
omni.kit.commands.execute(
    "AddGroundPlaneCommand", stage=stage, planePath="/GroundPlane", axis="Z", size=25.0,
    position=Gf.Vec3f(0.0), color=Gf.Vec3f(0.5),
)  # fmt: skip
success, wall = omni.kit.commands.execute(
    "CreatePrim", prim_type="Cube", prim_path="/World/wall", attributes={"size": 1.0}
)
assert success
omni.kit.commands.execute(
    "TransformPrimSRTCommand", path="/World/wall", new_translation=Gf.Vec3d(3.0, 0.0, 0.5),
    new_rotation_euler=Gf.Vec3d(0.0, 0.0, 90.0), new_scale=Gf.Vec3d(4.0, 0.2, 1.0),
)  # fmt: skip
utils.setCollider(wall, "none")
omni.kit.commands.execute("CreatePrimWithDefaultXform", prim_type="Sphere", prim_path="/World/ball")
ball = stage.GetPrimAtPath("/World/ball")
ball.GetAttribute("radius").Set(0.15)
UsdGeom.XformCommonAPI(ball).SetTranslate((1.2, 0.0, 0.15))
utils.setRigidBody(ball, "convexHull", False)
add_reference_to_stage(get_assets_root_path() + "/Isaac/Robots/NVIDIA/NovaCarter/nova_carter.usd", "/World/Carter")
add_update_semantics(wall, "wall")
for prim in Usd.PrimRange(stage.GetPrimAtPath("/World/Carter")):
    if prim.IsA(UsdPhysics.RevoluteJoint):
        PhysxSchema.PhysxJointAPI.Apply(prim).CreateMaxJointVelocityAttr(2000.0)
        assert prim.HasAPI(PhysxSchema.PhysxJointAPI)
        assert PhysxSchema.PhysxJointAPI(prim).GetMaxJointVelocityAttr().Get() == 2000.0

touched = set()


def on_contact(headers, data):
    for header in headers:
        touched.add(tuple(str(PhysicsSchemaTools.intToSdfPath(actor)) for actor in (header.actor0, header.actor1)))


subscription = get_physx_simulation_interface().subscribe_contact_report_events(on_contact)
queries = get_physx_scene_query_interface()
ray = ((0.8, 0.0, 0.5), (1.0, 0.0, 0.0), 10.0)
assert not queries.raycast_closest(*ray)["hit"]  # nothing plays yet
timeline = omni.timeline.get_timeline_interface()
timeline.play()
simulation_app.update()
hit = queries.raycast_closest(*ray)
assert (hit["hit"], hit["collision"]) == (True, "/World/wall")
assert np.allclose([hit["distance"], *hit["normal"]], [2.1, -1.0, 0.0, 0.0], atol=1e-4)
assert queries.raycast_any(*ray)
assert not queries.raycast_any((0.8, 0.0, 0.5), (0.0, 1.0, 0.0), 10.0)
seen = []
queries.raycast_all(Gf.Vec3f(0.6, 0.0, 0.15), Gf.Vec3f(2.0, 0.0, 0.0), 10.0, lambda hit: seen.append(hit) or True)
assert {hit.rigid_body for hit in seen} == {"/World/ball", "/World/wall"}
names = []
box = ((0.3, 0.3, 0.3), (3.0, 0.0, 0.5), (0.0, 0.0, 0.0, 1.0))
assert queries.overlap_box(*box, lambda hit: names.append(hit.rigid_body) or True) == 1
assert names == ["/World/wall"]
assert queries.overlap_sphere_any(0.1, (3.0, 0.0, 0.5))
assert not queries.overlap_sphere_any(0.1, (0.0, 5.0, 0.5))

carter = SingleArticulation("/World/Carter", name="carter")
carter.initialize()
controller = DifferentialController("diff", 0.14, 0.4132)
wheels = np.array([carter.get_dof_index(f"joint_wheel_{side}") for side in ("left", "right")])
while simulation_app.is_running() and timeline.get_current_time() < 10.0:
    speeds = controller.forward([0.4, 0.0]).joint_velocities
    action = ArticulationAction(joint_velocities=speeds, joint_indices=wheels)
    carter.get_articulation_controller().apply_action(action)
    simulation_app.update()
assert ("/World/Carter/chassis_link", "/World/ball") in touched, touched
assert omni.usd.get_world_transform_matrix(ball).ExtractTranslation()[0] > 1.5
assert carter.get_world_pose()[0][0] < 2.9

omni.kit.commands.execute("MovePrimCommand", path_from="/World/ball", path_to="/World/moved")
simulation_app.update()
assert stage.GetPrimAtPath("/World/moved")
omni.kit.commands.execute("DeletePrims", paths=["/World/moved"])
simulation_app.update()
timeline.stop()
print("done")
simulation_app.close()
