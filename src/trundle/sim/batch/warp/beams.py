"""Kernels of lidars: a thread for a beam of a robot."""

# pyright: reportAttributeAccessIssue=false, reportInvalidTypeForm=false, reportOperatorIssue=false
# pyright: reportCallIssue=false, reportIndexIssue=false, reportArgumentType=false

from typing import Any

import warp as wp

from trundle.sim.batch.warp.arithmetic import (
    EXACT,
    FAR,
    ONE,
    ZERO,
    far,
    greater,
    lesser,
    normal,
    sin_cos,
    stored,
    uniform,
)
from trundle.sim.batch.warp.model import Model, mover_of, placed_corner, to_cells, turned
from trundle.sim.batch.warp.rays import cast_ray

BLOCK = 128
"""Threads of a block that casts beams. Ten of them on a multiprocessor hide what each waits for, though registers
spill: on an H200 4,096 robots take 70 µs, with twelve 73."""

wp.set_module_options(EXACT | {"block_dim": BLOCK})


@wp.kernel
def place_lidars(
    model: Model,
    active: wp.array(dtype=wp.bool),
    poses: wp.array2d(dtype=wp.float64),
    places: wp.array2d(dtype=wp.int64),
    origins: wp.array2d(dtype=wp.vec4d),
):
    """(x, y) of each lidar in cells of the map, and sine and cosine of the robot's yaw there."""
    lidar, i = wp.tid()
    if not active[i]:
        return
    number = wp.int32(places[i, 0])
    turn = sin_cos(poses[i, 2] - model.frames[number, 2])
    base = to_cells(model, number, poses[i, 0], poses[i, 1])
    mount = model.lidars[lidar]
    x = base[0] + (turn[1] * mount[0] - turn[0] * mount[1]) / model.resolution
    y = base[1] + (turn[0] * mount[0] + turn[1] * mount[1]) / model.resolution
    origins[lidar, i] = wp.vec4d(x, y, turn[0], turn[1])


@wp.kernel
def place_movers(
    model: Model,
    active: wp.array(dtype=wp.bool),
    poses: wp.array2d(dtype=wp.float64),
    places: wp.array2d(dtype=wp.int64),
    steps: wp.array(dtype=wp.int64),
    members: wp.array3d(dtype=wp.vec3d),
    seen: wp.array2d(dtype=wp.vec4d),
):
    """(x, y) of each mover in base_link, and sine and cosine of its yaw there."""
    slot, i = wp.tid()
    if not active[i] or places[i, 1] < wp.int64(0):
        return
    recording = wp.int32(places[i, 1])
    present = model.recordings[recording]
    mover = present[0] + slot
    if mover >= present[1]:
        return
    at = mover_of(model, members, recording, mover, i, 0, wp.float64(steps[i]) * model.timestep)
    heading = sin_cos(poses[i, 2])
    dx = at[0] - poses[i, 0]
    dy = at[1] - poses[i, 1]
    turn = sin_cos(at[2] - poses[i, 2])
    seen[slot, i] = wp.vec4d(heading[1] * dx + heading[0] * dy, heading[1] * dy - heading[0] * dx, turn[0], turn[1])


@wp.func
def ray_to_disc(beam: wp.vec2d, x: wp.float64, y: wp.float64, radius: wp.float64):
    side = beam[0] * y - beam[1] * x
    root = radius * radius - side * side
    if root < ZERO:
        return FAR
    middle = beam[0] * x + beam[1] * y
    half = wp.sqrt(root)
    if middle - half >= ZERO:
        return middle - half
    if middle + half >= ZERO:
        return middle + half
    return FAR


@wp.func
def ray_to_polygon(
    model: Model, beam: wp.vec2d, first: wp.int32, end: wp.int32, turn: wp.vec2d, x: wp.float64, y: wp.float64
):
    nearest = far()
    a = placed_corner(model, end - 1, turn, x, y)
    for k in range(first, end):
        b = placed_corner(model, k, turn, x, y)
        ex = b[0] - a[0]
        ey = b[1] - a[1]
        across = beam[0] * ey - beam[1] * ex
        if across != ZERO:
            distance = (a[0] * ey - a[1] * ex) / across
            share = (a[0] * beam[1] - a[1] * beam[0]) / across
            if distance >= ZERO and share >= ZERO and share <= ONE:
                nearest = lesser(nearest, distance)
        a = b
    return nearest


