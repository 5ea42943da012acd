"""`trundle ros2 serve|check` on a network in memory."""

import json
import signal
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from rosbags.highlevel import AnyReader

from ros2.fake_transport import FakeNetwork
from support.command_line import Trundle
from support.page_visitor import OpenPage
from trundle.errors import SimulationError
from trundle.messages.codec import Codec
from trundle.messages.qos import CLOCK, SENSOR, Qos
from trundle.ros2.bridge import Bridge

ROBOT = ("--robot", "turtlebot3_burger", "--backend", "kinematic")


def _press() -> None:
    signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)


@pytest.fixture
def meanwhile() -> Iterator[Callable[[Callable[[], None]], list[Exception]]]:
    """Play a part in a thread while a command runs, and then press Ctrl-C; returns the errors it met."""
    threads: list[threading.Thread] = []

    def prepare(part: Callable[[], None]) -> list[Exception]:
        errors: list[Exception] = []

        def run() -> None:
            try:
                part()
            except Exception as error:  # noqa: BLE001 - reported by the test
                errors.append(error)
            finally:
                _press()

        threads.append(threading.Thread(target=run))
        threads[-1].start()
        return errors

    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell may have it ignored
    yield prepare
    for thread in threads:
        thread.join()
    signal.signal(signal.SIGINT, before)


def wait_for(is_so: Callable[[], object]) -> None:
    """Wait until this is true."""
    end = time.monotonic() + 60.0
    while not is_so():
        assert time.monotonic() < end
        time.sleep(0.01)


def wait_for_messages(network: FakeNetwork, topic: str = "/clock", least: int = 1) -> None:
    """Read a topic until as much was published on it."""
    kind, qos = {"/clock": ("rosgraph_msgs/msg/Clock", CLOCK), "/scan": ("sensor_msgs/msg/LaserScan", SENSOR)}[topic]
    reader = network.transport("reader")
    reader.subscription(topic, kind, qos)
    wait_for(lambda: len(network.sent.get(topic, ())) >= least)
    reader.close()


@pytest.mark.parametrize("goals", [("1.2,0.5",), ("1.0,0.5", "1.4,0.7")])
def test_serve_as_navigator_drives_to_its_goals(
    trundle: Trundle, network: FakeNetwork, room_map: Path, caplog: pytest.LogCaptureFixture, goals: tuple[str, ...]
) -> None:
    given = [word for goal in goals for word in ("--goal", goal)]
    run = ("ros2", "serve", room_map, *ROBOT, "--role", "navigator", "--speed", "max", "--json", "--time-limit", "20")
    done = trundle(*run, "--start", "0.5,0.5,0", *given)
    assert done.code == 0
    assert "--goal: the robot has arrived" in caplog.text
    assert json.loads(done.out.splitlines()[1])["distance_m"] > 0.4


def test_serve_says_why_it_does_not_drive_to_its_goal(
    trundle: Trundle, network: FakeNetwork, room_map: Path, caplog: pytest.LogCaptureFixture
) -> None:
    run = ("ros2", "serve", room_map, *ROBOT, "--role", "navigator", "--speed", "max", "--json", "--time-limit", "2")
    trundle(*run, "--start", "0.5,0.5,0", "--goal=-1,1", "--planner-option", "goal_tolerance=0")
    assert "--goal is refused: the goal (-1.00, 1.00" in caplog.text


@pytest.mark.parametrize("role", ["simulator", "navigator"])
def test_serve_refuses_a_start_where_the_robot_touches_something(
    trundle: Trundle, network: FakeNetwork, room_map: Path, role: str
) -> None:
    done = trundle("ros2", "serve", room_map, *ROBOT, "--role", role, "--start=-1,1,0", "--time-limit", "1")
    assert done.code == 2
    assert "at its start (-1.00, 1.00, 0°) the robot would touch" in done.err


