"""Two simulators on one domain."""

from __future__ import annotations

import time

from ros2.bridge.conftest import wait_for
from trundle.messages import Qos


def test_a_second_clock_on_the_domain_is_reported(serve, network):
    other = network.transport("other_simulator")
    other.publisher("/clock", "rosgraph_msgs/msg/Clock", Qos())
    served = serve()
    wait_for(lambda: "/clock: two clocks" in served.counts)
    (text,) = [text for text in served.said if "/clock of" in text]
    assert "/other_simulator already" in text
    assert "--domain" in text


def test_the_only_clock_is_not_reported(serve):
    served = serve()
    time.sleep(1.3)
    assert served.counts == {}
