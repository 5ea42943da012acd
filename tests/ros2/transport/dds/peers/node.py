"""A node of trundle in another process: NAME RANGE DOMAIN SECONDS OTHER …; prints, as JSON, what it heard and saw.

It publishes text on /NAME until the time is over, and ends early once it has heard all others.
"""

# ruff: noqa: T201 - what it prints is for the test

from __future__ import annotations

import json
import sys
import time

from trundle.messages import Codec, Qos
from trundle.ros2.transport.dds.node import DdsTransport
from trundle.ros2.transport.domain import Settings

TEXT = "std_msgs/msg/String"


def main(name: str, range_: str, domain: str, seconds: str, *others: str) -> None:
    codec = Codec()
    node = DdsTransport(Settings(domain=int(domain), range=range_), node=name)  # pyright: ignore[reportArgumentType]
    publisher = node.publisher(f"/{name}", TEXT, Qos())
    heard = dict.fromkeys(others, 0)
    subscriptions = {other: node.subscription(f"/{other}", TEXT, Qos()) for other in others}
    print("ready", flush=True)
    end = time.monotonic() + float(seconds)
    matched_by_all = enough = False
    seen: set[str] = set()
    while time.monotonic() < end:
        publisher.write(codec.encode(codec.make(TEXT, data=name)))
        node.wait(0.05)
        for other, subscription in subscriptions.items():
            heard[other] += len(subscription.take())
        seen.update(node.graph().nodes)
        matched_by_all = matched_by_all or publisher.matched == len(others)
        if matched_by_all and all(heard.values()) and not enough:
            enough, end = True, time.monotonic() + 1.0  # for the others to hear this one
    node.close()
    print(json.dumps({"heard": [other for other in others if heard[other]], "nodes": sorted(seen)}), flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
