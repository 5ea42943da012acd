"""Send trundle's navigator to goals as one sends Nav2's: with nav2_simple_commander's BasicNavigator, unchanged.

In one terminal, with ROS sourced:        trundle ros2 serve warehouse --role navigator --seed 3
In another one, with ROS sourced:         python3 drive_to_goals.py [X Y [X Y ...]]
"""

import sys

import rclpy
from geometry_msgs.msg import PoseStamped
from nav2_simple_commander.robot_navigator import BasicNavigator, TaskResult


def pose(navigator, x, y):
    goal = PoseStamped()
    goal.header.frame_id = "map"
    goal.header.stamp = navigator.get_clock().now().to_msg()
    goal.pose.position.x, goal.pose.position.y = x, y
    goal.pose.orientation.w = 1.0
    return goal


numbers = [float(text) for text in sys.argv[1:]] or [-13.0, 0.0, 13.0, 0.0]
rclpy.init()
navigator = BasicNavigator()
navigator.waitUntilNav2Active()

for x, y in zip(numbers[::2], numbers[1::2], strict=True):
    navigator.goToPose(pose(navigator, x, y))
    while not navigator.isTaskComplete():
        feedback = navigator.getFeedback()
        if feedback:
            print(f"to ({x:g}, {y:g}): {feedback.distance_remaining:.2f} m left", end="\r")
    result = navigator.getResult()
    print(f"to ({x:g}, {y:g}): {result.name.lower()}          ")
    if result != TaskResult.SUCCEEDED:
        raise SystemExit(1)

navigator.spin(spin_dist=1.57, time_allowance=10)
while not navigator.isTaskComplete():
    pass
print("spin:", navigator.getResult().name.lower())
rclpy.shutdown()