@wp.kernel
def meet_movers(
    model: Model,
    active: wp.array(dtype=wp.bool),
    places: wp.array2d(dtype=wp.int64),
    seen: wp.array2d(dtype=wp.vec4d),
    ranges: wp.array2d(dtype=Any),
):
    """Write the distance to the nearest mover on each beam, of robots that have a recording."""
    i, index = wp.tid()
    recording = wp.int32(places[i, 1])
    if not active[i] or recording < 0:
        return
    mount = model.lidars[model.lidar_of[index]]
    beam = model.beams[index]
    nearest = far()
    present = model.recordings[recording]
    for mover in range(present[0], present[1]):
        at = seen[mover - present[0], i]
        radius = model.radii[mover]
        x = at[0] - mount[0]
        y = at[1] - mount[1]
        limit = mount[3] + radius
        away = x * x + y * y
        if away <= limit * limit:
            inside = away <= radius * radius
            beside = beam[0] * x + beam[1] * y < ZERO or wp.abs(beam[0] * y - beam[1] * x) > radius
            if inside or not beside:
                own = model.corner_ranges[mover]
                if own[0] == own[1]:
                    nearest = lesser(nearest, ray_to_disc(beam, x, y, radius))
                else:
                    turn = wp.vec2d(at[2], at[3])
                    nearest = lesser(nearest, ray_to_polygon(model, beam, own[0], own[1], turn, x, y))
    ranges[i, index] = ranges.dtype(nearest)


@wp.func
def measured(met: wp.float64, low: wp.float64, high: wp.float64, noise: wp.vec2d, key: wp.uint64, draw: wp.uint64):
    """What a lidar reads of a distance; `noise` is its standard deviation and the share of dropouts."""
    if not (met <= high):
        return FAR
    read = met
    if noise[0] > ZERO or noise[1] > ZERO:
        if uniform(key, draw) < noise[1]:
            return FAR
        if noise[0] > ZERO:
            read = read + noise[0] * normal(key, draw)
    return lesser(greater(read, low), high)


@wp.kernel(launch_bounds=(BLOCK, 10))
def cast_beams(
    model: Model,
    active: wp.array(dtype=wp.bool),
    places: wp.array2d(dtype=wp.int64),
    steps: wp.array(dtype=wp.int64),
    errors: wp.array2d(dtype=wp.float64),
    keys: wp.array(dtype=wp.uint64),
    origins: wp.array2d(dtype=wp.vec4d),
    ranges: wp.array2d(dtype=Any),
):
    """Cast a beam of a robot against its map, and measure what is nearest there or by `meet_movers`."""
    i, index = wp.tid()
    if not active[i]:
        return
    lidar = model.lidar_of[index]
    origin = origins[lidar, i]
    number = wp.int32(places[i, 0])
    along = turned(wp.vec2d(origin[2], origin[3]), model.beams[index])
    distance = cast_ray(
        model.cells,
        model.shapes[number, 0],
        model.shapes[number, 1],
        model.shapes[number, 2],
        origin[0],
        origin[1],
        along[0],
        along[1],
        model.lidars[lidar][3] / model.resolution,
    )
    met = stored(ranges, distance * model.resolution)
    if places[i, 1] >= wp.int64(0):
        met = lesser(met, wp.float64(ranges[i, index]))
    mount = model.lidars[lidar]
    draw = wp.uint64(steps[i]) * wp.uint64(model.beams.shape[0]) + wp.uint64(index)
    read = measured(met, mount[2], mount[3], wp.vec2d(errors[i, 0], errors[i, 1]), keys[i], draw)
    ranges[i, index] = ranges.dtype(read)


for _kind in (wp.float32, wp.float64):
    wp.overload(meet_movers, {"ranges": wp.array2d(dtype=_kind)})
    wp.overload(cast_beams, {"ranges": wp.array2d(dtype=_kind)})
