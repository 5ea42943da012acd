"""Paths of members of crowds on a device: a block of threads searches the floor for one of them after the other.

Costs to go are whole numbers, and their least is the same whatever the order of the steps: a path has the cells of
`Floor` in C++. All threads of a block go on from one front to the next together; on Warp's CPU device a block is one
thread.
"""

# pyright: reportAttributeAccessIssue=false, reportInvalidTypeForm=false, reportOperatorIssue=false
# pyright: reportCallIssue=false, reportIndexIssue=false, reportArgumentType=false

import math

import warp as wp

from trundle.sim.batch.warp.arithmetic import EXACT, lesser
from trundle.sim.batch.warp.crowd_model import (
    RETREATS,
    ROBOT_MARGIN,
    WALL,
    Crowds,
    CrowdState,
    around_col,
    around_row,
    cell_of,
    has_path,
    length_of,
    middle_of,
)

BLOCK = 256
wp.set_module_options(EXACT | {"block_dim": BLOCK})

_BLOCKED, _UNREACHED = wp.constant(wp.int64(-1)), wp.constant(wp.int64(2**62))
_STRAIGHT, _DIAGONAL = wp.constant(wp.int64(985)), wp.constant(wp.int64(1393))
_FRONT = wp.constant(wp.int64(25_000))
"""How much farther each front may reach: a straight step in the open is 19,700. Cells that cost more wait, so that few
are reached twice. In an office, a warehouse and a maze a cell is spread from 1.0, 2.0 and 1.0 times, in 870, 910 and
1,490 fronts; with 20,000 once, in a quarter more fronts; with 60,000 7, 29 and 57 times, in 430, 760 and 800."""

_UNIT = wp.constant(wp.float64(1.0 / 1970.0))
_INFINITE = wp.constant(wp.float32(math.inf))
BLOCKING = wp.constant(wp.float64(0.5))
"""Those who are nearer than this block someone [m]; `kBlocking`."""

_LEAST_RETREAT = wp.constant(wp.float64(1.5))


@wp.struct
class Search:
    """Memory of the blocks that search, a row for each."""

    costs: wp.array2d(dtype=wp.int64)  # to go, from each cell
    stamps: wp.array2d(dtype=wp.int32)  # the last front that each cell was in
    fronts: wp.array3d(dtype=wp.int32)  # cells of this front, and of the next one
    sizes: wp.array2d(dtype=wp.int32)  # of these two, and of the one after
    discs: wp.array2d(dtype=wp.vec3d)


@wp.func_native("""
#if defined(__CUDA_ARCH__)
__syncthreads();
#endif
""")
def wait_for_block(): ...


@wp.func
def offer(search: Search, block: wp.int32, front: wp.int32, cell: wp.int32):
    """Put a cell into the next front, if it is not there yet."""
    if wp.atomic_max(search.stamps, block, cell, front + 1) <= front:
        place = wp.atomic_add(search.sizes, block, (front + 1) % 3, 1)
        search.fronts[block, (front + 1) % 2, place] = cell


@wp.func
def spread_from(
    crowds: Crowds, search: Search, block: wp.int32, offset: wp.int32, cols: wp.int32, front: wp.int32, cell: wp.int32
):
    """Offer the cells around one what they cost by it."""
    own = wp.int64(search.costs[block, cell])
    through = wp.int64(crowds.costs[offset + cell])
    for step in range(1, 9):
        rows, across = around_row(step), around_col(step)
        other = cell + rows * cols + across
        cost = own + (through + wp.int64(crowds.costs[offset + other])) * _STRAIGHT
        allowed = wp.bool(True)
        if rows != 0 and across != 0:
            cost = own + (through + wp.int64(crowds.costs[offset + other])) * _DIAGONAL
            # A diagonal step needs both cells beside it free.
            allowed = (
                search.costs[block, cell + rows * cols] != _BLOCKED and search.costs[block, cell + across] != _BLOCKED
            )
        if allowed and cost < search.costs[block, other]:
            before = wp.atomic_min(search.costs, block, other, cost)
            if cost < before:
                offer(search, block, front, other)


