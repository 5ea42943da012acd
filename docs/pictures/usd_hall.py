"""A hall as Isaac Sim has them, in centimetres with y up, and the picture of it beside its map.

python docs/pictures/usd_hall.py hall.usda                    # writes the stage
python docs/pictures/usd_hall.py docs/images/usd_hall.png     # writes the picture
"""

import math
import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw
from pxr import Gf, Sdf, Usd, UsdGeom, UsdPhysics, Vt

import trundle
from trundle.pictures.figure import font
from trundle.viewer.cameras import Camera
from trundle.viewer.scene import render

CM = 100.0
"""The hall is laid out in metres with z up below; only what goes into the stage is in centimetres with y up."""

STEEL, ORANGE, BLUE = (0.55, 0.57, 0.6), (0.9, 0.45, 0.1), (0.15, 0.3, 0.6)
CARTON, WALL, YELLOW, GREEN = (0.76, 0.6, 0.42), (0.86, 0.87, 0.88), (0.95, 0.75, 0.1), (0.2, 0.5, 0.35)
PICTURE_HEIGHT = 470


def at(x, y, z):
    """A point of the hall [m], z up, in the stage's axes [cm]."""
    return Gf.Vec3d(CM * x, CM * z, -CM * y)


def box(stage, path, middle, size, color, *, collides=True):
    cube = UsdGeom.Cube.Define(stage, path)
    cube.CreateSizeAttr(1.0)
    cube.CreateDisplayColorAttr([color])
    cube.AddTranslateOp().Set(at(*middle))
    cube.AddScaleOp().Set(Gf.Vec3f(CM * size[0], CM * size[2], CM * size[1]))
    if collides:
        UsdPhysics.CollisionAPI.Apply(cube.GetPrim())
    return cube


def label(prim, text):
    """A semantic label, as Isaac Sim writes it."""
    prim.AddAppliedSchema("SemanticsLabelsAPI:class")
    prim.CreateAttribute("semantics:labels:class", Sdf.ValueTypeNames.TokenArray).Set([text])


def add_shell(stage):
    floor = UsdGeom.Plane.Define(stage, "/World/GroundPlane")
    floor.CreateAxisAttr("Y")
    floor.CreatePurposeAttr(UsdGeom.Tokens.guide)
    UsdPhysics.CollisionAPI.Apply(floor.GetPrim())
    for name, middle, size in (
        ("North", (0, 5.1, 0.6), (16.4, 0.2, 1.2)),
        ("South", (0, -5.1, 0.6), (16.4, 0.2, 1.2)),
        ("West", (-8.1, 0, 0.6), (0.2, 10, 1.2)),
        ("East", (8.1, 0, 0.6), (0.2, 10, 1.2)),
        ("Office", (4.9, 1.6, 0.6), (0.1, 6.8, 1.2)),
    ):
        box(stage, f"/World/Walls/{name}", middle, size, WALL)
    roof = box(stage, "/World/Roof", (0, 0, 4.0), (16.4, 10.4, 0.1), STEEL)
    label(roof.GetPrim(), "ceiling")


def add_racks(stage):
    """One rack in a class, and six instances of it, those of the second row mirrored."""
    stage.CreateClassPrim("/Rack")
    for number, (x, y) in enumerate([(-1.3, -0.5), (1.3, -0.5), (-1.3, 0.5), (1.3, 0.5)]):
        box(stage, f"/Rack/Post{number}", (x, y, 1.0), (0.08, 0.08, 2.0), BLUE)
    for number, z in enumerate((0.85, 1.9)):
        box(stage, f"/Rack/Shelf{number}", (0, 0, z), (2.6, 1.0, 0.06), ORANGE)
    for number, (x, z, width) in enumerate([(-0.7, 0.25, 0.8), (0.9, 0.25, 0.5), (-0.2, 1.13, 0.8), (0.8, 1.13, 0.5)]):
        box(stage, f"/Rack/Carton{number}", (x, 0.05, z), (width, 0.7, 0.5), CARTON)
    for row, y in enumerate((2.6, -0.6)):
        for col in range(3):
            rack = UsdGeom.Xform.Define(stage, f"/World/Racks/Rack_{row}_{col}")
            rack.AddTranslateOp().Set(at(-5.6 + 3.2 * col, y, 0))
            rack.AddScaleOp().Set(Gf.Vec3f(1 - 2 * row, 1, 1))
            rack.GetPrim().GetReferences().AddInternalReference("/Rack")
            rack.GetPrim().SetInstanceable(True)


def add_barrels(stage):
    instancer = UsdGeom.PointInstancer.Define(stage, "/World/Barrels")
    barrel = UsdGeom.Cylinder.Define(stage, "/World/Barrels/Prototypes/Barrel")
    barrel.CreateRadiusAttr(0.29 * CM)
    barrel.CreateHeightAttr(0.88 * CM)
    barrel.CreateAxisAttr("Y")
    barrel.CreateDisplayColorAttr([GREEN])
    barrel.AddTranslateOp().Set(at(0, 0, 0.44))
    UsdPhysics.CollisionAPI.Apply(barrel.GetPrim())
    places = [(6.1, 3.9), (6.8, 3.9), (6.45, 4.5), (-7.2, -4.3), (-6.5, -4.4), (3.9, -4.2)]
    instancer.CreatePrototypesRel().SetTargets([barrel.GetPath()])
    instancer.CreateProtoIndicesAttr([0] * len(places))
    instancer.CreatePositionsAttr([Gf.Vec3f(at(x, y, 0)) for x, y in places])


