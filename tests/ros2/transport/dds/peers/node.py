"""A node of trundle in another process: NAME RANGE DOMAIN OTHER …; prints, as JSON, what it has heard and seen so far.

It publishes text on /NAME until its standard input ends.
"""

# ruff: noqa: T201 - what it prints is for the test

from __future__ import annotations

import json
import sys
import threading

from trundle.messages import Codec, Qos
from trundle.ros2.transport.dds.node import DdsTransport
from trundle.ros2.transport.domain import Settings

TEXT = "std_msgs/msg/String"


def main(name: str, range_: str, domain: str, *others: str) -> None:
    codec = Codec()
    node = DdsTransport(Settings(domain=int(domain), range=range_), node=name)  # pyright: ignore[reportArgumentType]
    publisher = node.publisher(f"/{name}", TEXT, Qos())
    heard = dict.fromkeys(others, 0)
    subscriptions = {other: node.subscription(f"/{other}", TEXT, Qos()) for other in others}
    ends = threading.Event()
    threading.Thread(target=lambda: (sys.stdin.read(), ends.set()), daemon=True).start()
    seen: set[str] = set()
    said = ""
    while not ends.is_set():
        publisher.write(codec.encode(codec.make(TEXT, data=name)))
        node.wait(0.05)
        for other, subscription in subscriptions.items():
            heard[other] += len(subscription.take())
        seen.update(node.graph().nodes)
        before, said = said, json.dumps({"heard": [one for one in others if heard[one]], "nodes": sorted(seen)})
        if said != before:
            print(said, flush=True)
    node.close()


if __name__ == "__main__":
    main(*sys.argv[1:])
