"""What every planner, controller and simulator must pass, ours and other people's.

Each check drives the real thing and raises `ConformanceError`, which says what was asked and what came back.
"""

from trundle.testing.conformance import ConformanceError
from trundle.testing.controller import check_controller

__all__ = ["ConformanceError", "check_controller"]
