"""A bridge that drives, and a client that uses it as Nav2 is used, on a network in memory."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from ros2.fake_transport import FakeCall, FakeGoal, FakeNetwork
from ros2.nav2_texts import nav2_codec, nav2_texts
from trundle.maps import OccupancyGrid
from trundle.messages import Codec, Distro, Qos
from trundle.mission import End, Episode, Scenario
from trundle.mission.steering.directives import Directive
from trundle.ros2.bridge import Bridge
from trundle.ros2.names import Names
from trundle.ros2.types import Types

QUICK_S = 120.0
LATCHED = Qos(10, durability="transient_local")
POSE, COVARIANT = "geometry_msgs/msg/PoseStamped", "geometry_msgs/msg/PoseWithCovarianceStamped"


def wait_for(true: Callable[[], Any], what: str = "") -> Any:
    """Wait until something is true, and return it."""
    until = time.monotonic() + QUICK_S
    while not (found := true()):
        assert time.monotonic() < until, f"waited in vain {what}"
        time.sleep(0.002)
    return found


class Goal:
    """A goal that a client has sent."""

    def __init__(self, name: str, type_name: str, sent: FakeGoal, client: Client) -> None:
        self._name, self._type_name, self._sent, self._client = name, type_name, sent, client

    @property
    def status(self) -> str:
        return self._sent.status

    @property
    def feedback(self) -> list[Any]:
        decode = self._client.types.decode
        return [decode(f"{self._type_name}_Feedback", data) for data in list(self._sent.feedback)]

    def cancel(self) -> None:
        self._client.network.cancel(self._name, self._sent)

    def wait(self) -> Any:
        """The result."""
        data = wait_for(lambda: self._sent.result, f"for {self._name}: {self.status}")
        return self._client.types.decode(f"{self._type_name}_Result", data)

    def wait_for_feedback(self, count: int = 1) -> Any:
        wait_for(lambda: len(self._sent.feedback) >= count or self._sent.result)
        return self.feedback[-1]


class Client:
    """A node that uses the navigator."""

    def __init__(self, network: FakeNetwork, distro: Distro) -> None:
        self.network = network
        self.transport = network.transport("client", distro=distro)
        self.types = Types(nav2_codec(distro), self.transport)
        self._readers: dict[str, Any] = {}

    def learn(self, texts: dict[str, str]) -> dict[str, str]:
        """Know Nav2's types with these texts in place of theirs; returns all of them."""
        self.transport.definitions = nav2_texts(self.transport.distro) | texts
        self.types = Types(Codec(self.transport.distro), self.transport)
        return self.transport.definitions

    def pose(self, x: float, y: float, yaw: float = 0.0, *, frame: str = "map", stamp: int = 0) -> Any:
        make = self.types.make
        header = make("std_msgs/msg/Header", frame_id=frame, stamp=make("builtin_interfaces/msg/Time", sec=stamp))
        turn = make("geometry_msgs/msg/Quaternion", z=math.sin(yaw / 2), w=math.cos(yaw / 2))
        at = make("geometry_msgs/msg/Point", x=x, y=y)
        return make(POSE, header=header, pose=make("geometry_msgs/msg/Pose", position=at, orientation=turn))

    def path(self, poses: list[Any], frame: str = "map") -> Any:
        header = self.types.make("std_msgs/msg/Header", frame_id=frame)
        return self.types.make("nav_msgs/msg/Path", header=header, poses=poses)

    def seconds(self, seconds: float) -> Any:
        whole = int(seconds)
        return self.types.make("builtin_interfaces/msg/Duration", sec=whole, nanosec=round((seconds - whole) * 1e9))

    def send(self, name: str, action: str, **fields: Any) -> Goal:
        type_name = f"nav2_msgs/action/{action}"
        request = self.types.make(f"{type_name}_Goal", **fields)
        goal = Goal(name, type_name, self.network.send_goal(name, self.types.encode(request)), self)
        wait_for(lambda: goal.status != "sent")
        return goal

    def go(self, x: float, y: float, yaw: float = 0.0, **options: Any) -> Goal:
        return self.send("/navigate_to_pose", "NavigateToPose", pose=self.pose(x, y, yaw, **options))

    def call(self, name: str, type_name: str, **fields: Any) -> Any:
        request = self.types.encode(self.types.make(f"{type_name}_Request", **fields))
        call: FakeCall = self.network.call(name, request)
        response = wait_for(lambda: call.response is not None and (call.response,))[0]
        return self.types.decode(f"{type_name}_Response", response)

    def publish(self, topic: str, message: Any) -> None:
        self.transport.publisher(topic, message.__msgtype__, Qos()).write(self.types.encode(message))

    def read(self, topic: str, type_name: str, qos: Qos | None = None) -> None:
        subscription = self.transport.subscription(topic, type_name, Qos() if qos is None else qos)
        self._readers[topic] = subscription, type_name, list[Any]()

    def got(self, topic: str) -> list[Any]:
        subscription, type_name, kept = self._readers[topic]
        kept += [self.types.decode(type_name, sample.data) for sample in subscription.take()]
        return kept


