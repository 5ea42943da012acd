"""Load Nova Carter into the warehouse, and look at it until the window is closed."""

from isaacsim import SimulationApp

simulation_app = SimulationApp({"headless": False, "width": 1280, "height": 720})

import sys

import carb
import numpy as np
import omni.timeline
import omni.usd
from isaacsim.core.api import World
from isaacsim.core.utils.prims import is_prim_path_valid
from isaacsim.core.utils.stage import add_reference_to_stage, is_stage_loading
from isaacsim.core.utils.viewports import set_camera_view
from isaacsim.storage.native import get_assets_root_path

assets_root_path = get_assets_root_path()
if assets_root_path is None:
    carb.log_error("Could not find Isaac Sim assets folder")
    simulation_app.close()
    sys.exit()

my_world = World(stage_units_in_meters=1.0)
add_reference_to_stage(
    usd_path=assets_root_path + "/Isaac/Environments/Simple_Warehouse/warehouse_with_forklifts.usd",
    prim_path="/World/Warehouse",
)
add_reference_to_stage(
    usd_path=assets_root_path + "/Isaac/Robots/NVIDIA/NovaCarter/nova_carter.usd", prim_path="/World/Nova_Carter"
)
simulation_app.update()
while is_stage_loading():
    simulation_app.update()

set_camera_view(
    eye=np.array([4.0, -4.0, 3.0]), target=np.array([0.0, 0.0, 0.5]), camera_prim_path="/OmniverseKit_Persp"
)
my_world.reset()
omni.timeline.get_timeline_interface().play()

frames = 0
while simulation_app.is_running():
    my_world.step(render=True)
    frames += 1

stage = omni.usd.get_context().get_stage()
prims = [prim for prim in stage.Traverse() if str(prim.GetPath()).startswith("/World/Nova_Carter")]
print(f"frames: {frames}, simulated: {my_world.current_time:.2f} s, prims of the robot: {len(prims)}")
print(f"loaded: {is_prim_path_valid('/World/Nova_Carter')}, {is_prim_path_valid('/World/Warehouse')}")
simulation_app.close()
