"""Kernels that find what footprints touch first.

Threads side by side look at the same robot: they take the same branches, and read the same cells. The poses of a step
are known before, so 16 at a time are looked at together. Contacts are numbers, of which the least is the first: by the
number of the pose, then cells before movers, then by the number of the cell or the mover.
"""

# pyright: reportAttributeAccessIssue=false, reportInvalidTypeForm=false, reportOperatorIssue=false
# pyright: reportCallIssue=false, reportIndexIssue=false, reportArgumentType=false

import warp as wp

from trundle.sim.batch.warp.arithmetic import EXACT, ONE, TOUCH, ZERO, clamped, far, greater, lesser, sin_cos
from trundle.sim.batch.warp.model import NOTHING_BAD, NOTHING_TOUCHED, Model, mover_of, placed_corner, to_cells, turned

_BLOCK = 128
wp.set_module_options(EXACT | {"block_dim": _BLOCK})

_POSE, _MOVER = wp.constant(wp.int64(2**33)), wp.constant(wp.int64(2**32))


@wp.func
def has_room(model: Model, number: wp.int32, x: wp.float64, y: wp.float64, room: wp.float64):
    offset, rows, cols = model.shapes[number, 0], model.shapes[number, 1], model.shapes[number, 2]
    if not (x >= ZERO and y >= ZERO and x < wp.float64(cols) and y < wp.float64(rows)):
        return False
    free = wp.int32(model.cells[offset + wp.int32(y) * cols + wp.int32(x)])
    return wp.float64(free - 1) * model.resolution >= room


@wp.func
def is_surely_free(model: Model, number: wp.int32, pose: wp.vec3d):
    base = to_cells(model, number, pose[0], pose[1])
    if has_room(model, number, base[0], base[1], model.radius):
        return True
    turn = sin_cos(pose[2] - model.frames[number, 2])
    for i in range(4):
        disc = model.cover[i]
        x = base[0] + (turn[1] * disc[0] - turn[0] * disc[1]) / model.resolution
        y = base[1] + (turn[0] * disc[0] + turn[1] * disc[1]) / model.resolution
        if not has_room(model, number, x, y, model.cover_radius):
            return False
    return True


@wp.func
def first_overlap(
    model: Model,
    number: wp.int32,
    pose: wp.vec3d,
    edges: wp.array2d(dtype=wp.vec3d),
    at: wp.int32,
    lane: wp.int32,
    lanes: wp.int32,
):
    """Number of the first blocked cell that the footprint overlaps in every `lanes`-th row, or −1; see C++.

    `edges` is memory for the corners of the footprint and the slopes of the edges that lead to them; all lanes of a
    pose write the same there.
    """
    offset, row_count, col_count = model.shapes[number, 0], model.shapes[number, 1], model.shapes[number, 2]
    rows, cols = wp.float64(row_count), wp.float64(col_count)
    touch = TOUCH / model.resolution
    base = to_cells(model, number, pose[0], pose[1])
    turn = sin_cos(pose[2] - model.frames[number, 2])
    corners = model.outline.shape[0]
    low, high = far(), -far()
    last_corner = turned(turn, model.outline[corners - 1])
    before_x = base[0] + last_corner[0] / model.resolution
    before_y = base[1] + last_corner[1] / model.resolution
    for i in range(corners):
        corner = turned(turn, model.outline[i])
        x = base[0] + corner[0] / model.resolution
        y = base[1] + corner[1] / model.resolution
        slope = wp.float64(0.0)
        if before_y > y:
            slope = (before_x - x) / (before_y - y)
        elif y > before_y:
            slope = (x - before_x) / (y - before_y)
        edges[i, at] = wp.vec3d(x, y, slope)
        low = lesser(low, y)
        high = greater(high, y)
        before_x = wp.float64(x)
        before_y = wp.float64(y)
    first_row = wp.int32(clamped(wp.floor(low + touch), ZERO, rows))
    last_row = wp.int32(clamped(wp.ceil(high - touch), ZERO, rows)) - 1
    row = first_row + lane
    while row <= last_row:
        left, right = far(), -far()
        below = wp.float64(row)
        above = below + ONE
        from_x = wp.float64(edges[corners - 1, at][0])
        from_y = wp.float64(edges[corners - 1, at][1])
        for i in range(corners):
            other = wp.vec3d(edges[i, at])
            ax = wp.float64(from_x)
            ay = wp.float64(from_y)
            bx = wp.float64(other[0])
            by = wp.float64(other[1])
            if from_y > other[1]:
                ax = other[0]
                ay = other[1]
                bx = from_x
                by = from_y
            if below >= wp.floor(greater(ay, -ONE)) and below <= wp.floor(lesser(by, rows)):
                start = wp.float64(ax)
                end = wp.float64(bx)
                if ay < below:
                    start = ax + (below - ay) * other[2]
                if by > above:
                    end = ax + (above - ay) * other[2]
                left = lesser(left, lesser(start, end))
                right = greater(right, greater(start, end))
            from_x = wp.float64(other[0])
            from_y = wp.float64(other[1])
        if left <= right:
            col = wp.int32(clamped(wp.floor(left + touch), ZERO, cols))
            end_col = wp.int32(clamped(wp.ceil(right - touch), ZERO, cols))
            while col < end_col:
                free = wp.int32(model.cells[offset + row * col_count + col])
                if free == 0:
                    return row * col_count + col
                col += free
        row += lanes
    return -1


