"""Small files of robots and worlds, which the fuzzer of loaders begins with."""

from __future__ import annotations

from pathlib import Path


def write(folder: Path, files: dict[str, str]) -> list[Path]:
    for name, text in files.items():
        (folder / name).write_text(text)
    return [folder / name for name in files]


def _wheels(form: str) -> str:
    return "".join(form.format(side=side, y=y) for side, y in (("left", 0.12), ("right", -0.12)))


def urdf(folder: Path) -> list[Path]:
    """A robot with two wheels and a mesh."""
    _box(folder / "box.stl")
    wheel = (
        "\n<link name='{side}'><collision><origin xyz='0 0 0' rpy='1.5708 0 0'/><geometry><cylinder radius='.05'"
        " length='.02'/></geometry></collision><inertial><mass value='.1'/><inertia ixx='1e-4' iyy='1e-4' izz='1e-4'"
        " ixy='0' ixz='0' iyz='0'/></inertial></link>\n<joint name='{side}_wheel' type='continuous'><parent link='base'/>"
        "<child link='{side}'/><origin xyz='0 {y} .05'/><axis xyz='0 1 0'/><limit velocity='10' effort='5'/></joint>"
    )
    return write(
        folder,
        {
            "robot.urdf": "<robot name='r'>\n<link name='base'>\n<collision><origin xyz='0 0 .1'/>\n<geometry><box size='.4 .2 "
            ".1'/></geometry></collision>\n<visual><geometry><mesh filename='box.stl' scale='.1 .1 .1'/></geometry></visual>\n"
            "<inertial><mass value='5'/><inertia ixx='.1' iyy='.1' izz='.1' ixy='0' ixz='0' iyz='0'/></inertial></link>"
            + _wheels(wheel)
            + "\n</robot>\n"
        },
    )


def mjcf(folder: Path) -> list[Path]:
    """A robot with two wheels beside shapes of all kinds."""
    _box(folder / "box.stl")
    wheel = (
        "\n<body name='{side}' pos='0 {y} -.05'><joint name='{side}_wheel' type='hinge' axis='0 1 0'/><geom type='cylinder'"
        " size='.05 .02' euler='90 0 0' mass='.1'/></body>"
    )
    return write(
        folder,
        {
            "robot.xml": "<mujoco model='r'>\n<compiler angle='degree'/>\n<asset><mesh name='box' file='box.stl' scale='1 1 2'/>\n"
            "<hfield name='h' nrow='4' ncol='5' size='1 1 .5 .1'/><material name='m' rgba='1 0 0 1'/></asset>\n<worldbody>\n"
            "<geom type='plane' size='0 0 1'/><geom name='pillar' type='box' size='.5 .5 .5' pos='3 2 0' material='m'/>\n"
            "<geom type='mesh' mesh='box' pos='5 0 0'/><geom type='hfield' hfield='h' pos='8 0 0'/>\n<geom type='capsule' "
            "fromto='0 4 0 0 4 1' size='.1'/><replicate count='3' offset='1 0 0'><geom type='ellipsoid' size='.1 .2 .3'/>"
            "</replicate>\n<body name='c' pos='0 0 .1'><freejoint/><inertial pos='0 0 0' mass='5' diaginertia='.1 .1 .1'/>\n"
            "<geom type='box' size='.2 .1 .05'/>"
            + _wheels(wheel)
            + "</body></worldbody>\n<actuator><motor joint='left_wheel'/><motor joint='right_wheel'/></actuator>\n</mujoco>\n"
        },
    )