def test_serve_publishes_the_robot_and_drives_it_by_commands(
    trundle: Trundle, network: FakeNetwork, meanwhile: Callable[..., list], room_map: Path
) -> None:
    codec = Codec("jazzy")
    moved: list[float] = []

    def part() -> None:
        client = network.transport("client")
        odometry = client.subscription("/odom", "nav_msgs/msg/Odometry", Qos())
        commands = client.publisher("/cmd_vel", "geometry_msgs/msg/Twist", Qos())
        wait_for_messages(network, least=10)
        twist = codec.kind("geometry_msgs/msg/Twist")
        vector = codec.kind("geometry_msgs/msg/Vector3")
        command = codec.encode(twist(linear=vector(0.2, 0.0, 0.0), angular=vector(0.0, 0.0, 0.0)))

        def has_moved() -> bool:
            commands.write(command)
            moved.extend(
                codec.decode("nav_msgs/msg/Odometry", one.data).pose.pose.position.x for one in odometry.take()
            )
            return bool(moved) and moved[-1] > 0.02

        wait_for(has_moved)

    errors = meanwhile(part)
    done = trundle("ros2", "serve", room_map, "--start", "0.5,0.5,0", *ROBOT, "--json")
    assert (done.code, errors) == (0, []), done.err
    offer, end = map(json.loads, done.out.splitlines())
    assert (offer["role"], offer["profile"], offer["node"], offer["domain"]) == ("simulator", "plain", "/trundle", 0)
    published = {row["topic"]: row["type"] for row in offer["publishes"]}
    assert published["/clock"] == "rosgraph_msgs/msg/Clock"
    assert published["/scan"] == "sensor_msgs/msg/LaserScan"
    assert {row["type"] for row in offer["reads"]} >= {"geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"}
    assert end["outcome"] == "aborted"
    assert end["distance_m"] > 0.01
    assert not network.transports or all(transport.node == "/client" for transport in network.transports)


def test_ctrl_c_before_the_run_begins_ends_it_as_well(
    trundle: Trundle, network: FakeNetwork, monkeypatch: pytest.MonkeyPatch, room_map: Path
) -> None:
    def interrupt(_: Bridge) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Bridge, "run", interrupt)
    done = trundle("ros2", "serve", room_map, *ROBOT, "--json")
    assert done.code == 0, done.err
    assert json.loads(done.out.splitlines()[-1])["message"] == "stopped by Ctrl-C"
    assert not network.transports


def test_ctrl_c_as_soon_as_the_offer_is_printed_ends_it_as_well(
    trundle: Trundle, network: FakeNetwork, monkeypatch: pytest.MonkeyPatch, room_map: Path
) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("trundle.cli.ros2.running.describe_offer", interrupt)
    done = trundle("ros2", "serve", room_map, *ROBOT, "--json")
    assert done.code == 0, done.err
    assert json.loads(done.out)["message"] == "stopped by Ctrl-C"


def test_a_simulator_that_fails_has_exit_code_1(
    trundle: Trundle, network: FakeNetwork, monkeypatch: pytest.MonkeyPatch, room_map: Path
) -> None:
    def fail(*_: object) -> None:
        raise SimulationError("the physics broke down")

    monkeypatch.setattr("trundle.sim.kinematic.KinematicSimulator.step", fail)
    done = trundle("ros2", "serve", room_map, *ROBOT)
    assert done.code == 1, done.err
    assert "the physics broke down" in done.out


def test_names_are_those_of_the_namespace_and_the_remaps(
    trundle: Trundle, network: FakeNetwork, meanwhile: Callable[..., list], room_map: Path
) -> None:
    errors = meanwhile(lambda: wait_for_messages(network))
    given = ("--namespace", "robot1", "--remap", "scan:=lidar", "--remap", "__node:=carter")
    done = trundle("ros2", "serve", room_map, *ROBOT, *given, "--json")
    assert (done.code, errors) == (0, []), done.err
    offer = json.loads(done.out.splitlines()[0])
    assert offer["node"] == "/robot1/carter"
    topics = {row["topic"] for row in offer["publishes"]}
    assert {"/clock", "/tf", "/robot1/odom", "/robot1/lidar"} <= topics
    assert "/robot1/cmd_vel" in {row["topic"] for row in offer["reads"]}


def test_what_is_offered_is_printed_for_people(
    trundle: Trundle, network: FakeNetwork, meanwhile: Callable[..., list], room_map: Path
) -> None:
    errors = meanwhile(lambda: wait_for_messages(network))
    done = trundle("ros2", "serve", room_map, "--profile", "turtlebot3", "--backend", "kinematic")
    assert (done.code, errors) == (0, []), done.err
    assert "simulator, profile turtlebot3" in done.out
    assert "0, distribution jazzy, localhost" in done.out
    assert "/scan" in done.out
    assert "reliable" in done.out
    assert "Ctrl-C ends it" in done.err
    assert "real time" in done.out


def test_the_profile_brings_its_robot_unless_another_one_is_given(
    trundle: Trundle, network: FakeNetwork, meanwhile: Callable[..., list], room_map: Path
) -> None:
    def part() -> None:
        client = network.transport("client")
        described = client.subscription(
            "/robot_description", "std_msgs/msg/String", Qos(1, durability="transient_local")
        )
        wait_for_messages(network)
        wait_for(lambda: [text.append(one.data) for one in described.take()] or text)

    text: list[bytes] = []
    errors = meanwhile(part)
    done = trundle("ros2", "serve", room_map, "--profile", "carter_navigation", *ROBOT, "--json")
    assert (done.code, errors) == (0, []), done.err
    assert b"turtlebot3_burger" in text[0]


