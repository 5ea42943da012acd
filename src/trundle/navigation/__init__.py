"""Navigation: plan, follow, replan and recover behind one call, for any simulator or robot."""

from trundle.navigation.navigator import Navigator
from trundle.navigation.status import NavigationStatus

__all__ = ["NavigationStatus", "Navigator"]
