"""The tracker in NumPy: what the kernel is to find, with the same names."""

from support.tracking_oracle.evidence import Evidence
from support.tracking_oracle.followed import Followed
from support.tracking_oracle.slow_tracker import SlowTracker
from support.tracking_oracle.sweep import Sweep

__all__ = ["Evidence", "Followed", "SlowTracker", "Sweep"]
