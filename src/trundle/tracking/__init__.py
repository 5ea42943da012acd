"""Tracking: what moves around a robot, found in its scans, and how fast.

A `Tracker` takes scans with the odometry, and returns a `trundle.observation.Track` for everything that it follows. It
needs no map, and knows neither the shape nor the size of what moves.
"""

from trundle.tracking.tracker import Tracker, TrackerSettings

__all__ = ["Tracker", "TrackerSettings"]
