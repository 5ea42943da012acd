"""Assets for the stand-in."""

from trundle.export.usd import export_robot, export_world
from trundle.geometry import Pose3D
from trundle.geometry.solids import Box, Solid
from trundle.robots import Robot
from trundle.sim.isaac.assets import ENVIRONMENTS, ROBOTS
from trundle.worlds import World


def make_assets(folder, robot="nova_carter"):
    """Write a folder of assets with one robot and one environment in it, as trundle's own exporter writes them."""
    for below in (ROBOTS[robot], *ENVIRONMENTS.values()):
        (folder / below).parent.mkdir(parents=True, exist_ok=True)
    export_robot(Robot.load(robot), folder / ROBOTS[robot])
    walls = (
        Solid("north", Box((8.0, 0.2, 1.0)), Pose3D((0.0, 3.0, 0.5))),
        Solid("south", Box((8.0, 0.2, 1.0)), Pose3D((0.0, -3.0, 0.5))),
        Solid("east", Box((0.2, 6.0, 1.0)), Pose3D((4.0, 0.0, 0.5))),
        Solid("west", Box((0.2, 6.0, 1.0)), Pose3D((-4.0, 0.0, 0.5))),
        Solid("crate", Box((0.6, 0.6, 0.8)), Pose3D((0.0, 0.0, 0.4))),
    )
    world = World("hall", walls, seeds=((-2.5, 0.0),))
    export_world(world, folder / ENVIRONMENTS["warehouse"])
    return world
