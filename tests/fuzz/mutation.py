"""Mutated files: what is changed in the content of a good one."""

from __future__ import annotations

import random
from collections.abc import Sequence

_NUMBERS = (b"0", b"-1", b"1e300", b"nan", b"inf", b"1e-300", b"", b"x", b"1 1", b"4294967296", b"100000000")


def mutate(content: bytes, generator: random.Random, tokens: Sequence[bytes]) -> bytes:
    """Change a few places: flips, cuts, copies, tokens, other numbers, exchanged lines."""
    out = bytearray(content)
    for _ in range(generator.choice((1, 1, 1, 2, 3, 8))):
        at = generator.randrange(len(out) + 1)
        end = min(len(out), at + generator.choice((1, 2, 4, 16, 64)))
        match generator.randrange(9):
            case 0 if at < len(out):
                out[at] ^= 1 << generator.randrange(8)
            case 1:
                out[at:end] = generator.randbytes(end - at)
            case 2:
                del out[at:end]
            case 3:
                out[at:at] = out[at:end] * generator.choice((1, 2, 50))
            case 4:
                out[at : generator.choice((at, end))] = generator.choice(tokens)
            case 5 | 6:
                out = _change_number(out, generator)
            case 7:
                lines = bytes(out).split(b"\n")
                one, other = generator.randrange(len(lines)), generator.randrange(len(lines))
                lines[one], lines[other] = lines[other], lines[one]
                out = bytearray(b"\n".join(lines))
            case _ if generator.random() < 0.2:
                del out[at:]
            case _:
                pass
    return bytes(out)


def _change_number(out: bytearray, generator: random.Random) -> bytearray:
    """Another value where a number stands in text."""
    places = [index for index, byte in enumerate(out[:20_000]) if 48 <= byte <= 57]
    if not places:
        return out
    begin = end = generator.choice(places)
    while end < len(out) and chr(out[end]) in "0123456789.e-":
        end += 1
    return out[:begin] + generator.choice(_NUMBERS) + out[end:]
