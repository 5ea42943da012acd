"""Random numbers of crowds on a device: `_core/crowds/draws.hpp`, and the seeds that `CrowdWalk.words` makes of one.

The state of a generator is a row of six numbers: the high and the low half of its state, the same of its stream, the 32
bits that are kept for the next call, and whether there are any.
"""

# pyright: reportAttributeAccessIssue=false, reportInvalidTypeForm=false, reportOperatorIssue=false
# pyright: reportCallIssue=false, reportIndexIssue=false, reportArgumentType=false

import warp as wp

from trundle.sim.batch.warp.arithmetic import EXACT

wp.set_module_options(EXACT)

DRAWS = 6
_LOW_HALF = wp.constant(wp.uint64(0xFFFFFFFF))
_32, _11, _58, _63, _1 = (wp.constant(wp.uint64(value)) for value in (32, 11, 58, 63, 1))
_FACTOR_HIGH, _FACTOR_LOW = wp.constant(wp.uint64(0x2360ED051FC65DA4)), wp.constant(wp.uint64(0x4385DF649FCCF645))
_SCALE = wp.constant(wp.float64(2.0**-53))
_XSHIFT = wp.constant(wp.uint32(16))
_INIT_A, _MULT_A = wp.constant(wp.uint32(0x43B0D7E5)), wp.constant(wp.uint32(0x931E8875))
_INIT_B, _MULT_B = wp.constant(wp.uint32(0x8B51F9DD)), wp.constant(wp.uint32(0x58F38DED))
_MIX_LEFT, _MIX_RIGHT = wp.constant(wp.uint32(0xCA01F9DD)), wp.constant(wp.uint32(0x4973F715))

_Pool = wp.types.vector(length=4, dtype=wp.uint32)
_Words = wp.types.vector(length=4, dtype=wp.uint64)


@wp.func
def product_high(a: wp.uint64, b: wp.uint64):
    """The upper 64 bits of a product."""
    a_low, a_high, b_low, b_high = a & _LOW_HALF, a >> _32, b & _LOW_HALF, b >> _32
    low = a_low * b_low
    middle = a_high * b_low + (low >> _32)
    other = a_low * b_high + (middle & _LOW_HALF)
    return a_high * b_high + (middle >> _32) + (other >> _32)


@wp.func
def advance(draws: wp.array3d(dtype=wp.uint64), crowd: wp.int32, robot: wp.int32):
    high, low = wp.uint64(draws[crowd, robot, 0]), wp.uint64(draws[crowd, robot, 1])
    new_low = low * _FACTOR_LOW
    new_high = high * _FACTOR_LOW + low * _FACTOR_HIGH + product_high(low, _FACTOR_LOW)
    sum_low = new_low + draws[crowd, robot, 3]
    sum_high = new_high + draws[crowd, robot, 2]
    if sum_low < new_low:
        sum_high = sum_high + _1
    draws[crowd, robot, 0] = sum_high
    draws[crowd, robot, 1] = sum_low


@wp.func
def next_bits(draws: wp.array3d(dtype=wp.uint64), crowd: wp.int32, robot: wp.int32):
    """64 random bits; PCG XSL RR 128/64 (O'Neill 2014)."""
    advance(draws, crowd, robot)
    high = wp.uint64(draws[crowd, robot, 0])
    mixed = high ^ draws[crowd, robot, 1]
    turn = high >> _58
    return (mixed >> turn) | (mixed << ((wp.uint64(64) - turn) & _63))


@wp.func
def draw_half(draws: wp.array3d(dtype=wp.uint64), crowd: wp.int32, robot: wp.int32):
    """32 random bits; the upper ones of a number serve the next call."""
    if draws[crowd, robot, 5] != wp.uint64(0):
        draws[crowd, robot, 5] = wp.uint64(0)
        return wp.uint64(draws[crowd, robot, 4])
    bits = next_bits(draws, crowd, robot)
    draws[crowd, robot, 4] = bits >> _32
    draws[crowd, robot, 5] = _1
    return bits & _LOW_HALF


@wp.func
def draw_whole(draws: wp.array3d(dtype=wp.uint64), crowd: wp.int32, robot: wp.int32, given: wp.int32):
    """0 to count − 1 (Lemire 2019)."""
    if given < 2:
        return 0
    count = wp.uint64(given)
    product = draw_half(draws, crowd, robot) * count
    if (product & _LOW_HALF) < count:
        least = (wp.uint64(0x100000000) - count) % count
        while (product & _LOW_HALF) < least:
            product = draw_half(draws, crowd, robot) * count
    return wp.int32(product >> _32)


@wp.func
def draw_uniform(
    draws: wp.array3d(dtype=wp.uint64), crowd: wp.int32, robot: wp.int32, low: wp.float64, high: wp.float64
):
    return low + (high - low) * (wp.float64(next_bits(draws, crowd, robot) >> _11) * _SCALE)


@wp.func
def seed_words(seed: wp.uint64, key: wp.uint32):
    """NumPy's `SeedSequence([seed, key]).generate_state(4, uint64)`."""
    entropy = _Pool()
    entropy[0] = wp.uint32(seed & _LOW_HALF)
    if (seed >> _32) == wp.uint64(0):
        entropy[1] = key
    else:
        entropy[1] = wp.uint32(seed >> _32)
        entropy[2] = key
    pool = _Pool()
    hashed = wp.uint32(_INIT_A)
    for i in range(4):
        value = entropy[i] ^ hashed
        hashed = hashed * _MULT_A
        value = value * hashed
        pool[i] = value ^ (value >> _XSHIFT)
    for source in range(4):
        for target in range(4):
            if source != target:
                value = pool[source] ^ hashed
                hashed = hashed * _MULT_A
                value = value * hashed
                value = value ^ (value >> _XSHIFT)
                mixed = _MIX_LEFT * pool[target] - _MIX_RIGHT * value
                pool[target] = mixed ^ (mixed >> _XSHIFT)
    words = _Words()
    hashed = wp.uint32(_INIT_B)
    for i in range(8):
        value = pool[i % 4] ^ hashed
        hashed = hashed * _MULT_B
        value = value * hashed
        half = wp.uint64(value ^ (value >> _XSHIFT))
        if i % 2 == 0:
            words[i // 2] = half
        else:
            words[i // 2] = words[i // 2] | (half << _32)
    return words


@wp.func
def start_draws(
    draws: wp.array3d(dtype=wp.uint64),
    crowd: wp.int32,
    robot: wp.int32,
    high_word: wp.uint64,
    low_word: wp.uint64,
    stream_high: wp.uint64,
    stream_low: wp.uint64,
):
    """Begin with four words; the constructor of `Draws`."""
    draws[crowd, robot, 0] = wp.uint64(0)
    draws[crowd, robot, 1] = wp.uint64(0)
    draws[crowd, robot, 2] = (stream_high << _1) | (stream_low >> _63)
    draws[crowd, robot, 3] = (stream_low << _1) | _1
    draws[crowd, robot, 4] = wp.uint64(0)
    draws[crowd, robot, 5] = wp.uint64(0)
    advance(draws, crowd, robot)
    low = draws[crowd, robot, 1] + low_word
    high = draws[crowd, robot, 0] + high_word
    if low < low_word:
        high = high + _1
    draws[crowd, robot, 0] = high
    draws[crowd, robot, 1] = low
    advance(draws, crowd, robot)
