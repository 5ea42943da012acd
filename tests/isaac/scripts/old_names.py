"""The names of Isaac Sim 4, which 5.1 still accepts: cuboids, an articulation's controller, callbacks, teleports."""

from omni.isaac.kit import SimulationApp

simulation_app = SimulationApp({"headless": True})

import carb
import numpy as np
from omni.isaac.core import World
from omni.isaac.core.articulations import Articulation
from omni.isaac.core.objects import DynamicCuboid, FixedCuboid, VisualCuboid
from omni.isaac.core.prims import XFormPrim
from omni.isaac.core.prims.xform_prim import XFormPrim as SameXFormPrim
from omni.isaac.core.utils.extensions import enable_extension
from omni.isaac.core.utils.nucleus import get_assets_root_path
from omni.isaac.core.utils.prims import get_prim_at_path
from omni.isaac.core.utils.stage import add_reference_to_stage
from omni.isaac.core.utils.types import ArticulationAction
from omni.isaac.wheeled_robots.controllers.differential_controller import DifferentialController  # noqa: F401
from omni.isaac.wheeled_robots.robots import WheeledRobot  # noqa: F401
from pxr import Usd, UsdGeom

assert enable_extension("omni.isaac.wheeled_robots")
assert SameXFormPrim is XFormPrim
assert carb.settings.get_settings().get("/persistent/isaac/asset_root/default") == get_assets_root_path()

world = World(stage_units_in_meters=1.0, physics_dt=1.0 / 120.0, rendering_dt=1.0 / 60.0)
world.scene.add_ground_plane()
add_reference_to_stage(get_assets_root_path() + "/Isaac/Robots/NVIDIA/NovaCarter/nova_carter.usd", "/World/Carter")
carter = world.scene.add(Articulation(prim_path="/World/Carter", name="carter", position=np.array([0, 0, 0.1])))
cube = world.scene.add(
    DynamicCuboid(
        prim_path="/World/cube", name="cube", position=np.array([2, 1, 1.0]), size=0.3, color=np.array([255, 0, 0])
    )
)
world.scene.add(
    FixedCuboid(prim_path="/World/wall", name="wall", position=np.array([1.2, 0, 0.5]), scale=np.array([0.1, 2, 1]))
)
world.scene.add(VisualCuboid(prim_path="/World/seen", name="seen", position=np.array([0.5, 0, 0.5]), size=0.2))
world.reset()

steps = []
world.add_physics_callback("count", lambda step_size: steps.append(step_size))
wheels = np.array([carter.get_dof_index(f"joint_wheel_{side}") for side in ("left", "right")])
for _ in range(240):
    action = ArticulationAction(joint_velocities=np.array([3.0, 3.0]), joint_indices=wheels)
    carter.get_articulation_controller().apply_action(action)
    world.step(render=True)
assert len(steps) == 480
assert abs(steps[0] - 1.0 / 120.0) < 1e-6
# It went through what is only seen, and stands at the wall; the cube has fallen to the floor.
assert 0.9 < carter.get_world_pose()[0][0] < 1.15
assert np.allclose(cube.get_world_pose()[0], [2.0, 1.0, 0.15], atol=0.02)
matrix = UsdGeom.Xformable(get_prim_at_path("/World/cube")).ComputeLocalToWorldTransform(Usd.TimeCode.Default())
assert np.allclose(matrix.ExtractTranslation(), cube.get_world_pose()[0], atol=1e-5)

# What is added while it plays falls too, and the rest goes on from where it is.
before = carter.get_world_pose()[0]
late = world.scene.add(DynamicCuboid(prim_path="/World/late", name="late", position=np.array([-2, 0, 1.0]), size=0.2))
for _ in range(60):
    world.step(render=True)
assert abs(late.get_world_pose()[0][2] - 0.1) < 0.01
assert np.allclose(carter.get_world_pose()[0], before, atol=0.05)

carter.set_world_pose(position=np.array([-1.0, -1.0, 0.02]))
carter.set_joint_velocities(np.zeros(carter.num_dof))
cube.set_world_pose(position=np.array([3.0, 3.0, 2.0]))
world.step(render=False)
assert np.allclose(carter.get_world_pose()[0][:2], [-1.0, -1.0], atol=0.05)
assert np.allclose(cube.get_world_pose()[0], [3.0, 3.0, 2.0], atol=0.01)

world.stop()
world.scene.remove_object("late")
world.reset()
assert np.allclose(cube.get_world_pose()[0], [2.0, 1.0, 1.0], atol=0.02)
assert np.allclose(XFormPrim("/World/Carter").get_world_pose()[0][:2], [0.0, 0.0], atol=0.02)
world.clear_instance()
print("done")
simulation_app.close()
