"""Rays that jump through a grid on a device; the distances of `_core/rays/jumping_ray.hpp`, to the last bit."""

# pyright: reportAttributeAccessIssue=false, reportInvalidTypeForm=false, reportOperatorIssue=false
# pyright: reportCallIssue=false, reportIndexIssue=false, reportArgumentType=false

import warp as wp

from trundle.sim.batch.warp.arithmetic import FAR, ONE, ZERO, clamped, greater, lesser

_HUGE = wp.constant(wp.float64(1e300))
_LARGE = wp.constant(wp.float32(1e30))
# Bounds of what float32 rounds: of the start and of a product; ten times what they are.
_START_ERROR, _ERROR = wp.constant(wp.float32(1e-7)), wp.constant(wp.float32(1e-6))
_ONE = wp.constant(wp.float32(1.0))


@wp.func
def leaves(cell: wp.int32, start: wp.float64, inverse: wp.float64, ahead: wp.int32):
    return (wp.float64(cell + ahead) - start) * inverse


@wp.func
def cell_at(
    ties: wp.bool,
    distance: wp.float64,
    origin: wp.int32,
    last: wp.int32,
    start: wp.float64,
    along: wp.float64,
    inverse: wp.float64,
    step: wp.int32,
    ahead: wp.int32,
):
    """The cell of one coordinate at a distance, between two; `RayAxis::cell_at`."""
    guess = wp.floor(start + distance * along)
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
    while distance <= reach:
        free = wp.int32(cells[offset + row * cols + col])
        if free == 0:
            return distance
        last_col = col + step_x * (free - 1)
        last_row = row + step_y * (free - 1)
        by_col = leaves(last_col, x, inverse_x, ahead_x)
        by_row = leaves(last_row, y, inverse_y, ahead_y)
        if by_col < by_row:
            row = cell_at(True, by_col, row, last_row, y, dy, inverse_y, step_y, ahead_y)
            col = last_col + step_x
            distance = by_col
        else:
            col = cell_at(False, by_row, col, last_col, x, dx, inverse_x, step_x, ahead_x)
            row = last_row + step_y
            distance = by_row
        if row < 0 or row >= rows or col < 0 or col >= cols:
            return FAR
    return FAR


@wp.func
def short_inverse(direction: wp.float32):
    """1 / direction, large where there is none."""
    if wp.abs(direction) * _LARGE > _ONE:
        return _ONE / direction
    return _LARGE


@wp.func
def cast_guided_ray(
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
    """As `cast_ray`, where float32 finds the way: most of a device's units have no other.

    A distance is that of the line that was crossed last, whatever led there. Where float32 might choose another cell,
    that jump is made in float64.
    """
    if not (x >= ZERO and x < wp.float64(cols) and y >= ZERO and y < wp.float64(rows)):
        return cast_ray(cells, offset, rows, cols, x, y, dx, dy, reach)
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
    first_col, first_row = wp.int32(x), wp.int32(y)
    short_x = wp.float32(x - wp.float64(first_col))
    short_y = wp.float32(y - wp.float64(first_row))
    along_x, along_y, limit = wp.float32(dx), wp.float32(dy), wp.float32(reach)
    per_x, per_y = short_inverse(along_x), short_inverse(along_y)
    error_x, error_y = _START_ERROR * wp.abs(per_x), _START_ERROR * wp.abs(per_y)
    col = wp.int32(x)
    row = wp.int32(y)
    by_col = wp.bool(False)
    jumps = wp.int32(0)
    while row >= 0 and row < rows and col >= 0 and col < cols:
        free = wp.int32(cells[offset + row * cols + col])
        if free == 0:
            if jumps == 0:
                return ZERO
            if by_col:
                return leaves(col - step_x, x, inverse_x, ahead_x)
            return leaves(row - step_y, y, inverse_y, ahead_y)
        jumps += 1
        last_col = col + step_x * (free - 1)
        last_row = row + step_y * (free - 1)
        at_col = (wp.float32(last_col - first_col + ahead_x) - short_x) * per_x
        at_row = (wp.float32(last_row - first_row + ahead_y) - short_y) * per_y
        error_col = error_x + _ERROR * at_col
        error_row = error_y + _ERROR * at_row
        by_col = at_col < at_row
        near, error, place = at_row, error_row, short_x + at_row * along_x
        if by_col:
            near, error, place = at_col, error_col, short_y + at_col * along_y
        whole = wp.floor(place)
        rest = place - whole
        margin = error + _ERROR * (near + _ONE) + _ERROR * near
        is_sure = (
            wp.abs(at_col - at_row) > error_col + error_row
            and wp.abs(near - limit) > error
            and rest > margin
            and rest < _ONE - margin
        )
        if is_sure:
            if near > limit:
                return FAR
            if by_col:
                row = first_row + wp.int32(whole)
                col = last_col + step_x
            else:
                col = first_col + wp.int32(whole)
                row = last_row + step_y
        else:
            by_line_x = leaves(last_col, x, inverse_x, ahead_x)
            by_line_y = leaves(last_row, y, inverse_y, ahead_y)
            by_col = by_line_x < by_line_y
            if lesser(by_line_x, by_line_y) > reach:
                return FAR
            if by_col:
                row = cell_at(True, by_line_x, row, last_row, y, dy, inverse_y, step_y, ahead_y)
                col = last_col + step_x
            else:
                col = cell_at(False, by_line_y, col, last_col, x, dx, inverse_x, step_x, ahead_x)
                row = last_row + step_y
    return FAR
