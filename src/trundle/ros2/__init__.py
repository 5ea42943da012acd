"""The bridge to ROS 2: trundle's robot, sensors, clock and navigator on the network of any ROS 2 machine."""
