"""List the revolute joints of Nova Carter with USD's own classes."""

from isaacsim import SimulationApp

simulation_app = SimulationApp({"headless": True})

import omni.usd
from isaacsim.core.utils.stage import add_reference_to_stage, open_stage
from isaacsim.storage.native import get_assets_root_path
from pxr import Usd, UsdPhysics

root = get_assets_root_path()
open_stage(usd_path=root + "/Isaac/Environments/Grid/default_environment.usd")
add_reference_to_stage(root + "/Isaac/Robots/NVIDIA/NovaCarter/nova_carter.usd", "/World/Carter")
for _ in range(10):
    simulation_app.update()

stage = omni.usd.get_context().get_stage()
for prim in Usd.PrimRange(stage.GetPrimAtPath("/World/Carter")):
    if prim.IsA(UsdPhysics.RevoluteJoint):
        joint = UsdPhysics.RevoluteJoint(prim)
        drive = UsdPhysics.DriveAPI.Get(prim, "angular")
        damping = drive.GetDampingAttr().Get() if drive else None
        print(prim.GetName(), prim.GetTypeName(), joint.GetAxisAttr().Get(), damping)

simulation_app.close()