class Served:
    """A bridge that drives, in a thread."""

    def __init__(self, bridge: Bridge, said: list[str]) -> None:
        self.bridge, self.said = bridge, said
        self.episode: Episode | None = None
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self) -> None:
        self.episode = self.bridge.run()

    def put(self, directive: Directive) -> None:
        self.bridge.context.driver.steering.put(directive)

    @property
    def goals(self) -> tuple[Any, ...]:
        """The goals of the run now."""
        report = self.bridge.context.driver.status.steering
        return () if report is None else report.goals

    def end(self) -> Episode:
        if self._thread.is_alive():
            self.put(End("the test is over"))
            self._thread.join(QUICK_S)
        assert self.episode is not None
        return self.episode

    def close(self) -> None:
        self.end()
        self.bridge.close()

    @property
    def counts(self) -> dict[str, int]:
        return self.bridge.wire.warnings.counts


def make_room() -> OccupancyGrid:
    """A walled room of 8 x 6 m with its lower left corner at (0, 0), and a block from the south up to y = 3 m."""
    data = np.zeros((120, 160), dtype=np.int8)
    data[[0, -1], :] = 100
    data[:, [0, -1]] = 100
    data[:60, 72:88] = 100
    return OccupancyGrid(data, 0.05)


@pytest.fixture(scope="session")
def room_file(tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("room") / "room.yaml"
    make_room().save(path)
    return str(path)


@pytest.fixture
def network() -> FakeNetwork:
    return FakeNetwork()


@pytest.fixture
def make_client(network: FakeNetwork) -> Callable[[Distro], Client]:
    return lambda distro: Client(network, distro)


@pytest.fixture
def client(network: FakeNetwork) -> Client:
    return Client(network, "jazzy")


def make_scenario(room_file: str, **settings: Any) -> Scenario:
    """A robot without lidars in the west of the room."""
    start = (1.5, 1.5, 0.0)
    usual = {"map": room_file, "robot": "nova_carter", "backend": "kinematic", "start": start, "lidar": False}
    return Scenario.make(**usual | settings)


@pytest.fixture
def serve(network: FakeNetwork, room_file: str) -> Iterator[Callable[..., Served]]:
    """Makes bridges; they are closed after the test."""
    made: list[Served] = []

    def serve(
        distro: Distro = "jazzy",
        *,
        scenario: dict[str, Any] | None = None,
        definitions: dict[str, str] | None = None,
        has_services: bool = True,
        **options: Any,
    ) -> Served:
        said: list[str] = []
        transport = network.transport("trundle", distro=distro, has_services=has_services)
        transport.definitions = definitions or {}
        codec = nav2_codec(distro) if definitions is None else Codec(distro)
        bridge = Bridge(
            make_scenario(room_file, **scenario or {}),
            transport,
            Types(codec, transport),
            options.pop("names", Names()),
            **{"role": "navigator", "speed": math.inf, "report": said.append, **options},
        )
        made.append(Served(bridge, said))
        return made[-1]

    yield serve
    for served in made:
        served.close()