@wp.func
def fill_costs(
    crowds: Crowds,
    search: Search,
    crowd: wp.int32,
    goal: wp.int32,
    discs: wp.int32,
    block: wp.int32,
    lane: wp.int32,
    lanes: wp.int32,
):
    """Fill in the cost to go to a cell from everywhere, around the first of the block's discs; `Floor::fill_field`."""
    offset, rows, cols = crowds.floors[crowd, 0], crowds.floors[crowd, 1], crowds.floors[crowd, 2]
    cell = wp.int32(lane)
    while cell < rows * cols:
        if crowds.costs[offset + cell] == WALL:
            search.costs[block, cell] = _BLOCKED
        else:
            search.costs[block, cell] = _UNREACHED
        search.stamps[block, cell] = 0
        cell += lanes
    wait_for_block()
    resolution = crowds.frames[crowd][2]
    for number in range(discs):
        disc = search.discs[block, number]
        reach = wp.int32(wp.ceil(disc[2] / resolution)) + 1
        at = cell_of(crowds, crowd, disc[0], disc[1])
        middle_row = at // cols
        middle_col = at - middle_row * cols
        width = 2 * reach + 1
        place = wp.int32(lane)
        while place < width * width:
            row = middle_row - reach + place // width
            col = middle_col - reach + place % width
            if row >= 0 and row < rows and col >= 0 and col < cols:
                middle = middle_of(crowds, crowd, row * cols + col)
                if length_of(middle[0] - disc[0], middle[1] - disc[1]) < disc[2]:
                    search.costs[block, row * cols + col] = _BLOCKED
            place += lanes
    wait_for_block()
    if lane == 0:
        search.sizes[block, 0] = 0
        search.sizes[block, 1] = 0
        search.sizes[block, 2] = 0
        if search.costs[block, goal] != _BLOCKED:
            search.costs[block, goal] = wp.int64(0)
            search.fronts[block, 0, 0] = goal
            search.sizes[block, 0] = 1
    wait_for_block()
    front = wp.int32(0)
    size = wp.int32(search.sizes[block, 0])
    while size > 0:
        limit = wp.int64(front + 1) * _FRONT
        place = wp.int32(lane)
        while place < size:
            cell = wp.int32(search.fronts[block, front % 2, place])
            if search.costs[block, cell] > limit:
                offer(search, block, front, cell)
            else:
                spread_from(crowds, search, block, offset, cols, front, cell)
            place += lanes
        if lane == 0:
            search.sizes[block, (front + 2) % 3] = 0
        wait_for_block()
        front += 1
        size = wp.int32(search.sizes[block, front % 3])


@wp.func
def shown_cost(cost: wp.int64):
    """A cost to go as C++ has it: rounded to float32, infinite where there is no path."""
    if cost < wp.int64(0) or cost == _UNREACHED:
        return _INFINITE
    return wp.float32(wp.float64(cost) * _UNIT)


@wp.func
def best_step(search: Search, block: wp.int32, cols: wp.int32, cell: wp.int32):
    """Which cell around one is the next on the path; `Floor::best_step`."""
    best = wp.int32(0)
    least = shown_cost(search.costs[block, cell])
    for step in range(1, 9):
        cost = shown_cost(search.costs[block, cell + around_row(step) * cols + around_col(step)])
        if cost < least:
            least = cost
            best = step
    return best


@wp.func
def find_blocking(
    crowds: Crowds, state: CrowdState, search: Search, scene: wp.int32, member: wp.int32, robot: wp.int32,
    block: wp.int32, lane: wp.int32,
):  # fmt: skip
    """Note the discs of those who are next to someone, and of the robot if it is seen; how many there are."""
    first, members = crowds.scenes[scene, 2], crowds.scenes[scene, 3]
    here = state.at[member, robot]
    radius = crowds.radii[first + member]
    resolution = crowds.frames[crowds.crowd_of[first + member]][2]
    count = wp.int32(0)
    for k in range(members + 1):
        other_x, other_y, least = wp.float64(0.0), wp.float64(0.0), wp.float64(0.0)
        if k < members:
            other_x, other_y = wp.float64(state.at[k, robot][0]), wp.float64(state.at[k, robot][1])
            least = crowds.radii[first + k] + radius
        else:
            other_x, other_y = wp.float64(state.robots[robot][0]), wp.float64(state.robots[robot][1])
            least = radius + state.radius[robot] + ROBOT_MARGIN
        apart = length_of(other_x - here[0], other_y - here[1])
        is_near = apart < least + BLOCKING and apart > wp.float64(0.0)
        if is_near and (k < members or crowds.sees[first + member]):
            if lane == 0:
                search.discs[block, count] = wp.vec3d(other_x, other_y, lesser(least, apart - resolution))
            count += 1
    return count