@wp.func
def overlaps_disc(model: Model, turn: wp.vec2d, x: wp.float64, y: wp.float64, radius: wp.float64):
    """Whether a disc overlaps the footprint."""
    count = model.outline.shape[0]
    a = turned(turn, model.outline[count - 1])
    inside = wp.bool(True)
    nearest = far()
    for i in range(count):
        b = turned(turn, model.outline[i])
        ex = b[0] - a[0]
        ey = b[1] - a[1]
        if not (ex * (y - a[1]) - ey * (x - a[0]) > ZERO):
            inside = False
        share = clamped(((x - a[0]) * ex + (y - a[1]) * ey) / (ex * ex + ey * ey), ZERO, ONE)
        dx = a[0] + share * ex - x
        dy = a[1] + share * ey - y
        nearest = lesser(nearest, dx * dx + dy * dy)
        a = b
    if inside:
        return True
    return radius - wp.sqrt(nearest) > TOUCH


@wp.func
def overlaps_polygon(
    model: Model, heading: wp.vec2d, first: wp.int32, end: wp.int32, turn: wp.vec2d, dx: wp.float64, dy: wp.float64
):
    """Whether no edge of the footprint or of a mover's polygon separates the two."""
    count = model.outline.shape[0]
    a = turned(heading, model.outline[count - 1])
    for i in range(count):
        b = turned(heading, model.outline[i])
        ex = b[0] - a[0]
        ey = b[1] - a[1]
        nearest = far()
        for k in range(first, end):
            c = placed_corner(model, k, turn, dx, dy)
            nearest = lesser(nearest, ey * (c[0] - a[0]) - ex * (c[1] - a[1]))
        if -nearest <= TOUCH * wp.sqrt(ex * ex + ey * ey):
            return False
        a = b
    a = placed_corner(model, end - 1, turn, dx, dy)
    for k in range(first, end):
        b = placed_corner(model, k, turn, dx, dy)
        ex = b[0] - a[0]
        ey = b[1] - a[1]
        nearest = far()
        for i in range(count):
            c = turned(heading, model.outline[i])
            nearest = lesser(nearest, ey * (c[0] - a[0]) - ex * (c[1] - a[1]))
        if -nearest <= TOUCH * wp.sqrt(ex * ex + ey * ey):
            return False
        a = b
    return True


@wp.kernel(launch_bounds=(_BLOCK, 8))
def touch(
    model: Model,
    active: wp.array(dtype=wp.bool),
    number_of_first: wp.int32,
    poses: wp.int32,
    lanes: wp.int32,
    fault: wp.array(dtype=wp.int64),
    passed: wp.array2d(dtype=wp.vec3d),
    places: wp.array2d(dtype=wp.int64),
    steps: wp.array(dtype=wp.int64),
    members: wp.array3d(dtype=wp.vec3d),
    edges: wp.array2d(dtype=wp.vec3d),
    first: wp.array(dtype=wp.int64),
):
    """Look at some poses of a robot that follow each other, with a few threads each, for what it touches first."""
    i, thread = wp.tid()
    substep = thread // lanes
    lane = thread - substep * lanes
    contact = wp.int64(number_of_first + substep) * _POSE
    if not active[i] or fault[0] != NOTHING_BAD or first[i] < contact:
        return
    pose = passed[i, substep]
    number = wp.int32(places[i, 0])
    recording = wp.int32(places[i, 1])
    if not is_surely_free(model, number, pose):
        cell = first_overlap(model, number, pose, edges, i * poses + substep, lane, lanes)
        if cell >= 0:
            wp.atomic_min(first, i, contact + wp.int64(cell))
            return
    if recording < 0:
        return
    # After the last of them the robot's clock stands at `steps`.
    time = wp.float64(steps[i] - wp.int64(poses - 1 - substep)) * model.timestep
    present = model.recordings[recording]
    heading = sin_cos(pose[2])
    mover = present[0] + lane
    while mover < present[1]:
        at = mover_of(model, members, recording, mover, i, substep, time)
        dx = at[0] - pose[0]
        dy = at[1] - pose[1]
        reach = model.radius + model.radii[mover]
        if dx * dx + dy * dy < reach * reach:
            own = model.corner_ranges[mover]
            hit = wp.bool(False)
            if own[0] == own[1]:
                hit = overlaps_disc(model, heading, dx, dy, model.radii[mover])
            else:
                hit = overlaps_polygon(model, heading, own[0], own[1], sin_cos(at[2]), dx, dy)
            if hit:
                wp.atomic_min(first, i, contact + _MOVER + wp.int64(mover))
                return
        mover += lanes


@wp.kernel
def settle(
    model: Model,
    active: wp.array(dtype=wp.bool),
    places: wp.array2d(dtype=wp.int64),
    first: wp.array(dtype=wp.int64),
    contacts: wp.array2d(dtype=wp.int64),
    fault: wp.array(dtype=wp.int64),
    told: wp.array(dtype=wp.int64),
):
    """Write (kind, row or mover, col, number of the pose) of the first contacts, and tell the host of a fault."""
    i = wp.tid()
    if fault[0] != NOTHING_BAD:
        if i == 0:
            told[0] = fault[0]
        return
    if not active[i]:
        return
    for k in range(4):
        contacts[i, k] = wp.int64(0)
    contact = first[i]
    if contact == NOTHING_TOUCHED:
        return
    pose = contact // _POSE
    thing = contact - pose * _POSE
    if thing >= _MOVER:
        contacts[i, 0] = wp.int64(2)
        contacts[i, 1] = thing - _MOVER
    else:
        cols = wp.int64(model.shapes[wp.int32(places[i, 0]), 2])
        contacts[i, 0] = wp.int64(1)
        contacts[i, 1] = thing // cols
        contacts[i, 2] = thing - thing // cols * cols
    contacts[i, 3] = pose
