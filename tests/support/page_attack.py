"""Messages that no page sends, and clients that send them until they are thrown out."""

import contextlib
import json
import random
import socket
import string

from websockets.exceptions import WebSocketException

from support.page_visitor import OpenPage, Visitor

_FIELDS = {
    "setup": {"world": "office", "robot": "jackal", "seed": 3, "start": [0, 0, 0], "goal": [1, 1, None]},
    "preview": {"world": "office"},
    "goal": {"pose": [1.0, 2.0, None], "append": True},
    "pause": {"paused": True},
    "step": {},
    "speed": {"factor": 2.0},
    "manual": {"v": 0.3, "w": -0.2},
    "release": {},
    "restart": {"seed": "next"},
    "box": {"x": 1.0, "y": 2.0, "yaw": 0.3, "size": [0.5, 0.5, 0.5]},
    "end": {},
    "drive": {"answer": None},
    "ping": {"echo": "x"},
}
_ODD = (None, True, -1, 0, 1e308, -0.0, 2**70, "", "max", "next", "../..", "\x00", [], {}, [[]], ["a"], "💥" * 50)


def any_message(rng: random.Random) -> str | bytes:
    """A message: as a page sends it, nearly so, or nothing like it."""
    kind = rng.choice(list(_FIELDS))
    fields = dict(_FIELDS[kind])
    match rng.randrange(8):
        case 0 | 1:
            return json.dumps({"type": kind, **fields})
        case 2:
            for name in list(fields) or ["x"]:
                if rng.random() < 0.6:
                    fields[name] = rng.choice(_ODD)
            return json.dumps({"type": kind, **fields})
        case 3:
            fields[rng.choice(["__class__", "type", "extra", "seed", "pose"])] = rng.choice(_ODD)
            return json.dumps({"type": kind, **fields})
        case 4:
            text = list(json.dumps({"type": kind, **fields}))
            for _ in range(rng.randrange(1, 4)):
                text[rng.randrange(len(text))] = rng.choice(string.printable)
            return "".join(text)
        case 5:
            return json.dumps(rng.choice(_ODD))
        case 6:
            return rng.randbytes(rng.randrange(300))
        case _:
            return rng.choice(["[" * 3000, '{"type":' * 500, "9" * 5000, "x" * 20_000, "NaN", "{}" * 100])


def attack(visitor: Visitor, count: int, *, seed: int) -> int:
    """Send so many messages over as many connections as it takes; return how many these were."""
    rng = random.Random(seed)
    sent = connections = 0
    while sent < count:
        connections += 1
        if rng.random() < 0.05:
            _send_garbage(visitor, rng)
            sent += 1
            continue
        with contextlib.suppress(WebSocketException, OSError, TimeoutError), visitor.open(close_timeout=0.5) as page:
            sent += _send_until_thrown_out(page, rng, count - sent)
    return connections


def _send_until_thrown_out(page: OpenPage, rng: random.Random, most: int) -> int:
    sent = 0
    try:
        while sent < most:
            page.socket.send(any_message(rng))
            sent += 1
    except (WebSocketException, OSError):
        pass
    return sent


def _send_garbage(visitor: Visitor, rng: random.Random) -> None:
    with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", visitor.port), timeout=5.0) as raw:
        raw.sendall(rng.choice([b"", b"GET /ws HTTP/1.1\r\n", b"GET / HTTP/1.1\r\nCookie: " + rng.randbytes(50)]))
        raw.sendall(rng.randbytes(rng.randrange(2000)))
