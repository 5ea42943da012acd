"""Navigation: plan, follow, replan and recover behind one call, for any simulator or robot."""

from trundle.navigation.navigator import NavigationStatus, Navigator

__all__ = ["NavigationStatus", "Navigator"]
