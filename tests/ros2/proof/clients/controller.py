"""A controller in plain rclpy: to a goal by /scan, /odom and /cmd_vel, in place of Nav2. controller.py X Y

Heads for the goal, or for the direction nearest to it where there is room.
"""

import json
import math
import sys

ROOM, SIDE, NEAR = 0.9, 0.3, 0.2  # [m] wanted ahead and beside the path; distance at which the goal is reached


def steer(ranges, angle_min, increment, to_goal, distance):
    """The command (m/s, rad/s) for a scan and the direction [rad] and distance [m] of the goal."""
    if distance < NEAR:
        return 0.0, 0.0
    near = [(angle_min + i * increment, r) for i, r in enumerate(ranges) if math.isfinite(r) and r < ROOM + SIDE]

    def room(direction):
        ahead = [(r * math.cos(a - direction), abs(r * math.sin(a - direction))) for a, r in near]
        return min((x for x, y in ahead if x > 0.0 and y < SIDE), default=ROOM)

    reach = min(ROOM, distance)
    turns = sorted((math.radians(5 * i) for i in range(-18, 19)), key=lambda turn: abs(turn))
    free = (to_goal + turn for turn in turns if room(to_goal + turn) >= reach)
    direction = math.remainder(next(free, math.pi), 2 * math.pi)
    speed = 0.25 * max(0.0, math.cos(direction)) * min(1.0, room(0.0) / ROOM, distance / NEAR / 2)
    return speed, max(-1.0, min(1.0, 2.0 * direction))


def main():
    import rclpy
    from geometry_msgs.msg import Twist
    from nav_msgs.msg import Odometry
    from rclpy.qos import qos_profile_sensor_data
    from sensor_msgs.msg import LaserScan

    goal = float(sys.argv[1]), float(sys.argv[2])
    rclpy.init()
    node = rclpy.create_node("controller")
    commands = node.create_publisher(Twist, "cmd_vel", 10)
    pose = [0.0, 0.0, 0.0]

    def on_odometry(message):
        place, turn = message.pose.pose.position, message.pose.pose.orientation
        pose[:] = place.x, place.y, 2 * math.atan2(turn.z, turn.w)

    def on_scan(scan):
        away = goal[0] - pose[0], goal[1] - pose[1]
        distance, command = math.hypot(*away), Twist()
        to_goal = math.atan2(away[1], away[0]) - pose[2]
        found = steer(scan.ranges, scan.angle_min, scan.angle_increment, to_goal, distance)
        command.linear.x, command.angular.z = found
        commands.publish(command)
        print(json.dumps({"distance": distance, "reached": distance < NEAR}), flush=True)

    node.create_subscription(Odometry, "odom", on_odometry, 10)
    node.create_subscription(LaserScan, "scan", on_scan, qos_profile_sensor_data)
    rclpy.spin(node)


if __name__ == "__main__":
    main()
