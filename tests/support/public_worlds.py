"""Small files in the formats of BARN and DynaBARN."""

import json

import numpy as np

CYLINDER = """
<model name='unit_cylinder_{i}'><static>1</static><pose>{x} {y} 0 0 0 0</pose><link name='link'>
<collision name='c'><geometry><cylinder><radius>0.075</radius><length>1</length></cylinder></geometry></collision>
</link></model>"""


def world_text(places):
    models = "".join(CYLINDER.format(i=i, x=x, y=y) for i, (x, y) in enumerate(places))
    return f"<sdf version='1.6'><world name='default'>{models}</world></sdf>"


def cells_of(points):
    """The cells of a path of BARN's through points [m]."""
    return np.round((np.asarray(points) - (-4.575, 5.075)) / 0.15).astype(np.int64)


def write_barn(folder, number, places=()):
    """Write world_N.world, and a straight path_N.npy."""
    folder.mkdir(exist_ok=True)
    sides = ((-4.2, 5.0 + 0.1 * number), (-0.3, 5.0))
    (folder / f"world_{number}.world").write_text(world_text(places or sides))
    np.save(folder / f"path_{number}.npy", cells_of([(-2.175, y) for y in np.arange(5.075, 9.5, 0.15)]))


def dynabarn_world(level="easy", *tracks):
    """A world; each track is (x, y, period): an obstacle that moves by 1 m in x."""
    obstacles = [
        {"period_s": period, "waypoints": [[0.0, x, y], [period / 2.0, x + 1.0, y], [period, x, y]]}
        for x, y, period in tracks
    ]
    return {"level": level, "obstacles": obstacles}


def write_dynabarn(file):
    """Write an easy world, 0, and a hard one, 3."""
    worlds = {
        "world_0": dynabarn_world("easy", (0.0, 5.0, 10.0)),
        "world_3": dynabarn_world("hard", (0.0, 5.0, 10.0), (-5.0, -4.0, 8.0)),
    }
    file.write_text(json.dumps(worlds))
