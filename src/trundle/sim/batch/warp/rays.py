"""Rays that jump through a grid on a device; the distances of `_core/rays/jumping_ray.hpp`, to the last bit."""

# pyright: reportAttributeAccessIssue=false, reportInvalidTypeForm=false, reportOperatorIssue=false
# pyright: reportCallIssue=false, reportIndexIssue=false, reportArgumentType=false

import warp as wp

from trundle.sim.batch.warp.arithmetic import FAR, ONE, ZERO, clamped, greater, lesser

_HUGE = wp.constant(wp.float64(1e300))
_MARGIN, _REST = wp.constant(wp.float64(1e-5)), wp.constant(wp.float64(1.0 - 1e-5))


@wp.func
def leaves(cell: wp.int32, start: wp.float64, inverse: wp.float64, ahead: wp.int32):
    return (wp.float64(cell + ahead) - start) * inverse


@wp.func
def cell_near_line(
    ties: wp.bool,
    place: wp.float64,
    distance: wp.float64,
    origin: wp.int32,
    last: wp.int32,
    start: wp.float64,
    inverse: wp.float64,
    step: wp.int32,
    ahead: wp.int32,
):
    """The cell of one coordinate at a distance, between two; `RayAxis::cell_near_line`."""
    guess = wp.floor(place)
    low = wp.min(origin, last)
    high = wp.max(origin, last)
    cell = wp.int32(0)
    if guess <= wp.float64(low):
        cell = low
    elif guess >= wp.float64(high):
        cell = high
    else:
        cell = wp.int32(guess)
    while cell != last:
        line = leaves(cell, start, inverse, ahead)
        if not (line < distance or (ties and line == distance)):
            break
        cell += step
    while cell != origin:
        line = leaves(cell, start, inverse, 1 - ahead)
        if line < distance or (ties and line == distance):
            break
        cell -= step
    return cell


@wp.func
def cast_ray(
    cells: wp.array(dtype=wp.uint8),
    offset: wp.int32,
    rows: wp.int32,
    cols: wp.int32,
    x: wp.float64,
    y: wp.float64,
    dx: wp.float64,
    dy: wp.float64,
    reach: wp.float64,
):
    """Distance in cells to the first blocked cell; `cast_jumping_ray`."""
    inverse_x, inverse_y = _HUGE, _HUGE
    if dx != ZERO:
        inverse_x = ONE / dx
    if dy != ZERO:
        inverse_y = ONE / dy
    step_x, ahead_x = wp.int32(1), wp.int32(1)
    if dx < ZERO:
        step_x, ahead_x = wp.int32(-1), wp.int32(0)
    step_y, ahead_y = wp.int32(1), wp.int32(1)
    if dy < ZERO:
        step_y, ahead_y = wp.int32(-1), wp.int32(0)
    distance = wp.float64(0.0)
    col, row = wp.int32(0), wp.int32(0)
    width, height = wp.float64(cols), wp.float64(rows)
    if x >= ZERO and x < width and y >= ZERO and y < height:
        col, row = wp.int32(x), wp.int32(y)
    else:
        leave = reach
        if dx == ZERO:
            if x < ZERO or x > width:
                return FAR
        else:
            first = -x / dx
            second = (width - x) / dx
            distance = greater(distance, lesser(first, second))
            leave = lesser(leave, greater(first, second))
        if dy == ZERO:
            if y < ZERO or y > height:
                return FAR
        else:
            first = -y / dy
            second = (height - y) / dy
            distance = greater(distance, lesser(first, second))
            leave = lesser(leave, greater(first, second))
        if distance > leave:
            return FAR
        col = wp.int32(clamped(wp.floor(x + distance * dx), ZERO, width - ONE))
        row = wp.int32(clamped(wp.floor(y + distance * dy), ZERO, height - ONE))
    free = wp.int32(cells[offset + row * cols + col])
    while free != 0:
        last_col = col + step_x * (free - 1)
        last_row = row + step_y * (free - 1)
        by_col = leaves(last_col, x, inverse_x, ahead_x)
        by_row = leaves(last_row, y, inverse_y, ahead_y)
        by_cols = by_col < by_row
        distance = wp.where(by_cols, by_col, by_row)
        if distance > reach:
            return FAR
        # The coordinate whose line is not crossed: most places are farther from a line than all that is rounded here.
        # Rays side by side that cross a column and a row take the same branch.
        place = wp.where(by_cols, y, x) + distance * wp.where(by_cols, dy, dx)
        origin, last = wp.where(by_cols, row, col), wp.where(by_cols, last_row, last_col)
        cell = wp.int32(place)
        rest = place - wp.float64(cell)
        if not (cell >= wp.min(origin, last) and cell <= wp.max(origin, last) and rest > _MARGIN and rest < _REST):
            if by_cols:
                cell = cell_near_line(True, place, distance, origin, last, y, inverse_y, step_y, ahead_y)
            else:
                cell = cell_near_line(False, place, distance, origin, last, x, inverse_x, step_x, ahead_x)
        row = wp.where(by_cols, cell, last_row + step_y)
        col = wp.where(by_cols, last_col + step_x, cell)
        if row < 0 or row >= rows or col < 0 or col >= cols:
            return FAR
        free = wp.int32(cells[offset + row * cols + col])
    return distance
