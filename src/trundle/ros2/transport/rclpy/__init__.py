"""The transport through the user's own rclpy: topics, services and actions, on any RMW and with the user's types."""
