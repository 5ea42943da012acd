"""Worlds in SDF, Gazebo's format."""
