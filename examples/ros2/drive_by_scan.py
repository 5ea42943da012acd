"""Drive trundle's robot by its scan, with rclpy alone: ahead where there is room, else towards the freer side.

In one terminal, with or without ROS:     trundle ros2 serve warehouse --profile turtlebot3
In another one, with ROS sourced:         python3 drive_by_scan.py [SECONDS]
"""

import math
import sys

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan


class Wanderer(Node):
    def __init__(self, seconds):
        super().__init__("wanderer", parameter_overrides=[Parameter("use_sim_time", value=True)])
        self.seconds, self.began, self.place, self.driven = seconds, None, None, 0.0
        self.commands = self.create_publisher(Twist, "cmd_vel", 1)
        self.create_subscription(LaserScan, "scan", self.on_scan, qos_profile_sensor_data)
        self.create_subscription(Odometry, "odom", self.on_odometry, 10)

    def on_scan(self, scan):
        def room(low, high):  # [m] in the beams between two angles [deg]; 0 is ahead, left is positive
            beams = ((scan.angle_min + i * scan.angle_increment, r) for i, r in enumerate(scan.ranges))
            ahead = ((math.degrees(math.atan2(math.sin(angle), math.cos(angle))), r) for angle, r in beams)
            return min((r for angle, r in ahead if low <= angle <= high and r >= scan.range_min), default=0.0)

        now = scan.header.stamp.sec + scan.header.stamp.nanosec * 1e-9  # simulated time
        self.began = now if self.began is None else self.began
        command = Twist()
        if now - self.began < self.seconds:
            command.linear.x = 0.2 if room(-30, 30) > 0.6 else 0.0
            command.angular.z = 0.0 if command.linear.x else math.copysign(0.6, room(30, 90) - room(-90, -30))
        self.commands.publish(command)  # the robot also stops by itself, 0.5 s after the last command
        if now - self.began >= self.seconds + 0.5:
            raise SystemExit(f"drove {self.driven:.2f} m in {self.seconds:g} s")

    def on_odometry(self, odometry):
        x, y = odometry.pose.pose.position.x, odometry.pose.pose.position.y
        if self.place is not None:
            self.driven += math.dist(self.place, (x, y))
        self.place = x, y


rclpy.init()
try:
    rclpy.spin(Wanderer(float(sys.argv[1]) if len(sys.argv) > 1 else 30.0))
except SystemExit as end:
    print(end)
