"""What the bridge takes from the network to drive the robot."""