@wp.func
def choose_retreat(
    crowds: Crowds, state: CrowdState, search: Search, crowd: wp.int32, member: wp.int32, robot: wp.int32,
    block: wp.int32,
):  # fmt: skip
    """The first cell that one who is stuck gets to, or −1."""
    here = state.at[member, robot]
    for i in range(RETREATS):
        cell = wp.int32(state.retreats[member, robot, i])
        middle = middle_of(crowds, crowd, cell)
        away = length_of(middle[0] - here[0], middle[1] - here[1])
        cost = wp.int64(search.costs[block, cell])
        if away >= _LEAST_RETREAT and cost >= wp.int64(0) and cost != _UNREACHED:
            return cell
    return wp.int32(-1)


@wp.kernel
def find_paths(
    crowds: Crowds,
    state: CrowdState,
    search: Search,
    recordings: wp.array2d(dtype=wp.int64),
    blocks: wp.int32,
    lanes: wp.int32,
):
    """Find the paths of all who are in the queue, and first where those go who are stuck."""
    block, lane = wp.tid()
    item = wp.int32(block)
    while item < state.queued[0]:
        member, robot = state.queue[item][0], state.queue[item][1]
        scene = wp.int32(recordings[robot, 1])
        crowd = crowds.crowd_of[crowds.scenes[scene, 2] + member]
        rows, cols = crowds.floors[crowd, 1], crowds.floors[crowd, 2]
        at = state.at[member, robot]
        here = cell_of(crowds, crowd, at[0], at[1])
        if state.retreats[member, robot, 0] >= 0:
            count = find_blocking(crowds, state, search, scene, member, robot, block, lane)
            wait_for_block()
            fill_costs(crowds, search, crowd, here, count, block, lane, lanes)
            chosen = choose_retreat(crowds, state, search, crowd, member, robot, block)
            wait_for_block()
            if chosen >= 0 and lane == 0:
                state.goals[member, robot] = chosen
                state.windows[member, robot] = wp.vec4i(0, 0, 0, 0)
                state.disc_counts[member, robot] = count
                for k in range(count):
                    state.discs[member, robot, k] = search.discs[block, k]
            wait_for_block()
        if not has_path(crowds, state, crowd, member, robot, here):
            count = wp.int32(state.disc_counts[member, robot])
            if lane == 0:
                for k in range(count):
                    search.discs[block, k] = state.discs[member, robot, k]
            wait_for_block()
            fill_costs(crowds, search, crowd, state.goals[member, robot], count, block, lane, lanes)
            high, wide = wp.min(rows - 2, crowds.window), wp.min(cols - 2, crowds.window)
            row = wp.clamp(here // cols - high // 2, 1, rows - 1 - high)
            col = wp.clamp(here % cols - wide // 2, 1, cols - 1 - wide)
            pair = wp.int32(lane)
            while 2 * pair < high * wide:
                place = 2 * pair
                steps = best_step(search, block, cols, (row + place // wide) * cols + col + place % wide)
                place += 1
                if place < high * wide:
                    steps += 16 * best_step(search, block, cols, (row + place // wide) * cols + col + place % wide)
                state.paths[robot, member, pair] = wp.uint8(steps)
                pair += lanes
            wait_for_block()
            if lane == 0:
                state.windows[member, robot] = wp.vec4i(row, col, high, wide)
            wait_for_block()
        item += blocks
