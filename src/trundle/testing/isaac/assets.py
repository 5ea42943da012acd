"""Assets under NVIDIA's names: trundle's robots, warehouse and ground plane. `assets.py FOLDER` writes them."""

from __future__ import annotations

import sys
from pathlib import Path

from pxr import Usd, UsdGeom, UsdLux

from trundle.export.usd import export_robot
from trundle.robots import Robot
from trundle.sim.isaac.assets import ENVIRONMENTS, ROBOTS
from trundle.testing.isaac.stage import add_ground_plane
from trundle.usd.write import write_world
from trundle.worlds import World

GROUND = "Isaac/Environments/Grid/default_environment.usd"


def write_assets(folder: Path) -> None:
    """Write a folder of assets. The names are NVIDIA's; the contents are trundle's own."""
    for name, below in ROBOTS.items():
        (folder / below).parent.mkdir(parents=True, exist_ok=True)
        export_robot(Robot.load(name), folder / below, profile="isaac")
    _name_chassis(folder / ROBOTS["nova_carter"])
    warehouse = World.generate("warehouse")
    for below in ENVIRONMENTS.values():
        if "Simple_Warehouse" in below:
            (folder / below).parent.mkdir(parents=True, exist_ok=True)
            write_world(warehouse, folder / below, profile="isaac")
    (folder / GROUND).parent.mkdir(parents=True, exist_ok=True)
    write_ground(folder / GROUND)


def _name_chassis(path: Path) -> None:
    """Name Nova Carter's chassis as NVIDIA does, for scripts that look for it."""
    stage = Usd.Stage.Open(str(path))
    editor = Usd.NamespaceEditor(stage)
    body = stage.GetDefaultPrim().GetPath().AppendChild("base_link")
    editor.MovePrimAtPath(body, body.ReplaceName("chassis_link"))
    editor.ApplyEdits()
    stage.GetRootLayer().Save()


def write_ground(path: Path) -> None:
    """Write a ground plane at z = 0, with a light, in the prims of NVIDIA's default environment."""
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    stage.SetDefaultPrim(UsdGeom.Xform.Define(stage, "/World").GetPrim())
    UsdLux.DistantLight.Define(stage, "/World/defaultDistantLight").CreateIntensityAttr(1000.0)
    add_ground_plane(stage, "/World/GroundPlane")
    stage.GetRootLayer().Save()


if __name__ == "__main__":
    write_assets(Path(sys.argv[1]))
