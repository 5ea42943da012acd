"""What a script changes in USD while it plays: one robot's drives, poses of bodies and obstacles, velocities."""

from isaacsim import SimulationApp

simulation_app = SimulationApp({"headless": True})

import numpy as np
import omni.usd
from isaacsim.core.api import World
from isaacsim.core.api.objects import DynamicCuboid, FixedCuboid
from isaacsim.core.api.robots import Robot
from isaacsim.core.prims import RigidPrim
from isaacsim.core.utils.prims import create_prim
from isaacsim.core.utils.stage import add_reference_to_stage
from isaacsim.storage.native import get_assets_root_path
from pxr import Gf, Usd, UsdGeom, UsdPhysics

world = World(stage_units_in_meters=1.0, physics_dt=1.0 / 100.0, rendering_dt=1.0 / 50.0)
world.scene.add_default_ground_plane()
stage = omni.usd.get_context().get_stage()
robots = []
for number, name in enumerate(("first", "second")):
    add_reference_to_stage(get_assets_root_path() + "/Isaac/Robots/NVIDIA/NovaCarter/nova_carter.usd", f"/World/{name}")
    robots.append(world.scene.add(Robot(f"/World/{name}", name=name, position=np.array([0.0, 3.0 * number, 0.03]))))
box = world.scene.add(DynamicCuboid("/World/box", "box", position=np.array([4.0, 0.0, 0.1]), size=0.2, mass=1.0))
pusher = world.scene.add(DynamicCuboid("/World/pusher", "pusher", position=np.array([-2.0, -3.0, 0.1]), size=0.2))
UsdPhysics.RigidBodyAPI(pusher.prim).CreateKinematicEnabledAttr(True)
create_prim("/World/shelves", "Xform")
shelf = world.scene.add(FixedCuboid("/World/shelves/one", "one", position=np.array([8.0, 8.0, 0.25]), size=0.5))


def steps(count, render=False):
    for _ in range(count):
        world.step(render=render)


def attribute(path, name):
    return stage.GetPrimAtPath(path).GetAttribute(name)


def in_usd(path):
    matrix = UsdGeom.Xformable(stage.GetPrimAtPath(path)).ComputeLocalToWorldTransform(Usd.TimeCode.Default())
    return np.array(matrix.ExtractTranslation())


world.reset()
steps(50)
rest = [robot.get_world_pose()[0] for robot in robots]

# A drive's target is that of one robot, though both have joints of the same names.
for prim in Usd.PrimRange(stage.GetPrimAtPath("/World/first")):
    if prim.GetName() in ("joint_wheel_left", "joint_wheel_right"):
        UsdPhysics.DriveAPI.Get(prim, "angular").GetTargetVelocityAttr().Set(float(np.degrees(2.0)))
steps(100)
assert robots[0].get_world_pose()[0][0] - rest[0][0] > 0.2
assert np.allclose(robots[1].get_world_pose()[0], rest[1], atol=1e-3)
# One whose joint has stiffness goes to a position.
swing = robots[1].get_dof_index("joint_swing_left")
drive = UsdPhysics.DriveAPI.Apply(stage.GetPrimAtPath("/World/second/joints/joint_swing_left"), "angular")
drive.CreateStiffnessAttr(10.0)
drive.CreateDampingAttr(1.0)
steps(1)
drive.CreateTargetPositionAttr(30.0)
steps(300)
assert abs(robots[1].get_joint_positions()[swing] - np.radians(30.0)) < 0.1, robots[1].get_joint_positions()

# A body, though the physics has moved it since; also back to where it began.
attribute("/World/box", "xformOp:translate").Set(Gf.Vec3d(4.0, 2.0, 1.0))
assert np.allclose(box.get_world_pose()[0], [4.0, 2.0, 1.0])
steps(100, render=True)
assert np.allclose(box.get_world_pose()[0], [4.0, 2.0, 0.1], atol=5e-3)
assert np.allclose(in_usd("/World/box"), box.get_world_pose()[0], atol=1e-5)
attribute("/World/box", "xformOp:translate").Set(Gf.Vec3d(4.0, 0.0, 0.1))
assert np.allclose(box.get_world_pose()[0], [4.0, 0.0, 0.1])

