"""Arithmetic of the batch kernels in Warp: each operation and its order are those of the C++ headers in `_core/batch`.

No `from __future__ import annotations` here: Warp reads the annotations themselves.
"""

# pyright: reportAttributeAccessIssue=false, reportInvalidTypeForm=false, reportOperatorIssue=false
# pyright: reportCallIssue=false, reportRedeclaration=false

import math

import warp as wp

# No contraction of products and sums: bits would differ from the processor's. No derivatives: nobody asks for them. No
# loop over blocks, which takes registers: a thread for each number.
EXACT = {"fuse_fp": False, "fast_math": False, "enable_backward": False, "default_grid_stride": False}

ZERO, ONE, HALF, TWO, SIX = (wp.constant(wp.float64(value)) for value in (0.0, 1.0, 0.5, 2.0, 6.0))
FAR = wp.constant(wp.float64(math.inf))
TOUCH = wp.constant(wp.float64(1e-9))
SMALL_TURN = wp.constant(wp.float64(1e-6))
FINITE = wp.constant(wp.float64(1e9))
_TWO_OVER_PI = wp.constant(wp.float64(0.63661977236758134308))
_FIRST = wp.constant(wp.float64(float.fromhex("0x1.921fb544p+0")))
_SECOND = wp.constant(wp.float64(float.fromhex("0x1.0b4611a6p-34")))
_THIRD = wp.constant(wp.float64(float.fromhex("0x1.3198a2e037073p-69")))
_LARGE, _TURN = wp.constant(wp.float64(1e6)), wp.constant(wp.float64(6.283185307179586))
_S3, _S5, _S7, _S9, _S11, _S13, _S15, _S17 = (
    wp.constant(wp.float64((-1.0) ** (n // 2) / math.factorial(n))) for n in range(3, 18, 2)
)
_C4, _C6, _C8, _C10, _C12, _C14, _C16, _C18 = (
    wp.constant(wp.float64((-1.0) ** (n // 2) / math.factorial(n))) for n in range(4, 19, 2)
)
_MINUS_S7, _MINUS_C6, _SHORT = (wp.constant(wp.float64(value)) for value in (1.0 / 5040.0, 1.0 / 720.0, 0.03))
_SCALE = wp.constant(wp.float64(2.0**-53))
_SIXTEEN = wp.constant(wp.float32(1.0 / 65536.0))


@wp.func
def far():
    """Infinity as a variable: what changes a variable that began as a constant changes the constant."""
    return FAR


@wp.func
def lesser(a: wp.float64, b: wp.float64):
    if b < a:
        return b
    return a


@wp.func
def greater(a: wp.float64, b: wp.float64):
    if a < b:
        return b
    return a


@wp.func
def clamped(value: wp.float64, low: wp.float64, high: wp.float64):
    if value < low:
        return low
    if high < value:
        return high
    return value


@wp.func
def sin_cos(given: wp.float64):
    """Sine and cosine of an angle, as `sine.hpp` has them."""
    angle = given
    if not (wp.abs(angle) < _LARGE):
        # IEEE 754's remainder; C's fmod is exact, and so is the difference.
        angle = wp.mod(angle, _TURN)
        if angle > HALF * _TURN:
            angle = angle - _TURN
        elif angle < -(HALF * _TURN):
            angle = angle + _TURN
    if wp.abs(angle) < _SHORT:
        y = angle * angle
        return wp.vec2d(
            angle + angle * (y * (_S3 + y * (_S5 - y * _MINUS_S7))),
            ONE - (HALF * y - y * (y * (_C4 - y * (_MINUS_C6 - y * _C8)))),
        )
    turns = wp.floor(angle * _TWO_OVER_PI + HALF)
    r = ((angle - turns * _FIRST) - turns * _SECOND) - turns * _THIRD
    z = r * r
    s = _S15 + z * _S17
    s = _S13 + z * s
    s = _S11 + z * s
    s = _S9 + z * s
    s = _S7 + z * s
    s = _S5 + z * s
    s = _S3 + z * s
    sin = r + r * (z * s)
    c = _C16 + z * _C18
    c = _C14 + z * c
    c = _C12 + z * c
    c = _C10 + z * c
    c = _C8 + z * c
    c = _C6 + z * c
    c = _C4 + z * c
    cos = ONE - (HALF * z - z * (z * c))
    quarter = wp.int32(turns) & 3
    if quarter == 0:
        return wp.vec2d(sin, cos)
    if quarter == 1:
        return wp.vec2d(cos, -sin)
    if quarter == 2:
        return wp.vec2d(-sin, -cos)
    return wp.vec2d(-cos, sin)


@wp.func
def hashed(counter: wp.uint64):
    """SplitMix (Steele, Lea and Flood 2014)."""
    z = counter * wp.uint64(0x9E3779B97F4A7C15)
    z = (z ^ (z >> wp.uint64(30))) * wp.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> wp.uint64(27))) * wp.uint64(0x94D049BB133111EB)
    return z ^ (z >> wp.uint64(31))


@wp.func
def uniform(key: wp.uint64, index: wp.uint64):
    bits = hashed(hashed(key ^ wp.uint64(0x5CA1AB1E)) + index) >> wp.uint64(11)
    return wp.float64(bits) * _SCALE


@wp.func
def normal(key: wp.uint64, index: wp.uint64):
    """The sum of twelve numbers of 16 bits: mean 0, variance 1."""
    first = hashed(key + wp.uint64(1)) + wp.uint64(3) * index
    total = wp.int32(0)
    for i in range(3):
        bits = hashed(first + wp.uint64(i))
        for _k in range(4):
            total += wp.int32(bits & wp.uint64(0xFFFF))
            bits = bits >> wp.uint64(16)
    return wp.float64(wp.float32(total - 393210) * _SIXTEEN)


@wp.func
def stored(ranges: wp.array2d(dtype=wp.float32), value: wp.float64):
    """A range as the array holds it."""
    return wp.float64(wp.float32(value))


@wp.func
def stored(ranges: wp.array2d(dtype=wp.float64), value: wp.float64):
    return value
