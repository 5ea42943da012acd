"""A planner, a controller, a simulator and a robot for trundle."""