# An obstacle under it, and one that is moved by the prim above it.
obstacle = world.scene.add(FixedCuboid("/World/obstacle", "obstacle", position=np.array([7.0, 0.0, 0.25]), size=0.5))
steps(1)
obstacle.set_world_pose(position=np.array([4.0, 0.0, -0.2]))
steps(100)
assert np.allclose(box.get_world_pose()[0], [4.0, 0.0, 0.15], atol=0.01), box.get_world_pose()[0]
attribute("/World/shelves", "xformOp:translate").Set(Gf.Vec3d(0.0, 0.0, -0.2))
box.set_world_pose(position=np.array([8.0, 8.0, 0.5]))
box.set_linear_velocity(np.zeros(3))
steps(100)
assert np.allclose(box.get_world_pose()[0], [8.0, 8.0, 0.4], atol=0.01), box.get_world_pose()[0]
# A collider within a body.
attribute("/World/box", "xformOp:scale").Set(Gf.Vec3d(1.0, 1.0, 2.0))
steps(100)
assert abs(box.get_world_pose()[0][2] - 0.5) < 0.01, box.get_world_pose()[0]

# A whole robot by the prim above its bodies, or by its root link; a wheel alone stays.
attribute("/World/second", "xformOp:translate").Set(Gf.Vec3d(5.0, -6.0, 0.0))
place = [rest[1][0] + 5.0, rest[1][1] - 6.0]
assert np.allclose(robots[1].get_world_pose()[0][:2], place, atol=2e-3)
steps(50, render=True)
assert np.allclose(in_usd("/World/second/chassis_link"), robots[1].get_world_pose()[0], atol=1e-5)
assert np.allclose(robots[1].get_world_pose()[0][:2], place, atol=0.01)
attribute("/World/second/wheel_left", "xformOp:translate").Set(Gf.Vec3d(9.0, 9.0, 9.0))
steps(2, render=True)
assert np.linalg.norm(in_usd("/World/second/wheel_left") - robots[1].get_world_pose()[0]) < 1.0
attribute("/World/second/chassis_link", "xformOp:translate").Set(Gf.Vec3d(-10.0, 2.0, 0.0))
assert np.allclose(robots[1].get_world_pose()[0], [-5.0, -4.0, 0.0], atol=1e-4)

# A kinematic body pushes what is in its way as fast as it goes.
box.set_world_pose(position=np.array([0.0, -3.0, 0.2]), orientation=np.array([1.0, 0.0, 0.0, 0.0]))
box.set_linear_velocity(np.zeros(3))
for step in range(200):
    attribute("/World/pusher", "xformOp:translate").Set(Gf.Vec3d(-2.0 + 0.01 * step, -3.0, 0.1))
    world.step(render=False)
assert abs(pusher.get_world_pose()[0][0] + 0.01) < 1e-4
assert 0.15 < box.get_world_pose()[0][0] < 0.3
assert 0.5 < box.get_linear_velocity()[0] < 1.5, box.get_linear_velocity()

# A body in flight flies on when something is added, and gets the velocity that is set in USD.
box.set_world_pose(position=np.array([0.0, -8.0, 5.0]), orientation=np.array([1.0, 0.0, 0.0, 0.0]))
box.set_linear_velocity(np.array([1.0, 0.0, 2.0]))
box.set_angular_velocity(np.array([0.0, 0.0, 3.0]))
steps(1)
FixedCuboid("/World/late", "late", position=np.array([20.0, 0.0, 0.5]))
steps(1)
assert np.allclose(box.get_linear_velocity(), [1.0, 0.0, 2.0 - 9.81 * 0.02], atol=0.01), box.get_linear_velocity()
assert np.allclose(box.get_angular_velocity(), [0.0, 0.0, 3.0], atol=0.05)
attribute("/World/box", "physics:velocity").Set(Gf.Vec3f(0.0, -1.0, 0.0))
assert np.allclose(box.get_linear_velocity(), [0.0, -1.0, 0.0])
assert np.allclose(box.get_angular_velocity(), [0.0, 0.0, 3.0], atol=0.05)

# Gains and masses that are not in USD stay when something is added.
controller = robots[0].get_articulation_controller()
gains = controller.get_gains()
controller.set_gains(kps=gains[0], kds=gains[1] + 7.0)
RigidPrim("/World/box").set_masses(np.array([3.0]))
FixedCuboid("/World/last", "last", position=np.array([20.0, 5.0, 0.5]))
steps(1)
assert np.allclose(controller.get_gains()[1], gains[1] + 7.0)
assert np.allclose(RigidPrim("/World/box").get_masses(), [3.0])
UsdPhysics.DriveAPI(stage.GetPrimAtPath("/World/first/joints/joint_wheel_left"), "angular").GetDampingAttr().Set(5.0)
assert np.allclose(controller.get_gains()[1][robots[0].get_dof_index("joint_wheel_left")], np.degrees(5.0), rtol=1e-3)

# At the end all is where it was, and the layer has nothing more than before.
world.stop()
assert np.allclose(in_usd("/World/box"), [4.0, 0.0, 0.1])
assert np.allclose(in_usd("/World/first/chassis_link")[:2], [0.0, 0.0])
assert not stage.GetRootLayer().GetPrimAtPath("/World/first/wheel_left")
print("done")
simulation_app.close()
