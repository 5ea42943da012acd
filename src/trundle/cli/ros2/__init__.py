"""`trundle ros2`: a bridge to ROS 2 that needs no installation of it."""

from __future__ import annotations

from cyclopts import App

app = App(
    name="ros2",
    help_epilogue=(
        "Examples:\n"
        "  trundle ros2 serve warehouse --profile turtlebot3\n"
        "  trundle ros2 serve map.yaml --role navigator --transport rclpy\n"
        "  trundle ros2 navigate map.yaml --robot turtlebot3_burger --start 0,0,0 --goal 4,2\n"
        "  trundle ros2 check"
    ),
    version_flags=[],
)
app.command("trundle.cli.ros2.serve:app", name="serve", help="Put a robot, its lidars, clock and map on the network.")
app.command("trundle.cli.ros2.navigate:app", name="navigate", help="Drive a robot that is somewhere else in ROS 2.")
app.command("trundle.cli.ros2.check:app", name="check", help="Report what is reachable, and what to do about the rest.")