def sdf(folder: Path) -> list[Path]:
    """Models, includes, frames and shapes."""
    _box(folder / "box.stl")
    shapes = (
        "<box><size>1 2 3</size></box>",
        "<cylinder><radius>.5</radius><length>2</length></cylinder>",
        "<sphere><radius>.25</radius></sphere>",
        "<capsule><radius>.2</radius><length>1</length></capsule>",
        "<ellipsoid><radii>1 2 3</radii></ellipsoid>",
        "<plane><normal>0 0 1</normal><size>4 4</size></plane>",
        "<mesh><uri>box.stl</uri><scale>1 1 1</scale></mesh>",
    )
    models = "\n".join(
        f"<model name='m{i}'><static>true</static><pose>{i} 0 .5 0 0 .3</pose><frame name='f'><pose>1 0 0 0 0 0</pose></frame>"
        f"<link name='l'><pose relative_to='f'>0 0 1 0 0 0</pose><collision name='c'><geometry>{shape}</geometry></collision>"
        f"<visual name='c'><geometry>{shape}</geometry><material><diffuse>1 0 0 1</diffuse></material></visual></link></model>"
        for i, shape in enumerate(shapes)
    )
    included = (
        "<sdf version='1.8'>\n<model name='inner'><static>1</static><link name='l'><collision name='c'><geometry>\n"
    )
    (folder / "inner.sdf").write_text(included + f"{shapes[0]}</geometry></collision></link></model></sdf>")
    include = "<include><uri>inner.sdf</uri><name>again</name><pose>0 5 0 0 0 0</pose></include>"
    world = f"<?xml version='1.0'?>\n<sdf version='1.9'>\n<world name='hall'>\n{models}\n{include}\n</world></sdf>"
    return [*write(folder, {"world.sdf": world}), folder / "inner.sdf"]


def usd(folder: Path) -> list[Path]:
    """A stage with shapes, a mesh, an instancer, a reference and a joint, as text and as a crate."""
    from pxr import Usd

    text = """#usda 1.0
(
    defaultPrim = "World"
    metersPerUnit = 0.01
    upAxis = "Y"
)
def Xform "World" {
    def Cube "Box" (prepend apiSchemas = ["PhysicsCollisionAPI"]) {
        double size = 100
        double3 xformOp:translate = (1, 2, 3)
        uniform token[] xformOpOrder = ["xformOp:translate"]
    }
    def Cylinder "Post" { double height = 200
        double radius = 20
        uniform token axis = "Y"
    }
    def Mesh "Slab" {
        int[] faceVertexCounts = [4, 3]
        int[] faceVertexIndices = [0, 1, 2, 3, 0, 2, 4]
        point3f[] points = [(0, 0, 0), (100, 0, 0), (100, 100, 0), (0, 100, 0), (0, 0, 100)]
    }
    def PointInstancer "Racks" {
        point3f[] positions = [(0, 0, 0), (300, 0, 0)]
        int[] protoIndices = [0, 0]
        rel prototypes = </World/Racks/Rack>
        def Sphere "Rack" {
            double radius = 30
        }
    }
    def "Copy" (prepend references = </World/Slab>) {}
    def PhysicsRevoluteJoint "Joint" { rel physics:body0 = </World/Box>
        rel physics:body1 = </World/Post>
        uniform token physics:axis = "Z"
        float physics:lowerLimit = -90
    }
}
"""
    (source,) = write(folder, {"scene.usda": text})
    stage = Usd.Stage.Open(str(source))
    stage.GetRootLayer().Export(str(folder / "crate.usdc"))
    return [source, folder / "crate.usdc"]


def _box(file: Path) -> None:
    import trimesh

    trimesh.creation.box().export(file)


def mesh(folder: Path) -> list[Path]:
    """A scene of two boxes in every format."""
    import trimesh

    scene = trimesh.Scene()
    for name, place in (("a", 0.0), ("b", 3.0)):
        box = trimesh.creation.box()
        box.apply_translation((place, 0, 0))
        box.visual = trimesh.visual.TextureVisuals(material=trimesh.visual.material.SimpleMaterial())
        scene.add_geometry(box, node_name=name, geom_name=name)
    files = [folder / f"scene.{suffix}" for suffix in ("glb", "obj", "stl", "ply", "dae")]
    for file in files:
        (scene if file.suffix in (".glb", ".obj") else trimesh.creation.box()).export(file)
    trimesh.creation.box().export(folder / "ascii.stl", file_type="stl_ascii")
    trimesh.creation.box().export(folder / "ascii.ply", encoding="ascii")
    gltf = trimesh.exchange.gltf.export_gltf(scene)
    for name, content in gltf.items():
        (folder / name).write_bytes(content)
    return [*files, folder / "ascii.stl", folder / "ascii.ply", folder / "model.gltf"]
