"""The navigator role: trundle drives, and ROS programs use it as they use Nav2."""
