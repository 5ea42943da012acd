"""Drives by a navigator that goes away and comes back, and prints what it sees as lines of JSON."""

import json

import rclpy
from geometry_msgs.msg import PoseStamped
from nav2_msgs.action import NavigateToPose
from rclpy.action import ActionClient


def say(**values):
    print(json.dumps(values), flush=True)


def make_goal(x, y):
    pose = PoseStamped()
    pose.header.frame_id = "map"
    pose.pose.position.x, pose.pose.position.y, pose.pose.orientation.w = x, y, 1.0
    return NavigateToPose.Goal(pose=pose)


def send(client, node, goal, tries=10):
    """Send a goal until it is answered: what is sent before both sides have found each other is lost."""
    for _ in range(tries):
        sent = client.send_goal_async(goal)
        rclpy.spin_until_future_complete(node, sent, timeout_sec=3.0)
        if sent.done():
            return sent.result()
    raise SystemExit("no goal was answered")


rclpy.init()
node = rclpy.create_node("survivor")
client = ActionClient(node, NavigateToPose, "navigate_to_pose")
client.wait_for_server()
goal = send(client, node, make_goal(6.5, 1.5))
say(accepted=goal.accepted)
result = goal.get_result_async()
input()  # the navigator has gone, and is back
rclpy.spin_once(node, timeout_sec=0.2)
say(done=result.done())
result = send(client, node, make_goal(1.5, 2.5)).get_result_async()
rclpy.spin_until_future_complete(node, result)
say(status=result.result().status)
