"""The real environments of ROS 2: their types are the published ones, and they can talk to themselves."""

from pathlib import Path

import pytest
from rosbags.typesys import Stores, get_typestore

from ros2.conftest import Ros, hashes

# From the type descriptions that colcon wrote for others' builds of Nav2.
PUBLISHED = {
    "kilted": {
        "nav2_msgs/action/NavigateToPose_Goal": "22a9dffbd6733011220460bd52edbc7843c8fc86282d40bc7ad3ca176a9dec10",
        "nav2_msgs/action/NavigateToPose_Result": "ddbff7fc6d1e51d774d5defdb8398a57cb23fa8709355002d676408bb4860b85",
        "nav2_msgs/action/NavigateThroughPoses_Result": (
            "c1cba96c1a8dff972fb892764582e004f88e1bf68e12ccddd3b9ebc820c308e3"
        ),
        "nav2_msgs/action/FollowPath_Result": "432bc8fc1c0de59f8181d00bf8dcc7d58e76cebcfd2de471361e62f468ad4428",
        "nav2_msgs/action/FollowWaypoints_Result": "58f76203b5766c271beec3de33b1218ac1c3d46ada01ae755b4987cfb5754fe4",
        "nav2_msgs/action/Spin_Goal": "f6e33f6a4d5d9c4e34cfa68f31818cd096d4251c162738ea5c01a9a8854779fc",
        "nav2_msgs/action/Spin_Result": "7e028af50815284a59ab43101abfd16f349963c4f0a832c33f497bfcab114a6b",
        "nav2_msgs/action/BackUp_Goal": "07be8f5f294103a66436fbd9072f6595359431e03221039da9a8e56c2d88d8d8",
        "nav2_msgs/action/ComputeRoute_Result": "ccb528edc79f5fab501edf8b4305dfdc963b612b166573043a6cc533a61899fe",
        "nav2_msgs/msg/WaypointStatus": "4ac489f0a5a77648dcecf79b070c1ce5b126cd8fe4ed6ff0d316f87089b8f028",
        "nav2_msgs/msg/Route": "e7a30327e3f17e37bb7c8d559ca6a84e189ed17725f0b6ecc02fbcceeef70184",
    },
    # Those that are the same in both.
    "jazzy": {
        "nav2_msgs/action/NavigateToPose_Goal": "22a9dffbd6733011220460bd52edbc7843c8fc86282d40bc7ad3ca176a9dec10",
        "nav2_msgs/action/NavigateToPose_Result": "ddbff7fc6d1e51d774d5defdb8398a57cb23fa8709355002d676408bb4860b85",
        "nav2_msgs/action/FollowPath_Result": "432bc8fc1c0de59f8181d00bf8dcc7d58e76cebcfd2de471361e62f468ad4428",
        "nav2_msgs/action/Spin_Result": "7e028af50815284a59ab43101abfd16f349963c4f0a832c33f497bfcab114a6b",
    },
}

STORES = {"jazzy": Stores.ROS2_JAZZY, "kilted": Stores.ROS2_KILTED}

# Where rosbags' definitions differ from the wheels', as of 0.11; none of them is published by anyone but the RMW.
DIFFERENT = {"std_msgs/msg/Char", "service_msgs/msg/ServiceEventInfo"}

ECHO = """
import threading
import rclpy
from rclpy.action import ActionClient, ActionServer
from rclpy.executors import MultiThreadedExecutor
from nav2_msgs.action import NavigateToPose
from simulation_interfaces.srv import StepSimulation
from tf2_msgs.msg import TFMessage

rclpy.init()
node = rclpy.create_node("itself")
received = threading.Event()
node.create_subscription(TFMessage, "tf", lambda message: received.set(), 10)
publisher = node.create_publisher(TFMessage, "tf", 10)

def step(request, response):
    response.result.result = request.steps
    return response

def drive(goal):
    goal.publish_feedback(NavigateToPose.Feedback(distance_remaining=2.5))
    goal.succeed()
    return NavigateToPose.Result(error_code=7, error_msg="as asked")

service = node.create_service(StepSimulation, "step", step)
server = ActionServer(node, NavigateToPose, "navigate", drive)
caller = node.create_client(StepSimulation, "step")
client = ActionClient(node, NavigateToPose, "navigate")
executor = MultiThreadedExecutor()
executor.add_node(node)
spinning = threading.Thread(target=executor.spin)
spinning.start()

def wait(future):
    done = threading.Event()
    future.add_done_callback(lambda _: done.set())
    assert done.wait(60)
    return future.result()

assert caller.wait_for_service(60) and client.wait_for_server(60)
print(wait(caller.call_async(StepSimulation.Request(steps=5))).result.result)
feedback = []
handle = wait(client.send_goal_async(NavigateToPose.Goal(), feedback.append))
result = wait(handle.get_result_async()).result
print(result.error_code, result.error_msg)
while not received.is_set():
    publisher.publish(TFMessage())
    received.wait(0.1)
executor.shutdown()
spinning.join()
rclpy.shutdown()
"""


def test_types_built_from_our_text_are_those_that_others_built(ros: Ros) -> None:
    found = hashes(ros)
    assert {name: found[name] for name in PUBLISHED[ros.distro]} == PUBLISHED[ros.distro]


def test_types_are_those_of_the_codec(ros: Ros) -> None:
    found, store = hashes(ros), get_typestore(STORES[ros.distro])
    both = {name for name in found if name in store.fielddefs and not name.startswith("rmw_dds_common/")}
    assert "tf2_msgs/msg/TFMessage" in both
    assert len(both) > 100
    ours = {name: store.hash_rihs01(name).removeprefix("RIHS01_") for name in both}
    assert {name for name in both if ours[name] != found[name]} <= DIFFERENT


def test_the_types_of_the_distributions_differ_where_nav2_changed_them(ros: Ros) -> None:
    share = Path(ros.env["AMENT_PREFIX_PATH"], "share", "nav2_msgs")
    new = ros.distro == "kilted"
    assert (share / "msg" / "WaypointStatus.msg").exists() is new
    assert (share / "msg" / "MissedWaypoint.msg").exists() is not new
    assert ("nav_msgs/Goals poses" in (share / "action" / "NavigateThroughPoses.action").read_text()) is new


@pytest.mark.ros2
def test_topics_services_and_actions_work_within_one_process(ros: Ros) -> None:
    process = ros.script(ECHO)
    output, errors = process.communicate(timeout=120)
    assert (process.returncode, output.splitlines()) == (0, ["5", "7 as asked"]), errors
