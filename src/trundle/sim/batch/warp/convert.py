"""Kernels that convert numbers to another type."""

# pyright: reportAttributeAccessIssue=false, reportInvalidTypeForm=false, reportOperatorIssue=false
# pyright: reportCallIssue=false, reportIndexIssue=false, reportArgumentType=false

from typing import Any

import warp as wp

from trundle.sim.batch.warp.arithmetic import EXACT

wp.set_module_options(EXACT)


@wp.kernel
def convert1(given: wp.array(dtype=Any), out: wp.array(dtype=Any)):
    """Convert numbers to another type."""
    i = wp.tid()
    out[i] = out.dtype(given[i])


@wp.kernel
def convert2(given: wp.array2d(dtype=Any), out: wp.array2d(dtype=Any)):
    """Convert numbers to another type."""
    i, k = wp.tid()
    out[i, k] = out.dtype(given[i, k])


# Each pair of types is a kernel of its own: the numbers of learning libraries, and the bools of masks.
for _given, _out in (
    *((each, wp.float64) for each in (wp.float16, wp.float32, wp.int32, wp.int64)),
    *((each, wp.int64) for each in (wp.uint8, wp.int32)),
    *((each, wp.uint64) for each in (wp.int32, wp.int64)),
    *((each, wp.bool) for each in (wp.uint8, wp.int32, wp.int64)),
):
    wp.overload(convert1, [wp.array(dtype=_given), wp.array(dtype=_out)])
    wp.overload(convert2, [wp.array2d(dtype=_given), wp.array2d(dtype=_out)])