def test_a_profile_of_your_own_is_a_file(
    trundle: Trundle, network: FakeNetwork, meanwhile: Callable[..., list], room_map: Path
) -> None:
    Path("mine.yaml").write_text("topics: {odom: wheels/odom}\nsensors: {scan: {frame: laser, scan: laser/scan}}\n")
    errors = meanwhile(lambda: wait_for_messages(network))
    done = trundle("ros2", "serve", room_map, "--profile", "mine.yaml", *ROBOT, "--json")
    assert (done.code, errors) == (0, []), done.err
    offer = json.loads(done.out.splitlines()[0])
    assert offer["profile"] == "mine.yaml"
    assert {"/wheels/odom", "/laser/scan"} <= {row["topic"] for row in offer["publishes"]}


def test_the_recording_is_what_went_over_the_wire(
    trundle: Trundle, network: FakeNetwork, meanwhile: Callable[..., list], room_map: Path
) -> None:
    codec = Codec("jazzy")

    def part() -> None:
        client = network.transport("client")
        commands = client.publisher("/cmd_vel", "geometry_msgs/msg/Twist", Qos())
        wait_for_messages(network, least=5)
        still = codec.kind("geometry_msgs/msg/Vector3")(0.0, 0.0, 0.0)
        commands.write(codec.encode(codec.kind("geometry_msgs/msg/Twist")(still, still)))
        wait_for_messages(network, "/scan", 3)

    errors = meanwhile(part)
    done = trundle("ros2", "serve", room_map, *ROBOT, "--record", "-o", "bag", "--json")
    assert (done.code, errors) == (0, []), done.err
    end = json.loads(done.out.splitlines()[-1])
    assert Path(end["recording"]) == Path("bag/wire.mcap")
    recorded: dict[str, list[bytes]] = {}
    with AnyReader([Path("bag/wire.mcap")]) as reader:
        for connection, _, data in reader.messages():
            recorded.setdefault(connection.topic, []).append(bytes(data))
    assert sum(map(len, recorded.values())) == end["messages"]
    assert recorded == network.sent


def test_it_is_shown_and_ended_in_the_browser(
    trundle: Trundle, network: FakeNetwork, play: Callable[..., list], room_map: Path
) -> None:
    seen: list[dict] = []

    def part(page: OpenPage) -> None:
        seen.append(page.wait("run"))
        page.wait("frame")
        page.send("end")

    errors = play(part)
    done = trundle("ros2", "serve", room_map, *ROBOT, "--browser", "--json")
    assert (done.code, errors) == (0, []), done.err
    assert "The page: http://127.0.0.1:" in done.err
    assert seen[0]["n"] == 1
    assert "ended by" in json.loads(done.out.splitlines()[-1])["message"]


def test_recordings_get_a_folder_of_their_own(
    trundle: Trundle, network: FakeNetwork, meanwhile: Callable[..., list], room_map: Path
) -> None:
    meanwhile(lambda: wait_for_messages(network))
    done = trundle("ros2", "serve", room_map, *ROBOT, "--record", "--json")
    assert done.code == 0, done.err
    (path,) = Path("runs").glob("*/wire.mcap")
    assert json.loads(done.out.splitlines()[-1])["recording"] == str(path)
    refused = trundle("ros2", "serve", room_map, *ROBOT, "--record", "-o", path)
    assert refused.code == 2
    assert "already exists" in refused.err


def test_what_a_transport_cannot_serve_is_counted_and_listed_in_the_json(
    trundle: Trundle,
    network: FakeNetwork,
    meanwhile: Callable[..., list],
    monkeypatch: pytest.MonkeyPatch,
    room_map: Path,
) -> None:
    monkeypatch.setattr(
        "trundle.ros2.transport.opening.open_transport",
        lambda *_, **__: network.transport("trundle", has_services=False),
    )
    meanwhile(lambda: wait_for_messages(network))
    done = trundle("ros2", "serve", room_map, *ROBOT, "--role", "navigator", "--json")
    missing = json.loads(done.out.splitlines()[0])["not_served"]
    assert "/navigate_to_pose" in missing
    more = len(network.sent["/clock"]) + 1
    meanwhile(lambda: wait_for_messages(network, least=more))
    told = trundle("ros2", "serve", room_map, *ROBOT, "--role", "navigator")
    assert f"not served: {len(missing)} services and actions" in told.out
    assert done.code == told.code == 0
