"""A robot that is somewhere else in ROS 2, driven by trundle's navigator: `RemoteBridge`."""