def add_conveyor(stage):
    """A bench in the form of a U, one left-handed mesh of quads and octagons with a convex decomposition."""
    outline = [(0, 0), (3, 0), (3, 2), (2.4, 2), (2.4, 0.6), (0.6, 0.6), (0.6, 2), (0, 2)]
    count = len(outline)
    points = [at(x - 1.8, y - 4.4, z) for z in (0.0, 0.75) for x, y in outline]
    sides = [(i, (i + 1) % count, (i + 1) % count + count, i + count) for i in range(count)]
    faces = [tuple(reversed(range(count))), tuple(range(count, 2 * count)), *sides]
    mesh = UsdGeom.Mesh.Define(stage, "/World/Conveyor")
    mesh.CreatePointsAttr(Vt.Vec3fArray([Gf.Vec3f(point) for point in points]))
    mesh.CreateFaceVertexCountsAttr([len(face) for face in faces])
    mesh.CreateFaceVertexIndicesAttr([corner for face in faces for corner in reversed(face)])
    mesh.CreateOrientationAttr(UsdGeom.Tokens.leftHanded)
    mesh.CreateDisplayColorAttr([YELLOW])
    UsdPhysics.CollisionAPI.Apply(mesh.GetPrim())
    UsdPhysics.MeshCollisionAPI.Apply(mesh.GetPrim()).CreateApproximationAttr("convexDecomposition")


def add_robot(stage):
    """Something that stands there and is no part of the map."""
    robot = UsdGeom.Xform.Define(stage, "/World/Robot")
    robot.AddTranslateOp().Set(at(3.2, 1.0, 0))
    UsdPhysics.ArticulationRootAPI.Apply(robot.GetPrim())
    box(stage, "/World/Robot/Body", (0, 0, 0.3), (0.7, 0.5, 0.4), (0.2, 0.2, 0.2))


def write_stage(path):
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageMetersPerUnit(stage, 1.0 / CM)
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
    stage.SetDefaultPrim(UsdGeom.Xform.Define(stage, "/World").GetPrim())
    for add in (add_shell, add_racks, add_barrels, add_conveyor, add_robot):
        add(stage)
    for number, angle in enumerate(np.radians([10, 50, 80])):
        cone = UsdGeom.Cone.Define(stage, f"/World/Cones/Cone{number}")
        cone.CreateRadiusAttr(0.2 * CM)
        cone.CreateHeightAttr(0.6 * CM)
        cone.CreateAxisAttr("Y")
        cone.CreateDisplayColorAttr([ORANGE])
        cone.AddTranslateOp().Set(at(4.9 + 1.4 * math.cos(angle), -3.6 + 1.4 * math.sin(angle), 0.3))
        UsdPhysics.CollisionAPI.Apply(cone.GetPrim())
    stage.Save()


def draw(path):
    with tempfile.TemporaryDirectory() as folder:
        write_stage(Path(folder) / "hall.usda")
        world = trundle.World.load(Path(folder) / "hall.usda", exclude=["/World/Robot", "ceiling"])
        robot = trundle.Robot.load("nova_carter")
        grid = trundle.OccupancyGrid.from_world(world, resolution=0.05, z_range=robot.z_range)
        grid.save(Path(folder) / "map.yaml")
        map_image = Image.open(Path(folder) / "map.png").convert("RGB")
    scene = Image.fromarray(
        render(
            world,
            robot,
            (-7, 0.9, 0),
            size=(690, PICTURE_HEIGHT),
            camera=Camera((-4.5, -14.0, 14.5), (0.2, -0.3, 0.0), 39.0),
        ).pixels
    )
    scale = min(690 / map_image.width, (PICTURE_HEIGHT - 40) / map_image.height)
    size = (round(map_image.width * scale), round(map_image.height * scale))
    page = Image.new("RGB", (2 * 690, PICTURE_HEIGHT + 36), "white")
    page.paste(scene, (0, 36))
    map_image = map_image.resize(size, Image.Resampling.LANCZOS)
    page.paste(map_image, (690 + (690 - size[0]) // 2, 36 + (PICTURE_HEIGHT - size[1]) // 2))
    pen = ImageDraw.Draw(page)
    pen.text((12, 8), "hall.usda: centimetres, y up", fill="black", font=font(17))
    pen.text((702, 8), "map.yaml: 0.05 m cells, what Nova Carter meets", fill="black", font=font(17))
    page.quantize(192, dither=Image.Dither.NONE).save(path, optimize=True)


if __name__ == "__main__":
    target = Path(sys.argv[1])
    draw(target) if target.suffix == ".png" else write_stage(target)
